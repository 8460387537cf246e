"""Staleness: what is enough to cut a floor again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.errors import Corrupt
from ovip.scene.types import Bools
from services.regions.domain.staleness import Basis, is_stale, same_floors

CELL = 0.05


def basis(free: Bools, origin: tuple[float, float] = (0.0, 0.0)) -> Basis:
    return Basis(
        origin=origin,
        resolution=CELL,
        shape=(free.shape[0], free.shape[1]),
        packed=np.packbits(free),
        ids=("a", "b"),
        labels=("bed", "stove"),
        functions=("bedroom", "kitchen"),
        centres=np.array([[1.0, 1.0], [2.0, 2.0]]),
    )


def floor(rows: int, columns: int, free: int) -> Bools:
    """The first `free` cells of a grid free, in row-major order."""
    cells = np.zeros(rows * columns, bool)
    cells[:free] = True
    return cells.reshape(rows, columns)


SMALL = basis(floor(100, 100, 8000))  # 20 m2: half a square metre is 200 cells


def test_a_floor_that_was_never_cut_is_stale_and_one_that_is_as_it_was_is_not() -> None:
    assert is_stale(None, SMALL)
    assert not is_stale(SMALL, SMALL)


def test_half_a_square_metre_of_free_space_come_or_gone_is_not_yet_enough() -> None:
    for cells, stale in ((8200, False), (8201, True), (7800, False), (7799, True)):
        assert is_stale(SMALL, basis(floor(100, 100, cells))) is stale


def test_on_a_large_floor_it_is_a_hundredth_of_it() -> None:
    large = basis(floor(400, 400, 80_000))  # 200 m2: two square metres are 800 cells
    assert not is_stale(large, basis(floor(400, 400, 80_800)))
    assert is_stale(large, basis(floor(400, 400, 80_801)))


def test_a_small_room_is_enough_on_a_floor_of_any_size() -> None:
    huge = basis(floor(1000, 1000, 600_000))  # 1500 m2: a hundredth were 15 m2, five are 2000 cells
    assert not is_stale(huge, basis(floor(1000, 1000, 602_000)))
    assert is_stale(huge, basis(floor(1000, 1000, 602_001)))


def test_what_comes_in_one_place_does_not_make_up_for_what_goes_in_another() -> None:
    free = SMALL.free.copy()
    free[:2, :75], free[90:92, :75] = False, True  # 150 cells each way
    assert is_stale(SMALL, basis(free))


def test_a_grid_that_starts_elsewhere_is_compared_place_by_place() -> None:
    wide = np.zeros((130, 120), bool)
    wide[10:110, 15:115] = SMALL.free
    assert not is_stale(SMALL, basis(wide, origin=(-15 * CELL, -10 * CELL)))
    assert is_stale(SMALL, basis(wide, origin=(-16 * CELL, -13 * CELL)))


def test_any_object_that_comes_goes_or_is_renamed_makes_its_floor_stale() -> None:
    fewer = replace(SMALL, ids=("a",), labels=("bed",), functions=("bedroom",), centres=SMALL.centres[:1])
    assert is_stale(SMALL, fewer)
    assert is_stale(fewer, SMALL)
    assert is_stale(SMALL, replace(SMALL, ids=("a", "c")))
    assert is_stale(SMALL, replace(SMALL, labels=("bed", "oven")))
    assert is_stale(SMALL, replace(SMALL, functions=("bedroom", "dining area")))


def test_a_function_that_a_vlm_confirms_makes_its_floor_stale_and_is_kept_in_the_bytes() -> None:
    confirmed = replace(SMALL, told=(True, False))
    assert is_stale(SMALL, confirmed)
    kept = Basis.from_bytes(confirmed.to_bytes())
    assert kept.told == (True, False)
    assert not is_stale(kept, confirmed)


def test_an_object_must_move_over_half_a_metre_in_the_plane() -> None:
    assert not is_stale(SMALL, replace(SMALL, centres=SMALL.centres + np.array([0.3, 0.4])))
    assert is_stale(SMALL, replace(SMALL, centres=SMALL.centres + np.array([0.31, 0.4])))


def test_a_floor_without_cells_or_objects_can_be_compared() -> None:
    nothing = Basis((0.0, 0.0), CELL, (0, 0), np.zeros(0, np.uint8), (), (), (), np.zeros((0, 2)))
    assert not is_stale(nothing, nothing)
    assert is_stale(nothing, SMALL)


def test_floors_are_the_same_by_their_height_not_by_their_number() -> None:
    assert same_floors([0.0, 2.9], [-2.8, 0.02, 2.85, 5.8]) == (None, 0, 1, None)
    assert same_floors([], [0.0]) == (None,)


@given(hnp.arrays(bool, st.tuples(st.integers(0, 9), st.integers(0, 9))), st.text(max_size=5))
def test_a_basis_is_the_same_after_its_bytes(free: Bools, word: str) -> None:
    one = replace(basis(free, origin=(-0.35, 1.1)), labels=("bed", word))
    again = Basis.from_bytes(one.to_bytes())
    assert again.free.tolist() == free.tolist()
    assert again.to_bytes() == one.to_bytes()
    assert not is_stale(one, again)


@pytest.mark.parametrize("cut", [0, 1, 20, -1])
def test_bytes_that_are_no_basis_are_corrupt(cut: int) -> None:
    with pytest.raises(Corrupt):
        Basis.from_bytes(SMALL.to_bytes()[:cut])
    with pytest.raises(Corrupt):
        Basis.from_bytes(b"no basis")
