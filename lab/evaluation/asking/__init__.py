"""Asking a real stack about a place that a simulated robot mapped: the ground of four protocols."""
