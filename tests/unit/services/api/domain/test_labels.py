"""Where words stand on a plan."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.api.domain.labels import Label, LabelSpace, overlap
from services.api.domain.lettering import Line

CELL = 4.0
WORD = (Line("kitchen", 12),)
LARGE = (Line("kitchen", 40),)


def space(regions: np.ndarray, busy: np.ndarray | None = None, walls: np.ndarray | None = None) -> LabelSpace:
    nothing = np.zeros(regions.shape, bool)
    return LabelSpace(
        regions.astype(np.int32),
        nothing if busy is None else busy,
        nothing if walls is None else walls,
        CELL,
        (100.0, 50.0),
    )


def middle(label: Label | None) -> tuple[float, float]:
    assert label is not None
    return (label.box[0] + label.box[2]) / 2, (label.box[1] + label.box[3]) / 2


def room() -> np.ndarray:
    """A room of 40 x 60 cells in a picture of 60 x 80."""
    regions = np.zeros((60, 80))
    regions[10:50, 10:70] = 1
    return regions


def test_a_name_stands_in_the_middle_of_an_empty_room() -> None:
    x, y = middle(space(room()).name(1, [WORD]))

    assert x == pytest.approx(100 + 40 * CELL, abs=CELL)
    assert y == pytest.approx(50 + 30 * CELL, abs=CELL)


def test_a_name_stands_in_the_wide_end_of_a_room_with_a_corridor() -> None:
    regions = np.zeros((60, 200))
    regions[28:34, 10:150] = 1
    regions[10:50, 150:190] = 1

    x, _ = middle(space(regions).name(1, [WORD]))

    assert x > 100 + 155 * CELL


def test_a_name_goes_aside_of_what_is_busy() -> None:
    busy = np.zeros((60, 80), bool)
    busy[24:36, 25:55] = True
    label = space(room(), busy).name(1, [WORD])

    assert label is not None and label.leader is None
    assert not overlap(label.box, (100 + 25 * CELL, 50 + 24 * CELL, 100 + 55 * CELL, 50 + 36 * CELL))


def test_the_first_words_that_fit_are_written() -> None:
    regions = np.zeros((60, 80))
    regions[20:30, 20:40] = 1
    label = space(regions).name(1, [LARGE, WORD])

    assert label is not None and label.lines == WORD


def test_two_names_in_one_room_stand_apart_and_reserved_room_stays_free() -> None:
    words = space(room())
    words.reserve((100.0, 50.0, 100.0 + 40 * CELL, 50.0 + 60 * CELL))
    first, second = words.name(1, [WORD]), words.name(1, [WORD])

    assert first is not None and second is not None
    assert first.box[0] >= 100 + 40 * CELL and second.box[0] >= 100 + 40 * CELL
    assert not overlap(first.box, second.box)


def test_a_name_that_fits_nowhere_stands_beside_its_region_with_a_leader_into_it() -> None:
    regions = np.zeros((60, 80))
    regions[29:32, 39:42] = 1
    label = space(regions).name(1, [LARGE, WORD])

    assert label is not None and label.lines == WORD
    assert label.leader == (100 + 40.5 * CELL, 50 + 30.5 * CELL)
    assert abs(middle(label)[1] - label.leader[1]) < 30


def test_a_region_without_cells_has_no_name() -> None:
    assert space(np.zeros((10, 10))).name(1, [WORD]) is None
    assert space(np.full((10, 10), 2)).name(1, [WORD]) is None
    assert space(np.ones((10, 10))).name(5, [WORD]) is None


def test_nothing_is_written_where_all_is_taken() -> None:
    words = space(np.ones((10, 10)))
    words.reserve((0.0, 0.0, 1000.0, 1000.0))

    assert words.name(1, [WORD]) is None
    assert words.beside(WORD, [(120.0, 70.0)]) is None


def test_words_beside_a_thing_take_the_first_place_without_walls_or_words() -> None:
    walls = np.zeros((60, 80), bool)
    walls[:, 20:22] = True
    words = space(np.zeros((60, 80)), walls=walls)
    on_wall, free = (100 + 21 * CELL, 150.0), (100 + 50 * CELL, 150.0)

    first = words.beside(WORD, [(0.0, 0.0), on_wall, free])
    second = words.beside(WORD, [free])

    assert middle(first) == pytest.approx(free)
    assert second is None


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 12))
def test_no_words_overlap_and_none_leave_the_picture_whatever_the_regions(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    regions = np.zeros((50, 70))
    for number in range(1, count + 1):
        row, column = rng.integers(0, 40), rng.integers(0, 60)
        regions[row : row + rng.integers(1, 30), column : column + rng.integers(1, 40)] = number
    words = space(regions, rng.random((50, 70)) < 0.2, rng.random((50, 70)) < 0.02)
    placed = [words.name(number, [LARGE, WORD]) for number in range(1, count + 1)]
    placed += [words.beside(WORD, [tuple(rng.uniform((90, 40), (400, 260)))]) for _ in range(10)]  # type: ignore[list-item]
    boxes = [label.box for label in placed if label]

    for i, box in enumerate(boxes):
        assert box[0] >= 100 and box[1] >= 50 and box[2] <= 100 + 70 * CELL and box[3] <= 50 + 50 * CELL
        assert not any(overlap(box, other) for other in boxes[i + 1 :])
