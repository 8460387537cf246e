from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.walking import traversable
from services.retrieval.domain.viewpoints import (
    HEADINGS,
    ViewpointParams,
    plan_waypoints,
    snap,
    visible,
    yaw_of,
)
from tests.unit.services.retrieval.builders import grid_of, pose_at


def test_six_headings_are_sixty_degrees_apart() -> None:
    np.testing.assert_allclose(np.degrees(HEADINGS), [0, 60, 120, 180, 240, 300])


def test_a_wall_ends_the_view() -> None:
    grid = grid_of(
        """
        .......
        ...#...
        .......
        """,
        resolution=0.5,
    )
    seen = visible(grid, (1, 0), reach=5.0)
    assert seen[1, :3].all()
    assert not seen[1, 3:].any()
    assert seen[0, 6] or seen[2, 6]


def test_nothing_beyond_reach_is_seen() -> None:
    grid = grid_of("." * 20, resolution=0.5)
    assert np.flatnonzero(visible(grid, (0, 0), reach=3.0)[0]).max() == 6


def test_a_field_of_view_sees_ahead_only() -> None:
    grid = grid_of("\n".join(["." * 9] * 9), resolution=0.5)
    seen = visible(grid, (4, 4), reach=2.0, yaw=0.0, field_of_view=np.pi / 3)
    assert seen[4, 8]
    assert not seen[4, 0]
    assert not seen[8, 4]


def test_waypoints_stand_in_the_area_with_clearance_and_see_all_of_it() -> None:
    grid = grid_of("\n".join(["#" * 22, *["#" + "a" * 20 + "#"] * 12, "#" * 22]), 0.25, {"a": "r1"})
    area = grid.regions == 1
    standing = traversable(grid, 0.4)
    chosen = plan_waypoints(grid, area, standing, ViewpointParams(reach=3.0, views=1))
    assert chosen
    assert all(standing[cell] and area[cell] for cell in chosen)
    seen = np.any([visible(grid, cell, 3.0) for cell in chosen], axis=0)
    assert seen[area].mean() > 0.97


def test_each_cell_is_seen_from_as_many_waypoints_as_votes_are_needed() -> None:
    grid = grid_of("\n".join(["a" * 16] * 16), 0.25, {"a": "r1"})
    area = grid.regions == 1
    chosen = plan_waypoints(grid, area, traversable(grid, 0.2), ViewpointParams(reach=3.0, views=3))
    times = np.sum([visible(grid, cell, 3.0) for cell in chosen], axis=0)
    assert (times[area] >= 3).mean() > 0.95


def test_an_area_without_a_place_to_stand_gets_none() -> None:
    grid = grid_of("aaaa\n####", 0.25, {"a": "r1"})
    assert plan_waypoints(grid, grid.regions == 1, np.zeros((2, 4), bool)) == ()
    assert plan_waypoints(grid, np.zeros((2, 4), bool), np.ones((2, 4), bool)) == ()


def test_a_nook_that_cannot_be_entered_is_looked_into_from_outside() -> None:
    grid = grid_of("bbaa", 0.5, {"a": "r1", "b": "r2"})
    outside = grid.regions == 2
    chosen = plan_waypoints(grid, grid.regions == 1, outside, ViewpointParams(least_gain=0.0))
    assert chosen
    assert all(outside[cell] for cell in chosen)


def test_snapping_takes_the_nearest_standing_cell_within_reach() -> None:
    standing = np.array([[False, False, True, True]])
    assert snap(standing, (0, 0), 2.0) == (0, 2)
    assert snap(standing, (0, 0), 1.5) is None
    assert snap(np.zeros((1, 4), bool), (0, 0), 9.0) is None


def test_a_camera_faces_along_its_optical_axis() -> None:
    assert abs(yaw_of(pose_at(0, 0, 1.0)) - 1.0) < 1e-9


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**31 - 1))
def test_sight_is_never_through_a_full_wall(seed: int) -> None:
    rng = np.random.default_rng(seed)
    occupancy = np.where(rng.random((20, 21)) < 0.1, OCCUPIED, FREE).astype(np.uint8)
    occupancy[:, 10] = OCCUPIED
    occupancy[5, 3] = FREE
    grid = FloorGrid(0, (0.0, 0.0), 0.1, occupancy, np.zeros((20, 21), np.uint16))
    assert not visible(grid, (5, 3), 4.0)[:, 11:].any()
