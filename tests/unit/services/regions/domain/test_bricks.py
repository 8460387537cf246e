"""Bricks: exact counts of boxes, wherever they are, and their sums by column."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.regions.domain.bricks import BOXES, Bricks, Window, unblocked
from services.regions.domain.counts import SPAN, Counts, pack_voxel, unpack_voxel

INDEX = st.tuples(*[st.integers(-20, 20)] * 3)
FAR = st.tuples(*[st.integers(-SPAN, SPAN - 1)] * 3)
AMOUNTS = st.lists(st.tuples(st.one_of(INDEX, FAR), st.integers(1, 70_000)), max_size=12)


def keys(*index: tuple[int, int, int]) -> np.ndarray:
    return pack_voxel(np.array(index, np.int64).reshape(-1, 3))


def of(*boxes: tuple[tuple[int, int, int], int]) -> Bricks:
    bricks = Bricks()
    for index, amount in boxes:
        bricks.add(keys(index), np.array([amount]))
    return bricks


@settings(max_examples=60, deadline=None)
@given(AMOUNTS)
def test_bricks_count_what_sorted_keys_count(boxes: list) -> None:
    sparse = Counts()
    for index, amount in boxes:
        sparse.add(keys(index), np.array([amount]))
    for found, told in zip(of(*boxes).items(), sparse.items(), strict=True):
        assert found.tolist() == told.tolist()


@pytest.mark.parametrize("amount", [255, 256, 65_535, 65_536, 2**32, 2**40])
def test_a_count_outgrows_no_width(amount: int) -> None:
    bricks = of(((1, 2, 3), amount), ((1, 2, 4), 7))
    bricks.raise_at(np.array([[1, 2, 3]]))
    assert bricks.items()[1].tolist() == [amount + 1, 7]


def test_keys_that_repeat_add_up() -> None:
    bricks = Bricks()
    bricks.add(keys((0, 0, 0), (0, 0, 0), (-1, 0, 0)))
    assert unpack_voxel(bricks.items()[0]).tolist() == [[-1, 0, 0], [0, 0, 0]]
    assert bricks.items()[1].tolist() == [1, 2]


def test_nothing_counted_has_no_layers_and_no_window() -> None:
    bricks = Bricks()
    bricks.raise_at(np.zeros((0, 3), np.int64))
    assert bricks.used_layers().tolist() == []
    assert bricks.window(-10, 10) is None
    assert list(bricks.read(bricks.changed(0))) == []
    assert not bricks.sums([(0, 5)], Window((0, 0), (8, 8))).any()


def test_used_layers_are_those_with_a_count() -> None:
    assert of(((0, 0, -9), 1), ((90, 0, 4), 1), ((0, 5, 4), 2)).used_layers().tolist() == [-9, 4]


def test_a_window_holds_whole_bricks_of_the_layers_asked_for() -> None:
    bricks = of(((-3, 5, 2), 1), ((17, 5, 2), 1), ((100, 100, 40), 1))
    assert bricks.window(0, 8) == Window((-8, 0), (24, 8))
    assert bricks.window(8, 16) is None


def test_a_columns_sum_is_that_of_the_bands_layers() -> None:
    """Column (x 1, y -2): 5 in layer 3, 7 in layer 9, 2 in layer 10; the band 4 .. 10 holds the 7 alone."""
    bricks = of(((1, -2, 3), 5), ((1, -2, 9), 7), ((1, -2, 10), 2))
    window = Window((0, -8), (8, 0))
    layers = [(0, 11), (4, 10), (11, 20)]
    sums, filled = bricks.sums(layers, window), bricks.filled(layers, window)
    column = [unblocked(sums[k], window)[6, 1].item() for k in range(3)]
    assert column == [14, 7, 0]
    assert [unblocked(filled[k], window)[6, 1].item() for k in range(3)] == [3, 1, 0]
    assert sums.sum() == 21


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(INDEX, st.integers(1, 400)), min_size=1, max_size=12),
    st.integers(-22, 22),
    st.integers(0, 25),
)
def test_sums_agree_with_adding_box_by_box(boxes: list, low: int, height: int) -> None:
    bricks, window = of(*boxes), Window((-13, -6), (9, 21)).of_bricks()
    told = np.zeros(window.shape, np.int64)
    some: set[tuple[int, int, int]] = set()
    for (x, y, z), amount in boxes:
        if low <= z < low + height and 0 <= x + 16 < 32 and 0 <= y + 8 < 32:
            told[y + 8, x + 16] += amount
            some.add((x, y, z))
    assert window == Window((-16, -8), (16, 24))
    assert (unblocked(bricks.sums([(low, low + height)], window)[0], window) == told).all()
    assert bricks.filled([(low, low + height)], window).sum() == len(some)


def test_changed_names_the_bricks_raised_after_a_time() -> None:
    bricks = Bricks()
    bricks.raise_at(np.array([[0, 0, 0], [9, 0, 0]]), time=1)
    bricks.raise_at(np.array([[1, 0, 0]]), time=2)
    assert unpack_voxel(bricks.changed(0)).tolist() == [[0, 0, 0], [1, 0, 0]]
    assert unpack_voxel(bricks.changed(1)).tolist() == [[0, 0, 0]]
    assert bricks.changed(2).tolist() == []


def test_a_brick_written_is_what_was_read() -> None:
    bricks, copy = of(((1, 2, 3), 300), ((-70, 2, 3), 1)), of(((1, 2, 3), 9), ((2, 2, 3), 9))
    names = bricks.changed(0)
    (blocks,) = bricks.read(names)
    assert blocks.shape == (2, BOXES)
    copy.write(names, blocks, 1)
    assert [found.tolist() for found in copy.items()] == [found.tolist() for found in bricks.items()]


def test_a_window_within_another_is_its_rows_and_columns() -> None:
    rows, columns = Window((3, 4), (5, 9)).inside(Window((0, 2), (8, 10)))
    assert (rows, columns) == (slice(2, 7), slice(3, 5))
