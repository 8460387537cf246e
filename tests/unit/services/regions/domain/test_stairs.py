"""Stairs: what joins two storeys, and what only looks like it."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.scene.types import F32, F64
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.stairs import Stairs, find_stairs
from services.regions.domain.survey import survey
from tests.unit.services.regions.rooms import plane, seen, without
from tests.unit.services.regions.stairways import (
    GOING,
    HOLE,
    NOTHING,
    RISE,
    STRAIGHT,
    UPSTAIRS,
    WIDTH,
    Place,
    Rect,
    flight,
    home,
    spiral,
)


def found(evidence: FloorEvidence) -> tuple[Stairs, ...]:
    surveyed = survey(evidence)
    assert len(surveyed) == 2
    return find_stairs(evidence, surveyed)


def near(place: F64, *expected: float) -> bool:
    return bool(np.linalg.norm(place - np.array(expected)) < 0.25)


def test_straight_stairs_have_foot_head_width_and_the_cells_they_take_up() -> None:
    evidence = home(STRAIGHT, HOLE)
    (stairs,) = found(evidence)
    assert (stairs.lower, stairs.upper) == (0, 1)
    assert near(stairs.foot, 1.7, 3.0, 0.0)
    assert near(stairs.head, 5.55, 3.0, UPSTAIRS)
    assert stairs.width == pytest.approx(WIDTH, abs=0.06)
    spaces = [here.space for here in survey(evidence)]
    for cells, space in zip((stairs.lower_cells, stairs.upper_cells), spaces, strict=True):
        assert cells.shape == space.free.shape
        rows, columns = np.nonzero(cells)
        assert cells.sum() * CELL**2 == pytest.approx(3.25 * WIDTH, rel=0.1)
        assert space.origin[0] + (columns.min() + 0.5) * CELL == pytest.approx(2.0, abs=0.1)
        assert space.origin[0] + (columns.max() + 0.5) * CELL == pytest.approx(5.25, abs=0.1)
        assert space.origin[1] + (rows.mean() + 0.5) * CELL == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize(
    ("way", "start", "hole", "foot", "head"),
    [
        ((-1, 0), (6.0, 3.0), ((2.75, 6.0), (2.55, 3.45)), (6.3, 3.0), (2.45, 3.0)),
        ((0, 1), (4.0, 1.5), ((3.55, 4.45), (1.5, 4.75)), (4.0, 1.2), (4.0, 5.05)),
        ((0, -1), (4.0, 5.0), ((3.55, 4.45), (1.75, 5.0)), (4.0, 5.3), (4.0, 1.45)),
    ],
)
def test_stairs_rise_whichever_way_they_turn(
    way: tuple[int, int],
    start: tuple[float, float],
    hole: Rect,
    foot: tuple[float, ...],
    head: tuple[float, ...],
) -> None:
    (stairs,) = found(home(flight(start, way), hole))
    assert near(stairs.foot, *foot, 0.0)
    assert near(stairs.head, *head, UPSTAIRS)


def test_stairs_that_turn_on_a_landing_are_one() -> None:
    landing = plane((3.5, 4.4), (0.55, 1.45), (1.4, 1.4))
    turning = np.concatenate(
        [flight((2.0, 1.0), (1, 0), 6), landing, flight((3.95, 1.45), (0, 1), 6, low=1.4)]
    )
    (stairs,) = found(home(turning, ((2.0, 4.4), (0.55, 2.95))))
    assert near(stairs.foot, 1.7, 1.0, 0.0)
    assert near(stairs.head, 3.95, 3.25, UPSTAIRS)
    assert stairs.width == pytest.approx(WIDTH, abs=0.1)


def test_stairs_that_turn_back_beside_themselves_are_one() -> None:
    landing = plane((3.5, 4.4), (0.55, 2.45), (1.4, 1.4))
    back = np.concatenate([flight((2.0, 1.0), (1, 0), 6), landing, flight((3.5, 2.0), (-1, 0), 6, low=1.4)])
    (stairs,) = found(home(back, ((2.0, 4.4), (0.55, 2.45))))
    assert near(stairs.foot, 1.7, 1.0, 0.0)
    assert near(stairs.head, 1.7, 2.0, UPSTAIRS)
    assert stairs.width == pytest.approx(WIDTH, abs=0.1)


def test_spiral_stairs_are_found() -> None:
    (stairs,) = found(home(spiral((4.0, 3.0), 1.5 * np.pi), ((3.0, 5.0), (2.0, 4.0))))
    assert np.hypot(stairs.foot[0] - 4.6, stairs.foot[1] - 2.8) < 0.5
    assert np.hypot(stairs.head[0] - 4.2, stairs.head[1] - 2.2) < 0.5


def test_two_stairs_come_by_the_place_of_their_feet() -> None:
    both = np.concatenate([flight((6.0, 5.0), (-1, 0)), STRAIGHT])
    first, second = found(home(both, ((2.0, 6.0), (2.55, 5.45))))
    assert near(first.foot, 1.7, 3.0, 0.0)
    assert near(second.foot, 6.3, 5.0, 0.0)


def test_a_sofa_beside_the_stairs_is_none_of_them() -> None:
    seat, arm = plane((2.0, 4.0), (1.5, 2.5), (0.42, 0.42)), plane((2.0, 2.2), (1.5, 2.5), (0.6, 0.6))
    (stairs,) = found(home(np.concatenate([STRAIGHT, seat, arm]), HOLE))
    assert near(stairs.foot, 1.7, 3.0, 0.0)
    assert stairs.lower_cells.sum() * CELL**2 == pytest.approx(3.25 * WIDTH, rel=0.15)


def test_a_ramp_joins_storeys_too() -> None:
    ramp = plane((1.0, 7.0), (2.0, 3.2), (0, 0)).copy()
    ramp[:, 2] = (ramp[:, 0] - 1.0) * UPSTAIRS / 6.0
    (stairs,) = found(home(ramp, ((1.2, 7.0), (1.9, 3.3))))
    assert stairs.foot[0] < 1.3
    assert stairs.head[0] > 6.7
    assert stairs.width == pytest.approx(1.2, abs=0.1)


def shelf() -> F32:
    boards = [plane((2, 3), (3, 3.35), (z, z)) for z in np.arange(0.2, 2.7, 0.2)]
    return np.concatenate([*boards, plane((2, 3), (3.35, 3.35), (0, 2.6))])


def bunk_bed() -> F32:
    rungs = [plane((2, 2.35), (2.92, 3.0), (z, z)) for z in (0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)]
    beds = [plane((2, 4), (3, 4), (z, z)) for z in (0.5, 1.6)]
    return np.concatenate([*rungs, *beds, plane((4, 4.6), (3, 4), (2.5, 2.5))])


@pytest.mark.parametrize("thing", [NOTHING, shelf(), bunk_bed()])
def test_what_does_not_rise_in_steps_is_no_stairs(thing: F32) -> None:
    assert found(home(thing, HOLE)) == ()


def test_a_cabinet_stepped_like_stairs_that_ends_half_way_is_none() -> None:
    assert found(home(flight((2.0, 3.0), (1, 0), 7), HOLE)) == ()


CLIMBING = [(x, 3.0, 1.3 + (x - 1.75) * RISE / GOING) for x in np.arange(2.0, 5.3, 0.25)]


def test_treads_that_were_not_seen_are_where_cameras_climbed() -> None:
    partial = without(STRAIGHT, (3.0, 3.6), (2, 4), (0, 3))
    assert found(home(partial, HOLE)) == ()
    (stairs,) = found(home(partial, HOLE, *CLIMBING))
    assert near(stairs.foot, 1.7, 3.0, 0.0)
    assert near(stairs.head, 5.55, 3.0, UPSTAIRS)
    (unseen,) = found(home(NOTHING, HOLE, *CLIMBING))
    assert np.linalg.norm(unseen.foot - (1.7, 3.0, 0.0)) < 0.6


def test_a_lift_is_no_stairs() -> None:
    rising = [(3.0, 3.0, z) for z in np.arange(1.3, 4.1, 0.2)]
    assert found(home(NOTHING, ((2.5, 3.5), (2.5, 3.5)), *rising)) == ()


def test_one_storey_has_none_and_so_has_no_evidence() -> None:
    evidence = seen((np.concatenate([plane((0, 8), (0, 6), (0, 0)), STRAIGHT]), (7.0, 5.0, 1.3)))
    assert find_stairs(evidence, survey(evidence)) == ()
    assert find_stairs(FloorEvidence(), ()) == ()


def moved(evidence: FloorEvidence, points: list[tuple[F32, Place]], shift: F64) -> FloorEvidence:
    for number, (cloud, camera) in reversed(list(enumerate(points))):
        evidence.add(f"f{number}", (cloud + shift).astype(np.float32), np.array(camera) + shift)
    return evidence


@pytest.mark.parametrize("cells", [(40, -60, 0), (-7, 3, -58)])
def test_the_order_of_frames_changes_nothing_and_whole_cells_of_shift_move_them_as_far(
    cells: tuple[int, int, int],
) -> None:
    shift = np.array(cells) * CELL
    low, high = (
        plane((0, 8), (0, 6), (0.02, 0.02)),
        without(plane((0, 8), (0, 6), (2.82, 2.82)), *HOLE, (-9, 9)),
    )
    views = [
        (np.concatenate([low, STRAIGHT + np.array([0, 0, 0.02], np.float32)]), (7.0, 5.0, 1.3)),
        (high, (7.0, 5.0, 4.1)),
    ]
    (here,) = found(seen(*views))
    (there,) = found(moved(FloorEvidence(), views, shift))
    assert there.foot - shift == pytest.approx(here.foot, abs=CELL + 0.01)
    assert there.head - shift == pytest.approx(here.head, abs=CELL + 0.01)
    assert there.lower_cells.sum() == pytest.approx(here.lower_cells.sum(), rel=0.03)
    assert there.width == pytest.approx(here.width, abs=CELL)
