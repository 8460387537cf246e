from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from lab.evaluation.asking.drives import Bound, Start, drive, start_of
from lab.evaluation.asking.questions import Kind, Question
from lab.evaluation.asking.terrain import Terrain, length, terrain_of_room
from lab.evaluation.asking.truth import Truth
from lab.evaluation.asking.worlds import Place
from lab.simulation.home import HomeObject
from lab.simulation.room import SimulatedRoom
from ovip.scene.grid import FREE, UNKNOWN, FloorGrid

CELL = 0.25
# two rooms of 4 x 4 m, a door at the top of the wall between them, and a closet that nobody can get into
ROWS = [*["aaaaaaaaaaaaaaaa##bbbbbbbbbbbb#cc"] * 14, *["aaaaaaaaaaaaaaaaaabbbbbbbbbbbb#cc"] * 2]
MUG, CUP = 1, 2


@dataclass(frozen=True)
class Spec:
    name: str = "two rooms"


def terrain() -> Terrain:
    free = np.array([[cell != "#" for cell in row] for row in ROWS])
    occupancy = np.where(free, FREE, UNKNOWN).astype(np.uint8)
    grid = FloorGrid(0, (0.0, 0.0), CELL, occupancy, np.zeros(free.shape, np.uint16))
    return Terrain({0: grid}, {0: 0.0, 1: 3.0})


def place() -> Place:
    # the mug hangs on room a's side of the wall; the cup is in the middle of room b
    mug, cup = np.array([3.8, 0.9, 1.0, 4.0, 1.1, 1.2]), np.array([6.0, 2.0, 0.7, 6.2, 2.2, 0.8])
    things = tuple(HomeObject(i, "mug", (), False, box, 1.0, 0, 0) for i, box in ((MUG, mug), (CUP, cup)))
    return Place(Spec(), None, Truth(things, (), {0: 0.0, 1: 3.0}), terrain())  # type: ignore[arg-type]


WHICH = Question("mug", Kind.CLASS, "mug", (MUG,))
START = Start(0, np.array([0.625, 0.875]), 0.0, 0.0)


def test_a_drive_ends_beside_the_goal_and_is_as_long_as_its_way() -> None:
    loose, strict = drive(place(), WHICH, START, Bound(np.array([3.9, 1.0, 1.1])))
    assert loose.success
    assert strict.success
    assert loose.taken == pytest.approx(3.25, abs=0.15)
    # a success begins a metre before the mug
    assert loose.shortest == pytest.approx(2.25, abs=0.3)
    assert loose.taken > loose.shortest


def test_near_but_behind_the_wall_is_a_success_only_for_those_who_do_not_look() -> None:
    behind = Bound(np.array([4.6, 1.0, 1.1]))
    loose, strict = drive(place(), WHICH, START, behind)
    assert loose.success
    assert not strict.success


def test_who_has_no_goal_stays_and_fails() -> None:
    loose, strict = drive(place(), WHICH, START, Bound(None))
    assert not loose.success
    assert not strict.success
    assert loose.taken == 0.0


def test_a_goal_on_another_storey_is_not_driven_to() -> None:
    loose, _ = drive(place(), WHICH, START, Bound(np.array([3.9, 1.0, 4.0])))
    assert (loose.success, loose.taken) == (False, 0.0)


def test_what_was_driven_to_search_counts_and_the_last_leg_begins_there() -> None:
    searched = Bound(np.array([3.9, 1.0, 1.1]), already=20.0, begin=np.array([3.375, 0.875]))
    loose, _ = drive(place(), WHICH, START, searched)
    assert loose.taken == pytest.approx(20.5, abs=0.3)
    # the shortest way is still the one from the start
    assert loose.shortest == pytest.approx(2.25, abs=0.3)


def test_a_goal_that_is_the_very_truth_is_told() -> None:
    truth = place().truth.centres([MUG])[0]
    assert drive(place(), WHICH, START, Bound(truth))[0].goal_is_truth
    assert not drive(place(), WHICH, START, Bound(truth + 0.01))[0].goal_is_truth


def test_starts_depend_on_question_and_seed_and_lie_where_one_can_walk() -> None:
    here = terrain()
    starts = [start_of(here, 0, question, seed) for question in range(8) for seed in (710, 711)]
    again = [start_of(here, 0, question, seed) for question in range(8) for seed in (710, 711)]
    assert [s.xy.tolist() for s in starts] == [s.xy.tolist() for s in again]
    assert len({tuple(s.xy) for s in starts}) > 8
    assert all(s.xy[0] < 7.5 for s in starts)  # never in the closet
    assert np.allclose(starts[0].pose[:2, 3], starts[0].xy)


def test_a_height_belongs_to_the_storey_below_it() -> None:
    assert [terrain().floor_at(z) for z in (-1.0, 0.8, 2.6, 2.8, 9.0)] == [0, 0, 0, 1, 1]


def test_the_small_room_can_be_driven_through_its_door() -> None:
    here = terrain_of_room(SimulatedRoom(0), 0.2)
    path = here.drive(0, np.array([2.5, 2.6]), np.array([8.5, 2.4]))
    assert 6.0 < length(path) < 9.0
    room = SimulatedRoom(0)
    assert all(room.is_free(point, 0.2) for point in path)
