"""auto-K over every K, on two rooms whose objects lie in three clumps."""

from __future__ import annotations

import numpy as np
import pytest

from lab.evaluation.regions.floors import FloorPlace
from lab.evaluation.regions.methods import auto_k
from lab.evaluation.regions.rows import Ground
from lab.evaluation.regions.sweep import Sweep, aspect_of, sweep
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.survey import survey
from tests.unit.lab.evaluation.regions.two_room_homes import truth
from tests.unit.services.regions.rooms import two_rooms

CLUMPS = ((1.0, 1.0), (1.0, 3.2), (6.5, 2.0))


def ground() -> Ground:
    around = [(0.0, 0.0), (0.1, 0.0), (0.0, 0.1), (0.1, 0.1)]
    centres = np.array([(x + dx, y + dy, 0.5) for x, y in CLUMPS for dx, dy in around])
    objects = PlacedObjects(tuple(f"o{k}" for k in range(len(centres))), ("box",) * len(centres), centres)
    evidence = two_rooms()
    return Ground.of(FloorPlace(truth(), evidence, objects), survey(evidence))


def test_every_k_that_can_be_tried_has_a_silhouette_and_an_accuracy() -> None:
    told = sweep(ground())
    assert list(told.silhouettes) == list(told.acc) == list(told.strict_acc) == list(range(2, 12))
    assert told.chosen == 3
    assert told.areas == 2
    assert told.acc[2] == told.strict_acc[2] == 1.0
    assert told.acc[3] < 1.0
    columns = told.columns
    assert (columns["acc_at_areas"], columns["acc_at_chosen"]) == (1.0, round(told.acc[3], 3))
    assert columns["collapsed"] is False


def test_the_sweep_chooses_what_auto_k_chooses_by_the_same_silhouettes() -> None:
    here = ground()
    told = sweep(here)
    (cut,) = auto_k(here.place, here.surveyed)
    assert told.silhouettes == pytest.approx(cut.silhouettes)
    assert len(cut.functions) == told.chosen


def test_half_as_many_clusters_as_areas_are_a_collapse() -> None:
    told = Sweep("a", "open-elongated", 2.0, 6, {2: 0.5, 3: 0.5, 6: 0.4}, {2: 0.2, 3: 0.3, 6: 0.8}, {})
    assert told.chosen == 2
    assert (told.columns["collapsed"], told.columns["acc_at_areas"]) == (True, 0.8)


def test_more_areas_than_clusters_are_tried_are_no_choice() -> None:
    told = Sweep("a", "", 1.0, 14, {2: 0.1, 14: 0.9}, {2: 0.2, 14: 0.9}, {})
    assert told.chosen == 2
    assert told.columns["acc_at_areas"] == 0.9


def test_a_home_without_objects_or_frames_has_no_choice() -> None:
    for evidence in (two_rooms(), FloorEvidence()):
        place = FloorPlace(truth(), evidence, PlacedObjects.none())
        told = sweep(Ground.of(place, survey(evidence)))
        assert (told.chosen, told.acc, told.columns["acc_at_chosen"]) == (None, {}, None)


@pytest.mark.parametrize(
    ("points", "aspect"),
    [
        ([(0, 0), (6, 0), (0, 2), (6, 2)], 3.0),
        ([(0, 0), (3, 3), (-1, 1), (2, 4)], 3.0),  # the same shape, turned by 45 degrees
        ([(1, 1)], 1.0),
        ([(1, 1), (2, 2)], 1.0),
        ([], 1.0),
    ],
)
def test_the_aspect_is_of_the_objects_cloud_along_its_own_axes(
    points: list[tuple[float, float]], aspect: float
) -> None:
    assert aspect_of(np.array(points, dtype=np.float64).reshape(-1, 2)) == pytest.approx(aspect)
