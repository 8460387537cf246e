"""Where one can stand in a home, and a walk through all of it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from lab.simulation import Ground, TourParams, walk_through
from lab.simulation.ground import RESOLUTION
from ovip.scene.camera import check_pose
from ovip.scene.grid import FREE, OCCUPIED
from ovip.scene.types import F64
from ovip.scene.walking import path_length
from tests.unit.lab.simulation.box_homes import UPPER, box_home


@pytest.fixture(scope="module")
def ground() -> Ground:
    return Ground(box_home())


@pytest.fixture(scope="module")
def upstairs() -> Ground:
    return Ground(box_home(storeys=2))


@pytest.fixture(scope="module")
def tour(ground: Ground) -> list[F64]:
    return walk_through(ground.home, 0, ground=ground)


def test_where_one_can_stand(ground: Ground) -> None:
    assert ground.is_free(np.array([1.0, 1.0]))
    assert ground.is_free(np.array([4.05, 1.0]), clearance=0.4)  # the doorway, 1 m wide
    assert not ground.is_free(np.array([4.05, 1.0]), clearance=0.6)
    assert not ground.is_free(np.array([4.05, 2.0]))  # the wall beside it
    assert not ground.is_free(np.array([2.0, 2.4]), clearance=0.0)  # in the table
    assert not ground.is_free(np.array([9.0, 0.5]), clearance=0.0)  # in the bed, which is lower than a robot
    assert not ground.is_free(np.array([0.1, 1.0]))  # too near the wall
    assert not ground.is_free(np.array([20.0, 20.0]))


def test_clearance_is_the_distance_to_the_nearest_thing(ground: Ground) -> None:
    for place, metres in (((1.0, 1.0), 1.0), ((3.0, 1.0), 1.0), ((6.0, 1.5), 1.5), ((2.0, 1.6), 0.4)):
        # what a face touches is a whole cell, so it may seem nearer by one, not farther by more than half of one
        assert -1.5 * RESOLUTION < ground.clearance_at(np.array(place)) - metres < 0.5 * RESOLUTION


def test_the_floor_is_as_large_as_its_rooms_less_what_stands_there(ground: Ground) -> None:
    free = (ground.grids[0].occupancy == FREE).sum() * RESOLUTION**2
    rooms, doorway, table, bed = 4 * 3 + 6 * 3, 0.1 * 1.0, 1.0 * 0.8, 1.6 * 1.0
    assert free == pytest.approx(rooms + doorway - table - bed, rel=0.04)  # borders are rounded outwards


def test_cells_know_their_area(ground: Ground) -> None:
    grid = ground.grids[0]
    for place, area in (((1.0, 1.0), "1"), ((6.0, 1.0), "2")):
        assert grid.region_ids[grid.regions[grid.cell_of(np.array(place))] - 1] == area
    assert grid.regions[grid.cell_of(np.array([-0.3, 1.0]))] == 0


def test_the_inside_of_things_is_no_floor(ground: Ground) -> None:
    grid = ground.grids[0]
    assert grid.occupancy[grid.cell_of(np.array([2.0, 2.4]))] == OCCUPIED


def test_a_way_goes_round_through_the_doorway(ground: Ground) -> None:
    path = ground.path(0, np.array([3.5, 2.5]), np.array([4.6, 2.5]), radius=0.25)
    assert path[:, 1].min() < 1.3
    assert path_length(path) > 2.5
    assert all(ground.is_free(p, 0.2) for p in path)
    assert not len(ground.path(0, np.array([3.5, 2.5]), np.array([4.6, 2.5]), radius=0.55))


def test_a_stair_leads_up_along_its_middle(upstairs: Ground) -> None:
    (flight,) = upstairs.flights
    assert (flight.lower, flight.upper) == (0, 1)
    np.testing.assert_allclose(flight.way[:, 1], 2.5, atol=1e-6)
    np.testing.assert_allclose(flight.way[:, 2], [0, 0, UPPER, UPPER])
    assert flight.way[0, 0] < 5 < flight.way[1, 0] < flight.way[2, 0] < 8.5 < flight.way[3, 0]
    assert upstairs.is_free(flight.way[3, :2], 0.2, floor=1)


def test_the_hole_over_a_stair_is_no_floor(upstairs: Ground) -> None:
    assert not upstairs.is_free(np.array([7.0, 2.5]), 0.0, floor=1)
    assert upstairs.is_free(np.array([7.0, 1.0]), 0.2, floor=1)
    assert not upstairs.is_free(np.array([7.0, 2.5]), 0.0, floor=0)


def test_the_tour_is_free_and_its_steps_are_small(ground: Ground, tour: list[F64]) -> None:
    params = TourParams()
    assert all(ground.is_free(pose[:2, 3], params.least_clearance) for pose in tour)
    for before, after in pairwise(tour):
        assert np.linalg.norm(after[:3, 3] - before[:3, 3]) <= params.step + 1e-6
        assert before[:3, 2] @ after[:3, 2] >= np.cos(params.turn) - 1e-6
        check_pose(after)
    assert all(pose[2, 3] == pytest.approx(1.3) for pose in tour)


def test_every_area_is_looked_at_from_several_sides(ground: Ground, tour: list[F64]) -> None:
    for area in ground.home.areas:
        middle = area.polygon.mean(axis=0)
        looks = []
        for pose in tour:
            away = middle - pose[:2, 3]
            forward = pose[:2, 2] / np.linalg.norm(pose[:2, 2])
            if np.linalg.norm(away) < 4 and away @ forward > np.linalg.norm(away) * np.cos(0.6):
                looks.append(np.arctan2(forward[1], forward[0]))
        sectors = {int((angle + np.pi) // (np.pi / 2)) for angle in looks}
        assert len(looks) > 10
        assert len(sectors) >= 2


def test_the_tour_climbs_to_the_storey_above(upstairs: Ground) -> None:
    tour = walk_through(upstairs.home, 0, ground=upstairs)
    z = np.array([pose[2, 3] for pose in tour])
    assert z[0] == pytest.approx(1.3)
    assert z[-1] == pytest.approx(UPPER + 1.3)
    assert np.diff(z).min() > -1e-6
    assert np.linalg.norm(np.diff([pose[:3, 3] for pose in tour], axis=0), axis=1).max() <= 0.25 + 1e-6
    for pose in tour:
        if abs(pose[2, 3] - 1.3 - UPPER) < 0.02 or abs(pose[2, 3] - 1.3) < 0.02:
            floor = upstairs.floor_at(pose[2, 3] - 1.3)
            assert upstairs.is_free(pose[:2, 3], 0.2, floor) or 4.4 < pose[0, 3] < 9.1


def test_a_seed_gives_the_same_tour_and_another_another(ground: Ground, tour: list[F64]) -> None:
    np.testing.assert_array_equal(walk_through(ground.home, 0, ground=ground), tour)
    other = walk_through(ground.home, 5, ground=ground)
    assert len(other) != len(tour) or (np.array(other) != np.array(tour)).any()


@pytest.mark.parametrize("frames", [40, 150, 400])
def test_a_tour_has_as_many_frames_as_are_wanted(ground: Ground, frames: int) -> None:
    tour = walk_through(ground.home, 1, frames, ground=ground)
    assert len(tour) == frames
    assert all(ground.is_free(pose[:2, 3], 0.2) for pose in tour)
    floors = {
        ground.home.area_at(0, pose[:2, 3]).area_id for pose in tour if ground.home.area_at(0, pose[:2, 3])
    }
    assert floors == {1, 2}
