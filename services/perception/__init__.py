"""Perception: takes frames from robots, finds what is in them, keeps their history (SPEC 1)."""
