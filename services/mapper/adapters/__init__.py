"""What stands behind the mapper's seams."""
