"""What the system costs, measured: each bench gives rows of plain numbers (`ovip bench`, docs/benchmarks.md)."""
