"""Furnishes a plan: each functional area by the rules of its function, the large things before the small."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lab.simulation.catalogue import Catalogue
from lab.simulation.furnishing.kitchen import furnish_dining_area, furnish_kitchen
from lab.simulation.furnishing.living import furnish_bedroom, furnish_living_room
from lab.simulation.furnishing.passages import furnish_balcony, furnish_hall
from lab.simulation.furnishing.placing import Stead
from lab.simulation.furnishing.resting import Surfaces
from lab.simulation.furnishing.scattering import scatter
from lab.simulation.furnishing.site import Site
from lab.simulation.furnishing.walls_and_ceilings import hang_fittings
from lab.simulation.furnishing.wares import Wares
from lab.simulation.furnishing.wet_rooms import furnish_bathroom, furnish_laundry
from lab.simulation.furnishing.working import furnish_gym, furnish_office, furnish_playroom, furnish_storage
from lab.simulation.plans.plan import Plan

_FULLNESS = (0.6, 1.05)  # some homes are emptier than others: what the chances of things are multiplied by
_ENOUGH = 370  # things in a home, beyond which nothing more is left about


def furnish(plan: Plan, catalogue: Catalogue, rng: np.random.Generator) -> tuple[Stead, ...]:
    """The storeys of a plan with everything in its place."""
    functions = [area.function for area in plan.areas]
    rules = _rules(functions)
    wares, surfaces = Wares(catalogue, rng), Surfaces()
    fullness = float(rng.uniform(*_FULLNESS))
    steads = tuple(Stead(floor) for floor in plan.floors)
    for stead in steads:
        sites = [Site(area, stead, wares, surfaces, rng, fullness) for area in stead.plan.areas]
        for site in sites:
            rules[site.area.function](site)
        for site in sites:
            hang_fittings(site)
        for site in sites:
            if sum(len(stead.placed) for stead in steads) < _ENOUGH:
                scatter(site)
    return steads


def _rules(functions: list[str]) -> dict[str, Callable[[Site], None]]:
    no_dining = "dining area" not in functions
    first_bath_washes = "laundry" not in functions
    return {
        "kitchen": lambda site: furnish_kitchen(site, eats_here=no_dining),
        "dining area": furnish_dining_area,
        "living room": furnish_living_room,
        "bedroom": furnish_bedroom,
        "bathroom": lambda site: furnish_bathroom(site, washes_here=first_bath_washes),
        "office": furnish_office,
        "laundry": furnish_laundry,
        "hallway": furnish_hall,
        "entryway": furnish_hall,
        "playroom": furnish_playroom,
        "gym": furnish_gym,
        "storage": furnish_storage,
        "balcony": furnish_balcony,
    }
