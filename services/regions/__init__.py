"""Cuts each floor of a scene into functional regions (KGSW)."""
