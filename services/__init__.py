"""The deployables, one folder each, all of one shape."""
