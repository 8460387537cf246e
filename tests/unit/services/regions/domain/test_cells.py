"""Points on the grid, and what is nearest to them."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.scene.types import F64, Bools
from services.regions.domain.cells import cells_of, labels_at, nearest_cells

MASKS = arrays.arrays(np.bool_, st.tuples(st.integers(0, 12), st.integers(0, 12)))


def cells(*pairs: tuple[float, float]) -> F64:
    return np.array(pairs, dtype=np.float64).reshape(-1, 2)


def test_a_points_row_goes_with_y_and_its_column_with_x() -> None:
    points = np.array([[1.025, 2.075, 9.0], [1.0, 2.0, 9.0]])
    assert np.round(cells_of(points, (1.0, 2.0), 0.05), 9).tolist() == [[1.0, 0.0], [-0.5, -0.5]]
    assert cells_of(points[:, :2], (1.0, 2.0), 0.05).shape == (2, 2)


def test_an_object_in_a_wall_snaps_to_the_nearest_free_cell_ties_to_the_first() -> None:
    free = np.array([[True, False, True]])
    assert nearest_cells(cells((0, 1)), free).tolist() == [[0, 0]]
    assert nearest_cells(cells((0, 1.2)), free).tolist() == [[0, 2]]
    assert nearest_cells(cells((0, 1)), np.zeros((1, 3), bool)).tolist() == [[-1, -1]]
    assert nearest_cells(cells(), free).shape == (0, 2)


def test_half_way_between_two_cells_the_first_counts() -> None:
    assert nearest_cells(cells((0.5, 0.5)), np.ones((2, 2), bool)).tolist() == [[0, 0]]
    assert nearest_cells(cells((0.5, 0.5)), np.array([[False, False], [True, True]])).tolist() == [[1, 0]]


@settings(max_examples=80, deadline=None)
@given(MASKS, st.lists(st.tuples(st.floats(-6, 18), st.floats(-6, 18)), min_size=1, max_size=5))
def test_the_nearest_cell_is_that_of_a_search_through_all(
    target: Bools, at: list[tuple[float, float]]
) -> None:
    places = np.argwhere(target)
    found = nearest_cells(cells(*at), target)
    for point, cell in zip(cells(*at), found, strict=True):
        if not len(places):
            assert cell.tolist() == [-1, -1]
            continue
        apart = np.hypot(*(places - point).T)
        assert np.hypot(*(cell - point)) <= apart.min() + 1e-6
        assert target[tuple(cell)]


def test_labels_count_from_zero_and_are_none_where_there_are_none() -> None:
    labels = np.array([[0, 2, 0, 0, 1]], np.int32)
    assert labels_at(labels, cells((0, 0), (0, 2.4), (7, 4))).tolist() == [1, 1, 0]
    assert labels_at(np.zeros((2, 2), np.int32), cells((0, 0))).tolist() == [-1]
    assert labels_at(np.zeros((0, 0), np.int32), cells()).shape == (0,)
