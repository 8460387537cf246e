"""Frontiers: where to explore, on maps of 5 cm cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import U8, Bools
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.frontiers import Border, FrontierParams, find_frontiers


def space(occupancy: U8, wall: Bools | None = None, origin: tuple[float, float] = (0.0, 0.0)) -> FreeSpace:
    wall = np.zeros(occupancy.shape, bool) if wall is None else wall
    return FreeSpace(origin, 0.05, (occupancy != UNKNOWN) & ~wall, wall, occupancy)


def closed_room(rows: int = 60, columns: int = 80) -> tuple[U8, Bools]:
    """A room with a wall around it, and 1.5 m of what nobody knows around that."""
    occupancy = np.full((rows + 62, columns + 62), UNKNOWN, np.uint8)
    wall = np.zeros(occupancy.shape, bool)
    wall[30:-30, 30:-30] = True
    wall[31:-31, 31:-31] = False
    occupancy[30:-30, 30:-30] = np.where(wall[30:-30, 30:-30], OCCUPIED, FREE)
    return occupancy, wall


def found(occupancy: U8, wall: Bools) -> list[tuple[float, float, float]]:
    """x, y and width of each border, metres."""
    return [
        (*np.round(border.position[:2], 3).tolist(), round(border.width, 3))
        for border in find_frontiers(space(occupancy, wall), 0.0)
    ]


def test_a_room_seen_whole_has_none() -> None:
    assert found(*closed_room()) == []


def test_an_open_door_to_an_unseen_room_is_one_as_wide_as_the_door() -> None:
    occupancy, wall = closed_room()
    occupancy[50:68, 30], wall[50:68, 30] = FREE, False  # 18 cells in the left wall, rows 50 to 67
    (border,) = find_frontiers(space(occupancy, wall), 2.8)
    assert border.width == pytest.approx(0.9)
    assert border.cell == (58, 30)
    assert border.position.tolist() == pytest.approx([30.5 * 0.05, 58.5 * 0.05, 2.8])
    assert occupancy[border.cell] == FREE


def test_a_room_seen_from_its_door_has_one_inside() -> None:
    occupancy, wall = closed_room(60, 60)
    rows, columns = np.mgrid[:122, :122]
    unseen = (rows - 31 > columns - 31) & (rows < 91) & (columns > 30) & (columns < 91) & ~wall
    occupancy[unseen] = UNKNOWN  # the camera stood in one corner and saw up to the diagonal
    (border,) = find_frontiers(space(occupancy, wall), 0.0)
    assert 3.5 <= border.width <= 3.0 * np.sqrt(2)  # without the acute corners, which are thin
    assert 55 <= border.cell[0] <= 66
    assert abs(border.cell[0] - border.cell[1]) <= 1


def test_the_end_of_the_grid_is_unknown_and_chords_cut_its_corners() -> None:
    (border,) = find_frontiers(space(np.full((30, 40), FREE, np.uint8)), 0.0)
    straight, corner = 2 * (1.0 + 0.5), np.hypot(0.5, 0.5)
    assert border.width == pytest.approx(straight + 4 * corner)


def test_a_border_along_furniture_or_a_wall_is_none() -> None:
    occupancy, wall = closed_room()
    occupancy[31:91, 50:55] = OCCUPIED  # shelves across the room, nothing known behind them
    occupancy[31:91, 55:111] = UNKNOWN
    assert found(occupancy, wall) == []


def test_a_short_border_is_none() -> None:
    occupancy, wall = closed_room()
    occupancy[50:59, 30], wall[50:59, 30] = FREE, False
    assert found(occupancy, wall) == []
    assert len(find_frontiers(space(occupancy, wall), 0.0, FrontierParams(min_width=0.45))) == 1


@pytest.mark.parametrize(("side", "borders"), [(19, 0), (21, 1)])
def test_a_hole_that_known_floor_encloses_counts_from_a_square_metre_on(side: int, borders: int) -> None:
    occupancy, wall = closed_room()
    occupancy[45 : 45 + side, 50 : 50 + side] = UNKNOWN
    assert len(found(occupancy, wall)) == borders


def test_a_slit_beside_furniture_is_no_place_to_explore() -> None:
    occupancy, wall = closed_room()
    occupancy[31:35, 31:111] = UNKNOWN  # four cells along a wall
    assert found(occupancy, wall) == []
    occupancy[31:36, 31:111] = UNKNOWN  # five are a quarter of a metre
    assert len(found(occupancy, wall)) == 1


def test_floor_that_rays_passed_over_is_seen_and_what_lies_behind_it_is_the_frontier() -> None:
    occupancy, wall = closed_room()
    occupancy[31:91, 71:] = UNKNOWN
    wall[:, 72:] = False
    here = space(occupancy, wall)
    over = here.free.copy()
    over[31:91, 71:81] = True
    (border,) = find_frontiers(FreeSpace(here.origin, 0.05, over, wall, occupancy), 0.0)
    assert border.cell[1] == 80
    assert border.width == pytest.approx(3.0)


def test_a_speck_of_floor_behind_a_window_has_no_frontier() -> None:
    occupancy, wall = closed_room()
    occupancy[5:20, 5:25] = FREE
    assert found(occupancy, wall) == []


def test_the_footprint_of_stairs_is_no_unknown_floor() -> None:
    occupancy, wall = closed_room()
    known = np.zeros(occupancy.shape, bool)
    occupancy[40:60, 40:100], known[40:60, 40:100] = UNKNOWN, True
    assert len(find_frontiers(space(occupancy, wall), 0.0)) == 1
    assert find_frontiers(space(occupancy, wall), 0.0, known=known) == ()


def test_nothing_known_has_none() -> None:
    assert find_frontiers(space(np.zeros((0, 0), np.uint8)), 0.0) == ()
    assert find_frontiers(space(np.full((40, 40), UNKNOWN, np.uint8)), 0.0) == ()


def same(one: Border, other: Border, shift: tuple[float, float]) -> bool:
    moved = np.array([*shift, 0.0]) + one.position
    return bool(np.allclose(moved, other.position)) and one.cell == other.cell and one.width == other.width


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.tuples(st.integers(-100, 100), st.integers(-100, 100)))
def test_whole_cells_of_shift_move_them_and_each_lies_on_seen_floor_beside_the_unknown(
    seed: int, shift: tuple[int, int]
) -> None:
    rng = np.random.default_rng(seed)
    coarse = rng.choice(np.array([UNKNOWN, FREE, FREE, OCCUPIED], np.uint8), (6, 6))
    occupancy = np.repeat(np.repeat(coarse, 13, axis=0), 13, axis=1)
    moved = (shift[0] * 0.05, shift[1] * 0.05)
    borders = find_frontiers(space(occupancy), 0.0)
    again = find_frontiers(space(occupancy, origin=moved), 0.0)
    assert len(borders) == len(again)
    assert all(same(one, other, moved) for one, other in zip(borders, again, strict=True))
    around = np.pad(occupancy, 1, constant_values=UNKNOWN)
    for border in borders:
        row, column = border.cell
        assert occupancy[row, column] == FREE
        assert (around[row : row + 3, column : column + 3] == UNKNOWN).any()
        assert border.width >= 0.5 - 1e-6
