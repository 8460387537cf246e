"""What went wrong with true areas, on a floor of 8 x 4 m whose regions are drawn by hand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.regions.diagnosis import AreaDiagnosis, Diagnosis, Verdict, diagnose
from lab.evaluation.regions.floors import FloorPlace, RegionTruth
from lab.evaluation.regions.methods import StoreyRegions
from lab.evaluation.regions.rows import Ground
from lab.simulation.home import Area, Storey
from ovip.scene.grid import FREE
from ovip.scene.types import I32, Bools
from services.regions.domain import floors
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.survey import SurveyedStorey

SHAPE = (80, 160)  # 4 m along y, 8 m along x
NO_WAYPOINTS = np.zeros((0, 2), np.int64)


def area(number: int, function: str, x0: float, x1: float) -> Area:
    corners = np.array([[x0, 0.0], [x1, 0.0], [x1, 4.0], [x0, 4.0]])
    return Area(number, 0, function, f"the {function}", corners, number)


HALVES = (area(1, "bedroom", 0, 4), area(2, "kitchen", 4, 8))


def ground(areas: tuple[Area, ...], free: Bools | None = None) -> Ground:
    free = np.ones(SHAPE, bool) if free is None else free
    space = FreeSpace((0.0, 0.0), 0.05, free, ~free, np.where(free, FREE, 0).astype(np.uint8))
    here = SurveyedStorey(floors.Storey(0.0, 2.5, -np.inf, np.inf), space)
    truth = RegionTruth("by hand", "open-compact", (Storey(0, 0.0, 2.5),), areas, areas, (), np.zeros((0, 6)))
    place = FloorPlace(truth, FloorEvidence(), PlacedObjects.none())
    return Ground(place, (here,), (0,), (NO_WAYPOINTS,), ())


def cut(*regions: tuple[str, float, float]) -> tuple[StoreyRegions, ...]:
    """Regions of a function from x0 to x1, over all of y."""
    labels: I32 = np.zeros(SHAPE, np.int32)
    for number, (_, x0, x1) in enumerate(regions, start=1):
        labels[:, round(x0 / 0.05) : round(x1 / 0.05)] = number
    return (StoreyRegions(labels, tuple(function for function, _, _ in regions), {}),)


def verdicts(told: Diagnosis) -> list[Verdict]:
    return [each.verdict for each in told.areas]


def missing(each: AreaDiagnosis) -> float:
    return each.split_m2 + each.unseen_m2 + each.merged_m2 + each.leaked_m2


def test_areas_that_are_regions_of_their_own_are_found() -> None:
    told = diagnose(ground(HALVES), cut(("bedroom", 0, 4), ("kitchen", 4, 8)))
    assert verdicts(told) == [Verdict.FOUND, Verdict.FOUND]
    assert [each.iou for each in told.areas] == [1.0, 1.0]
    assert told.columns["why"] == []
    assert told.extra == ()


def test_a_found_area_of_another_function_is_misnamed_unless_the_method_names_none() -> None:
    told = diagnose(ground(HALVES), cut(("office", 0, 4), ("", 4, 8)))
    assert verdicts(told) == [Verdict.MISNAMED, Verdict.FOUND]
    assert told.columns["why"] == ["the bedroom: found, function wrong (office)"]


def test_an_area_in_many_regions_is_split_and_the_smaller_ones_are_extra() -> None:
    told = diagnose(
        ground(HALVES),
        cut(("bedroom", 0, 1.6), ("bathroom", 1.6, 2.9), ("hallway", 2.9, 4), ("kitchen", 4, 8)),
    )
    bedroom = told.areas[0]
    assert verdicts(told) == [Verdict.SPLIT, Verdict.FOUND]
    assert [(piece.name, round(piece.m2, 2)) for piece in bedroom.pieces] == [
        ("bedroom", 6.4),
        ("bathroom", 5.2),
        ("hallway", 4.4),
    ]
    assert bedroom.split_m2 == pytest.approx(9.6)
    assert [(piece.name, round(piece.m2, 2)) for piece in told.extra] == [("bathroom", 5.2), ("hallway", 4.4)]
    assert str(bedroom) == "the bedroom: split into 3 (bedroom 6.4 m2, bathroom 5.2 m2, hallway 4.4 m2)"


def test_areas_that_share_a_region_are_merged_and_say_with_which_and_how_much() -> None:
    told = diagnose(ground(HALVES), cut(("kitchen", 0, 8)))
    assert verdicts(told) == [Verdict.MERGED, Verdict.MERGED]
    assert [(piece.name, piece.m2) for piece in told.areas[0].merged_with] == [
        ("the kitchen", pytest.approx(16.0))
    ]
    assert told.areas[0].function_found == "kitchen"
    assert str(told.areas[1]) == "the kitchen: merged with the bedroom 16.0 m2"


def test_an_area_that_lies_in_no_region_was_seen_too_little() -> None:
    seen = np.ones(SHAPE, bool)
    seen[:, 20:80] = False  # 1 m of the bedroom's 4
    told = diagnose(ground(HALVES, seen), cut(("bedroom", 0, 1), ("kitchen", 4, 8)))
    bedroom = told.areas[0]
    assert verdicts(told) == [Verdict.UNSEEN, Verdict.FOUND]
    assert bedroom.seen == pytest.approx(0.25)
    assert bedroom.unseen_m2 == pytest.approx(12.0)
    assert str(bedroom) == "the bedroom: too little seen (25% of 16.0 m2, 12.0 m2 in no region)"


def test_an_area_without_any_region_has_none() -> None:
    told = diagnose(ground(HALVES), cut(("kitchen", 4, 8)))
    assert told.areas[0].verdict is Verdict.UNSEEN
    assert told.areas[0].function_found is None
    assert (told.areas[0].iou, told.areas[0].unseen_m2) == (0.0, pytest.approx(16.0))


def test_a_region_that_goes_on_where_no_area_is_leaks() -> None:
    told = diagnose(ground((area(1, "bedroom", 0, 2),)), cut(("bedroom", 0, 8)))
    assert told.areas[0].verdict is Verdict.LEAKED
    assert told.areas[0].leaked_m2 == pytest.approx(24.0)
    assert str(told.areas[0]) == "the bedroom: leaked (24.0 m2 in no area)"


def test_without_any_region_every_area_is_unseen_and_nothing_breaks() -> None:
    told = diagnose(ground(HALVES), cut())
    assert verdicts(told) == [Verdict.UNSEEN, Verdict.UNSEEN]


def test_an_area_of_another_storey_has_no_region_here() -> None:
    upstairs = Area(3, 1, "office", "the office", HALVES[0].polygon, 3)
    told = diagnose(ground((*HALVES, upstairs)), cut(("bedroom", 0, 4), ("kitchen", 4, 8)))
    assert verdicts(told) == [Verdict.FOUND, Verdict.FOUND, Verdict.UNSEEN]
    assert (told.areas[2].seen, told.areas[2].floor) == (0.0, 1)


def test_an_area_smaller_than_a_cell_is_left_out() -> None:
    told = diagnose(ground((*HALVES, area(3, "nook", 3.01, 3.02))), cut(("bedroom", 0, 4)))
    assert [each.name for each in told.areas] == ["the bedroom", "the kitchen"]


@given(st.lists(st.integers(0, 160), min_size=1, max_size=6), st.integers(1, 149))
def test_the_four_reasons_add_up_to_what_a_perfect_overlap_lacks(edges: list[int], border: int) -> None:
    bounds = sorted({0, *edges})
    regions = cut(*[("kitchen", a * 0.05, b * 0.05) for a, b in pairwise(bounds)])
    areas = (area(1, "bedroom", 0, border * 0.05), area(2, "kitchen", border * 0.05, 7.5))
    for each in diagnose(ground(areas), regions).areas:
        union = each.m2 + each.merged_m2 + each.leaked_m2
        assert missing(each) == pytest.approx(union * (1 - each.iou), abs=1e-6)
        assert sum(piece.m2 for piece in each.pieces) <= each.m2 + 1e-9
