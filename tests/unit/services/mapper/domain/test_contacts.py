from __future__ import annotations

import numpy as np
import pytest

from services.mapper.domain.contacts import (
    Face,
    closed_sides,
    plan_extents,
    plan_gap,
    plan_thickness,
    vertical_plane,
)


def cloud(*rows: tuple[float, float, float]) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    return np.array(rows, np.float32).reshape(-1, 3)


def rectangle(x0: float, y0: float, x1: float, y1: float, degrees: float = 0.0) -> np.ndarray:
    """A cloud of an upright block's outline, turned about the origin."""
    side = np.linspace(0, 1, 41)
    x, y = np.meshgrid(x0 + (x1 - x0) * side, y0 + (y1 - y0) * side)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.stack([c * x - s * y, s * x + c * y, 0 * x], axis=-1).reshape(-1, 3).astype(np.float32)


def test_a_face_has_cells_of_four_centimetres_and_a_rim() -> None:
    face = Face.of(np.array([0.0, 0.0, 0.12, 0.2]), rim=0.06)
    assert (face.cells, face.rim) == ((3 + 4, 5 + 4), (2, 2))
    assert face.low == pytest.approx([-0.08, -0.08])
    on, flat = face.cells_of(np.array([[0.01, 0.01], [-0.07, 0.27], [0.5, 0.1]]))
    assert on.tolist() == [0, 1]
    assert flat.tolist() == [2 * 9 + 2, 0 * 9 + 8]


@pytest.mark.parametrize(("extent", "cells"), [(0.0, 2), (0.04, 2), (0.4, 10), (9.0, 32)])
def test_a_face_has_two_to_thirty_two_cells_a_side(extent: float, cells: int) -> None:
    assert Face.of(np.array([0.0, 0.0, extent, extent]), rim=0.0).cells == (cells, cells)


def test_cells_between_set_ones_are_backed_and_cells_beside_them_are_not() -> None:
    face = Face.of(np.array([0.0, 0.0, 0.12, 0.12]), rim=0.04)  # 3 x 3 cells in a rim of one
    grid = np.zeros((5, 5), np.bool_)
    assert not face.backed(grid).any()
    grid[2, 0] = grid[2, 4] = True  # both ends of the middle row, in the rim
    assert face.backed(grid).tolist() == [[False] * 3, [True] * 3, [False] * 3]
    grid[2, 4] = False
    assert not face.backed(grid).any()
    grid[1, 1] = True
    assert face.backed(grid).sum() == 1


def test_edges_tell_beside_which_cells_the_rim_is_set() -> None:
    face = Face.of(np.array([0.0, 0.0, 0.08, 0.12]), rim=0.04)  # 2 x 3 cells in a rim of one
    grid = np.zeros((4, 5), np.bool_)
    grid[0, 1] = grid[1, 4] = grid[0, 0] = True  # the corner counts for no edge
    low, high, left, right = face.edges(grid)
    assert (low.tolist(), high.tolist()) == ([True, False, False], [False] * 3)
    assert (left.tolist(), right.tolist()) == ([False] * 2, [True, False])


@pytest.mark.parametrize("degrees", [0, 15, 45, 90])
def test_the_gap_between_blocks_does_not_hang_on_how_they_are_turned(degrees: float) -> None:
    one, other = rectangle(-1, 0, 1, 0.3, degrees), rectangle(-1, 0.5, 1, 1.0, degrees)
    assert plan_gap(plan_extents(one), plan_extents(other)) == pytest.approx(0.2, abs=1e-5)
    assert plan_gap(plan_extents(one), plan_extents(one)) == 0.0


def test_the_gap_between_two_points_is_the_way_between_them() -> None:
    one, other = plan_extents(cloud((0, 0, 0))), plan_extents(cloud((3, 4, 9)))
    assert plan_gap(one, other) == pytest.approx(5.0, rel=2e-3)


def test_thickness_is_across_the_thinnest_way_and_leaves_out_strays() -> None:
    wall = rectangle(-2, 0, 2, 0.1, 30)
    strays = cloud(*[(0.0, 1.5, 1.0)] * 5)
    assert plan_thickness(wall) == pytest.approx(0.1, abs=0.01)
    assert plan_thickness(np.concatenate([wall, strays])) == pytest.approx(0.1, abs=0.01)


def test_a_side_is_closed_by_what_lies_beyond_the_middle_of_a_box() -> None:
    box = np.array([0.0, 0, 0, 0.4, 0.4, 0.4])
    grid = np.stack(np.meshgrid(np.linspace(0.01, 0.39, 20), np.linspace(0.01, 0.39, 20)), axis=-1)
    wall = grid.reshape(-1, 2).astype(np.float32)
    beyond = np.column_stack([np.full(len(wall), 3.0, np.float32), wall])
    assert closed_sides(beyond, box, 0.0).tolist() == [0, 1, 0, 0, 0, 0]
    below = np.column_stack([wall, np.full(len(wall), -2.0, np.float32)])
    assert closed_sides(below, box, 0.0).tolist() == [0, 0, 0, 0, 1, 0]
    assert closed_sides(cloud(), box, 0.0).tolist() == [0] * 6


def test_what_a_thing_lies_on_closes_none_of_its_sides() -> None:
    seat = rectangle(-1, -1, 1, 1)
    box = np.array([-0.2, -0.2, 0.0, 0.2, 0.2, 0.4])
    assert closed_sides(seat, box, 0.06)[:4].tolist() == [0] * 4
    flat = np.array([-0.2, -0.2, 0.0, 0.2, 0.2, 0.001])
    noisy = seat + np.array([0, 0, 0.02], np.float32)
    assert closed_sides(noisy, flat, 0.06)[:4].tolist() == [0] * 4


def test_an_upright_plane_is_found_among_some_points_off_it() -> None:
    wall = np.stack(np.meshgrid(np.linspace(0, 2, 30), np.linspace(0, 2, 30)), axis=-1).reshape(-1, 2)
    at_three = np.column_stack([wall[:, 0], np.full(len(wall), 3.0), wall[:, 1]]).astype(np.float32)
    lamp = np.tile(cloud((1.0, 2.5, 1.0)), (60, 1))
    found = vertical_plane(np.concatenate([at_three, lamp]))
    assert found is not None
    normal, offset, flat = found
    assert abs(normal[1]) == pytest.approx(1.0, abs=1e-3)
    assert abs(offset) == pytest.approx(3.0, abs=0.01)
    assert flat.sum() == len(at_three)


def test_a_table_top_and_two_points_are_no_upright_plane() -> None:
    assert vertical_plane(rectangle(0, 0, 1, 1)) is None
    assert vertical_plane(cloud((0, 0, 0), (1, 0, 0))) is None
