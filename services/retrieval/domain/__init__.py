"""The paper's retrieval cascade (CARA): pure functions and values, no I/O, no clock."""
