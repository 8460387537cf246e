"""Every service in one process on one embedded store: the same graph, the same ports, the same code."""
