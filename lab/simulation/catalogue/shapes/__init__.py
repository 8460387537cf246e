"""How each label is composed, by the room it is most at home in."""

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.shapes import (
    appliances,
    bathroom,
    bedroom,
    fittings,
    kitchenware,
    living,
    office,
    seating,
    small,
    storage,
    tables,
)

RECIPES: dict[str, Recipe] = {
    **seating.RECIPES,
    **tables.RECIPES,
    **storage.RECIPES,
    **living.RECIPES,
    **bedroom.RECIPES,
    **bathroom.RECIPES,
    **appliances.RECIPES,
    **kitchenware.RECIPES,
    **office.RECIPES,
    **small.RECIPES,
    **fittings.RECIPES,
}
