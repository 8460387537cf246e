"""Walking on the floor grid: clearance, inflation, distances and paths."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.walking import (
    clearance,
    close_footprints,
    distance_field,
    path_length,
    shortest_path,
    straighten,
    traversable,
)

OCCUPANCIES = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
    elements=st.sampled_from([UNKNOWN, FREE, OCCUPIED]),
)


def grid_of(*rows: str, resolution: float = 0.5, origin: tuple[float, float] = (0.0, 0.0)) -> FloorGrid:
    """A grid drawn in text: `.` free, `#` occupied, `?` unknown; the first row has the lowest y."""
    code = {".": FREE, "#": OCCUPIED, "?": UNKNOWN}
    occupancy = np.array([[code[c] for c in row] for row in rows], dtype=np.uint8)
    return FloorGrid(0, origin, resolution, occupancy, np.zeros(occupancy.shape, np.uint16))


def test_cell_of_and_xy_of_are_inverse() -> None:
    grid = grid_of("...", "...", origin=(-1.0, 2.0))
    assert grid.xy_of(1, 2).tolist() == [0.25, 2.75]
    assert grid.cell_of(grid.xy_of(1, 2)) == (1, 2)


def test_clearance_is_the_distance_to_the_edge_of_an_occupied_cell() -> None:
    assert clearance(grid_of("#...")).tolist() == [[0.0, 0.25, 0.75, 1.25]]
    assert clearance(grid_of("#.", ".."))[1, 1] == pytest.approx(np.hypot(0.25, 0.25))


@settings(max_examples=60, deadline=None)
@given(OCCUPANCIES)
def test_nothing_in_an_occupied_cell_is_nearer_than_the_clearance(occupancy: np.ndarray) -> None:
    grid = FloorGrid(0, (-1.0, 3.0), 0.25, occupancy, np.zeros(occupancy.shape, np.uint16))
    cells = np.argwhere(occupancy == OCCUPIED)
    for row, column in np.argwhere(occupancy == FREE):
        apart = np.maximum(np.abs(cells - (row, column)) - 0.5, 0.0) * grid.resolution
        nearest = np.hypot(*apart.T).min() if len(cells) else np.inf
        assert clearance(grid)[row, column] == pytest.approx(nearest)


def test_unknown_is_no_obstacle_but_cannot_be_stood_on() -> None:
    assert clearance(grid_of("#..?")).tolist() == [[0.0, 0.25, 0.75, 0.0]]
    assert traversable(grid_of(".?"), 3.0).tolist() == [[True, False]]


def test_clearance_is_infinite_where_nothing_is_occupied() -> None:
    assert np.isinf(clearance(grid_of(".."))).all()


def test_a_cell_exactly_the_radius_away_is_traversable() -> None:
    assert traversable(grid_of("#..."), 0.75).tolist() == [[False, False, True, True]]


@settings(max_examples=60, deadline=None)
@given(OCCUPANCIES, st.floats(0.0, 9.0))
def test_where_a_robot_may_stand_is_where_the_clearance_is_its_radius(
    occupancy: np.ndarray, radius: float
) -> None:
    grid = FloorGrid(0, (-1.0, 3.0), 0.25, occupancy, np.zeros(occupancy.shape, np.uint16))
    standing = (occupancy == FREE) & (clearance(grid) >= radius)
    assert traversable(grid, radius).tolist() == standing.tolist()


def test_footprints_close_the_cells_whose_centres_they_cover() -> None:
    grid = close_footprints(grid_of("....", "...."), np.array([[0.25, 0.0, 0.0, 0.75, 0.5, 1.0]]))
    assert (grid.occupancy == OCCUPIED).tolist() == [[True, True, False, False], [False] * 4]


def test_a_footprint_outside_the_grid_closes_nothing() -> None:
    grid = grid_of("..")
    assert close_footprints(grid, np.array([[-9.0, -9, 0, -8, -8, 1], [5, 0, 0, 6, 1, 1]])).occupancy.all()
    assert (close_footprints(grid, np.zeros((0, 6))).occupancy == FREE).all()


def test_the_field_goes_around_a_wall_without_cutting_its_corner() -> None:
    open_floor = np.array([[1, 0, 1], [1, 1, 1]], dtype=bool)
    field = distance_field(open_floor, (0, 0), 1.0)
    assert field[0, 2] == pytest.approx(4.0)
    assert np.isinf(field[0, 1])


def test_a_diagonal_step_is_root_two() -> None:
    field = distance_field(np.ones((2, 2), bool), (0, 0), 0.5)
    assert field[1, 1] == pytest.approx(0.5 * np.sqrt(2.0))


@pytest.mark.parametrize("start", [(0, 1), (-1, 0), (5, 5)])
def test_a_start_that_cannot_be_stood_on_reaches_nothing(start: tuple[int, int]) -> None:
    assert np.isinf(distance_field(np.array([[True, False]]), start, 1.0)).all()


def test_no_cells_at_all_is_no_error() -> None:
    assert distance_field(np.zeros((0, 0), bool), (0, 0), 1.0).shape == (0, 0)
    assert shortest_path(grid_of("##"), np.zeros(2), np.ones(2), 0.0).shape == (0, 2)


def test_a_path_leads_from_cell_centre_to_cell_centre() -> None:
    path = shortest_path(grid_of("...", "...", "..."), np.array([0.1, 0.1]), np.array([1.4, 1.4]), 0.0)
    assert path.tolist() == [[0.25, 0.25], [0.75, 0.75], [1.25, 1.25]]


def test_start_and_goal_in_one_cell_is_a_path_of_one_point() -> None:
    path = shortest_path(grid_of("."), np.array([0.1, 0.1]), np.array([0.4, 0.2]), 0.0)
    assert path.tolist() == [[0.25, 0.25]]


def test_a_goal_on_furniture_ends_beside_it() -> None:
    path = shortest_path(grid_of("...##"), np.array([0.2, 0.2]), np.array([1.9, 0.2]), 0.0)
    assert path[-1].tolist() == [1.25, 0.25]


def test_a_goal_beside_a_wall_ends_on_the_side_that_can_be_reached() -> None:
    grid = grid_of("....##.")
    path = shortest_path(grid, np.array([0.2, 0.2]), np.array([2.6, 0.2]), 0.0)
    assert path[-1].tolist() == [1.75, 0.25]


def test_a_goal_out_of_reach_has_no_path() -> None:
    assert shortest_path(grid_of(".."), np.zeros(2), np.array([9.0, 0.0]), 0.0, reach=1.0).shape == (0, 2)


def test_a_robot_too_wide_for_the_door_has_no_path() -> None:
    grid = grid_of(*["....#....", "....#....", ".........", "....#....", "....#...."])
    start, goal = np.array([0.25, 1.25]), np.array([4.25, 1.25])
    assert len(shortest_path(grid, start, goal, 0.25, reach=0.5)) == 9
    assert len(shortest_path(grid, start, goal, 0.3, reach=0.5)) == 0


def test_straightening_keeps_the_ends_and_the_corner() -> None:
    grid = grid_of(".....", "...#.", "...#.")
    path = shortest_path(grid, np.array([0.25, 1.25]), np.array([2.25, 1.25]), 0.0)
    short = straighten(grid, path, 0.0)
    assert short[0].tolist() == path[0].tolist()
    assert short[-1].tolist() == path[-1].tolist()
    assert len(short) < len(path)
    assert path_length(short) <= path_length(path)


def test_a_long_straight_stretch_is_walked_to_the_farthest_point_in_sight() -> None:
    rows = ["." * 60] * 4 + ["." * 20 + "#" * 20 + "." * 20] * 30
    grid = grid_of(*rows)
    path = shortest_path(grid, np.array([5.0, 15.0]), np.array([25.0, 15.0]), 0.0)
    short = straighten(grid, path, 0.0)
    assert len(short) == 4
    assert short[1][0] < 10.0 < 20.0 < short[2][0]
    assert path_length(short) < path_length(path)


def test_the_length_of_no_path_is_zero() -> None:
    assert path_length(np.zeros((0, 2))) == 0.0


@settings(max_examples=80, deadline=None)
@given(OCCUPANCIES, st.floats(0.0, 0.8), st.data())
def test_a_path_walks_traversable_neighbours_as_far_as_the_field_says(
    occupancy: np.ndarray, radius: float, data: st.DataObject
) -> None:
    grid = FloorGrid(0, (-1.0, 3.0), 0.25, occupancy, np.zeros(occupancy.shape, np.uint16))
    rows, columns = occupancy.shape
    start = (data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1)))
    goal = (data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1)))
    path = shortest_path(grid, grid.xy_of(*start), grid.xy_of(*goal), radius, reach=9.0)
    walkable = traversable(grid, radius)
    assert len(path) == 0 if not walkable.any() else len(path) > 0
    if not len(path):
        return
    cells = [grid.cell_of(point) for point in path]
    assert all(walkable[cell] for cell in cells)
    assert all(max(abs(a - c), abs(b - d)) == 1 for (a, b), (c, d) in itertools.pairwise(cells))
    field = distance_field(walkable, cells[0], grid.resolution)
    assert path_length(path) == pytest.approx(field[cells[-1]], abs=1e-9)
    if walkable[start] and np.isfinite(distance_field(walkable, start, 0.25)[goal]):
        assert (cells[0], cells[-1]) == (start, goal)
