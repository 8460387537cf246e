from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.building import Building
from ovip.scene.types import Partition
from ovip.scene.walking import path_length, traversable
from services.retrieval.domain.goals import footprint_distance, way_to
from tests.unit.ovip.scene.buildings import building, stairs, storey
from tests.unit.services.retrieval.builders import box_at, grid_of, standing_in

ROOM = grid_of("\n".join(["#" * 32, *["#" + "." * 30 + "#"] * 22, "#" * 32]), 0.25)
CUP = box_at(4.0, 3.0, 0.8)


def test_the_robot_stands_near_the_object_and_faces_it() -> None:
    way = way_to(CUP, np.array([1.0, 1.0, 1.2]), standing_in(ROOM), 0)
    assert way.goal is not None
    away = float(np.linalg.norm(way.goal.position[:2] - [4.0, 3.0]))
    assert 0.3 <= away <= 0.7
    toward = np.array([4.0, 3.0]) - way.goal.position[:2]
    assert way.goal.yaw == pytest.approx(np.arctan2(toward[1], toward[0]))
    assert way.why == ""


def test_the_path_runs_from_the_robot_to_the_goal_on_the_floor() -> None:
    way = way_to(CUP, np.array([1.0, 1.0, 1.2]), standing_in(ROOM, z=0.1), 0)
    assert way.goal is not None
    np.testing.assert_allclose(way.path[-1], way.goal.position)
    assert np.linalg.norm(way.path[0, :2] - [1.0, 1.0]) < 0.25
    assert set(way.path[:, 2]) == {0.1}


def test_without_a_grid_it_is_said_in_words() -> None:
    way = way_to(CUP, None, Building(Partition(0, 0), {}, 0.25), 0)
    assert way.goal is None
    assert way.path.shape == (0, 3)
    assert "no floor grid" in way.why


def test_without_a_start_there_is_a_goal_and_no_path() -> None:
    way = way_to(CUP, None, standing_in(ROOM), 0)
    assert way.goal is not None
    assert not len(way.path)
    assert "start" in way.why


def test_a_walled_off_object_has_a_goal_and_no_path() -> None:
    split = grid_of("\n".join(["." * 14 + "#" + "." * 25] * 8), 0.25)
    way = way_to(box_at(8.5, 1.0, 0.5), np.array([0.5, 1.0, 0.0]), standing_in(split, 0.2), 0)
    assert not len(way.path)
    assert "reached" in way.why


def test_where_nothing_is_near_enough_the_distance_is_said() -> None:
    ring = grid_of("\n".join(["........", ".######.", ".######.", ".######.", "........"]), 0.5)
    way = way_to(box_at(2.0, 1.25, 0.5, 0.2), np.array([0.25, 0.25, 0.0]), standing_in(ring, 0.1), 0)
    assert way.goal is not None
    assert len(way.path)


def test_a_floor_where_nobody_can_stand_is_said() -> None:
    assert "stand" in way_to(CUP, None, standing_in(grid_of("####")), 0).why


def test_distance_to_a_footprint_is_zero_inside_it() -> None:
    away = footprint_distance(grid_of("....", 1.0), np.array([1.0, 0.0, 0.0, 2.0, 1.0, 1.0]))
    np.testing.assert_allclose(away, [[0.5, 0.0, 0.5, 1.5]])


# a kitchen below, a bedroom above, both 4.5 m x 1.5 m
BELOW = storey("kkkkkkkkk", "kkkkkkkkk", "kkkkkkkkk")
ABOVE = storey("bbbbbbbbb", "bbbbbbbbb", "bbbbbbbbb", floor=1)
LAMP = box_at(4.25, 0.75, 3.5)
START = np.array([2.25, 0.75, 1.2])


def test_the_way_to_an_object_on_another_storey_leads_over_the_stairs() -> None:
    flight = stairs("k", "b", (0.25, 0.75, 0.0), (0.75, 0.75, 3.0))
    home = Building(*building([BELOW, ABOVE], [flight]), 0.2)
    way = way_to(LAMP, START, home, 1)
    assert way.goal is not None
    assert way.why == ""
    np.testing.assert_allclose(way.goal.position, [3.75, 0.75, 3.0])
    # 2 m to the foot, the climb of half a metre along and three up, 3 m from the head
    assert path_length(way.path) == pytest.approx(2.0 + np.hypot(0.5, 3.0) + 3.0)
    assert (np.diff(way.path[:, 2]) >= 0).all()


def test_without_stairs_to_another_storey_that_is_said() -> None:
    way = way_to(LAMP, START, Building(*building([BELOW, ABOVE]), 0.2), 1)
    assert way.goal is not None
    assert not len(way.path)
    assert way.why == (
        "no path: no floor near it can be reached from the robot: "
        "no stairs that were seen lead from floor 0 to floor 1"
    )


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**31 - 1))
def test_goal_and_path_are_places_where_the_robot_can_stand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((24, 30)) < 0.06, "#", ".")
    grid = grid_of("\n".join("".join(row) for row in cells), 0.25)
    target = box_at(float(rng.uniform(0, 7)), float(rng.uniform(0, 6)), 0.5)
    way = way_to(target, np.array([*rng.uniform(0, 6, 2), 1.0]), standing_in(grid, 0.3), 0)
    standing = traversable(grid, 0.3)
    places = [*way.path, *([way.goal.position] if way.goal else [])]
    assert all(standing[grid.cell_of(place[:2])] for place in places)
    assert way.goal is not None or way.why
