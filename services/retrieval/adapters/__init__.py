"""Real implementations of the seams in `ports` that are not clients of other services."""
