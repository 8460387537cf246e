"""Furnishes floor plans by rules that hold in real homes: what stands where, on what, and beside what."""

from lab.simulation.furnishing.furnish import furnish
from lab.simulation.furnishing.placing import Carrier, Placed, Stead
from lab.simulation.furnishing.relations import relations_between

__all__ = ["Carrier", "Placed", "Stead", "furnish", "relations_between"]
