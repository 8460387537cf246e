"""Clearance and watersheds on grids that can be checked by eye."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy import ndimage
from skimage.segmentation import watershed

from ovip.scene.types import Bools
from services.regions.domain.flooding import clearance_of, components, flood, renumber, share_by_distance

MASKS = arrays.arrays(np.bool_, st.tuples(st.integers(1, 24), st.integers(1, 24)))


def test_clearance_is_the_distance_to_the_nearest_cell_that_is_not_free_the_edge_included() -> None:
    assert clearance_of(np.ones((1, 3), bool), 0.5).tolist() == [[0.5, 0.5, 0.5]]
    walled = np.ones((9, 9), bool)
    walled[4, 0] = False
    assert clearance_of(walled, 0.05)[4, 3] == pytest.approx(0.15)
    assert clearance_of(walled, 0.05)[7, 4] == pytest.approx(0.10)
    assert clearance_of(np.zeros((0, 0), bool), 0.05).shape == (0, 0)


@settings(max_examples=60, deadline=None)
@given(MASKS)
def test_clearance_is_scipys_exact_distance(free: Bools) -> None:
    exact = ndimage.distance_transform_edt(np.pad(free, 1), sampling=0.05)[1:-1, 1:-1]
    assert clearance_of(free, 0.05) == pytest.approx(exact, abs=1e-5)


def test_two_fronts_meet_where_the_relief_is_highest() -> None:
    relief = np.array([[0.0, 1.0, 3.0, 2.0, 0.0]])
    markers = np.array([[1, 0, 0, 0, 2]], np.int32)
    assert flood(relief, markers, np.ones((1, 5), bool)).tolist() == [
        [1, 1, 1, 2, 2]
    ]  # the tie: first in line


def test_a_piece_without_a_marker_stays_empty_and_markers_off_the_mask_too() -> None:
    mask = np.array([[True, False, True]])
    assert flood(np.zeros((1, 3)), np.array([[1, 2, 0]], np.int32), mask).tolist() == [[1, 0, 0]]


@settings(max_examples=60, deadline=None)
@given(MASKS, st.integers(0, 2**32 - 1))
def test_sparing_what_markers_enclose_changes_no_cell(mask: Bools, seed: int) -> None:
    rng = np.random.default_rng(seed)
    relief = rng.permutation(mask.size).reshape(mask.shape).astype(np.float64)  # no ties
    markers = np.where(
        mask, np.kron(rng.integers(0, 3, (5, 5)), np.ones((5, 5), int))[: mask.shape[0], : mask.shape[1]], 0
    )
    expected = watershed(relief, markers, mask=mask)
    assert flood(relief, markers.astype(np.int32), mask).tolist() == expected.tolist()


def test_a_cell_goes_to_the_marker_nearest_on_foot_not_through_the_wall() -> None:
    mask = np.ones((5, 9), bool)
    mask[:4, 4] = False  # a wall, open at the bottom
    markers = np.zeros((5, 9), np.int32)
    markers[0, 3], markers[4, 8] = 1, 2
    shared = share_by_distance(markers, mask)
    assert shared[0, 5] == 2  # two cells from marker 1 through the wall, eight around it
    assert shared[4, 4] == 2  # 4.00 against 4.41 cells on foot
    assert shared[4, 3] == 1
    assert not share_by_distance(np.zeros((5, 9), np.int32), mask).any()


def test_components_are_joined_by_edges_and_numbered_in_reading_order() -> None:
    mask = np.array([[1, 0, 1, 1], [0, 1, 0, 0], [0, 1, 0, 1]], bool)
    assert components(mask, 1).tolist() == [[1, 0, 2, 2], [0, 3, 0, 0], [0, 3, 0, 4]]
    assert components(mask, 2).tolist() == [[0, 0, 1, 1], [0, 2, 0, 0], [0, 2, 0, 0]]
    assert renumber(np.array([0, 1, 2, 3], np.int32), [3, 1]).tolist() == [0, 2, 0, 1]
