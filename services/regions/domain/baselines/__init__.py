"""What KGSW is measured against: partitions by walls alone or by object clusters, on the grid of our own (SPEC 3)."""
