"""Regions of a home against the truth: what is compared, on what evidence, and how it is drawn."""
