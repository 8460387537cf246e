"""Retrieval answers questions about where things are, in four tiers (CARA, SPEC 4)."""
