"""Builders: the truth of two rooms with a door, their evidence and objects, on one storey or two."""

from __future__ import annotations

import numpy as np

from lab.evaluation.regions.floors import FloorPlace, RegionTruth, Target
from lab.evaluation.regions.rows import Ground
from lab.simulation.home import Area, Storey
from ovip.scene.types import F32, F64
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.survey import survey
from tests.unit.services.regions.rooms import plane, room, seen, two_rooms, without

THINGS = (("bed", 1.0, 3.0), ("nightstand", 2.5, 3.5), ("stove", 7.5, 3.5), ("fridge", 7.5, 1.9))
FUNCTIONS_OF_THINGS = ("bedroom", "bedroom", "kitchen", "kitchen")


def square(x0: float, x1: float) -> F64:
    return np.array([[x0, 0.0], [x1, 0.0], [x1, 4.05], [x0, 4.05]])


def area(number: int, floor: int, function: str, x0: float, x1: float) -> Area:
    return Area(number, floor, function, function, square(x0, x1), number)


def truth(storeys: tuple[float, ...] = (0.0,)) -> RegionTruth:
    areas = tuple(
        area(10 * floor + k, floor, function, *x)
        for floor in range(len(storeys))
        for k, (function, x) in enumerate((("bedroom", (0.0, 4.05)), ("kitchen", (4.2, 8.25))), start=1)
    )
    targets = tuple(
        Target(label, np.array([x, y, z + 0.5]), floor, "bedroom" if x < 4 else "kitchen")
        for floor, z in enumerate(storeys)
        for label, x, y in THINGS
    )
    floors = tuple(Storey(k, z, z + 2.5) for k, z in enumerate(storeys))
    return RegionTruth("two rooms", "walled", floors, areas, areas, targets, np.zeros((0, 6)))


def placed(told: RegionTruth) -> PlacedObjects:
    return PlacedObjects(
        tuple(f"o{k}" for k in range(len(told.targets))),
        tuple(target.label for target in told.targets),
        np.array([target.centre for target in told.targets]).reshape(-1, 3),
    )


def ground(evidence: FloorEvidence, told: RegionTruth, queries: int = 0) -> Ground:
    place = FloorPlace(told, evidence, placed(told))
    return Ground.of(place, survey(evidence), queries)


def one_storey() -> Ground:
    return ground(two_rooms(), truth())


def two_storeys() -> Ground:
    evidence = seen(
        *[
            (cloud + np.array([0, 0, z], np.float32), (x, 2.0, z + 1.2))
            for z in (0.0, 3.0)
            for cloud, x in _views()
        ]
    )
    return ground(evidence, truth((0.0, 3.0)))


def _views() -> list[tuple[F32, float]]:
    sill = plane((4.025, 4.225), (1.6, 2.5), (0.0, 0.0))
    left = without(room((0.025, 4.025), (0.025, 4.025)), (4.0, 4.1), (1.6, 2.5), (-0.1, 2.0))
    right = without(room((4.225, 8.225), (0.025, 4.025)), (4.2, 4.3), (1.6, 2.5), (-0.1, 2.0))
    return [(np.concatenate([left, sill]), 2.0), (np.concatenate([right, sill]), 6.0)]
