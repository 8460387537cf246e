"""Models of the things that stand in simulated homes, by class label: `open_catalogue()`."""

from lab.simulation.catalogue.catalogue import Catalogue, open_catalogue
from lab.simulation.catalogue.model import Model, Variant

__all__ = ["Catalogue", "Model", "Variant", "open_catalogue"]
