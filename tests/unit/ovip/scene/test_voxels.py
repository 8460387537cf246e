"""Voxels: keys, cells, means."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.types import F32, I64
from ovip.scene.voxels import downsample, group_sums, voxel_cells, voxel_keys

CELLS = hnp.arrays(
    np.int64, st.tuples(st.integers(0, 20), st.just(3)), elements=st.integers(-(2**20), 2**20 - 1)
)
CLOUDS = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 40), st.just(3)), elements=st.floats(-50, 50, width=32)
)


@given(CELLS)
def test_cells_come_back_from_keys(cells: I64) -> None:
    centres = (cells + 0.5) * 0.5

    assert np.array_equal(voxel_cells(voxel_keys(centres, 0.5)), cells)


def test_cells_below_zero_are_floored_not_truncated() -> None:
    points = np.array([[-0.01, -0.5, -0.51], [0.0, 0.49, 0.5]])

    assert voxel_cells(voxel_keys(points, 0.5)).tolist() == [[-1, -1, -2], [0, 0, 1]]


@given(CELLS)
def test_keys_are_sorted_like_cells(cells: I64) -> None:
    keys = voxel_keys((cells + 0.5) * 0.5, 0.5)

    assert np.array_equal(np.argsort(keys, kind="stable"), np.lexsort(cells.T[::-1]))


def test_downsampling_means_by_hand() -> None:
    """Two points share voxel (0, 0, 0), one lies in (1, 0, 0), one in (-1, 0, 0), which comes first."""
    points = np.array([[0.2, 0.2, 0.2], [0.6, 0.4, 0.8], [1.5, 0.5, 0.5], [-0.5, 0.5, 0.5]], np.float32)
    colors = np.array([[10, 0, 0], [21, 0, 0], [50, 60, 70], [1, 2, 3]], np.uint8)

    means, tints = downsample(points, 1.0, colors)

    assert means == pytest.approx(np.array([[-0.5, 0.5, 0.5], [0.4, 0.3, 0.5], [1.5, 0.5, 0.5]]))
    assert tints is not None
    assert tints.tolist() == [[1, 2, 3], [16, 0, 0], [50, 60, 70]]


def test_nothing_downsamples_to_nothing() -> None:
    points, colors = downsample(np.zeros((0, 3), np.float32), 0.02, np.zeros((0, 3), np.uint8))

    assert points.shape == (0, 3)
    assert colors is not None
    assert len(colors) == 0


@given(CLOUDS, st.randoms(use_true_random=False))
def test_downsampling_keeps_one_point_a_voxel_inside_it_whatever_the_order(
    points: F32, shuffler: object
) -> None:
    size = 0.5
    thin, _ = downsample(points, size)
    shuffled, _ = downsample(points[np.random.default_rng(1).permutation(len(points))], size)
    keys = np.unique(voxel_keys(points, size))

    assert len(thin) == len(keys)
    assert shuffled == pytest.approx(thin, abs=1e-5)
    centres = (voxel_cells(keys) + 0.5) * size
    assert np.abs(thin - centres).max() <= size / 2 + 1e-5


def test_group_sums_by_hand_with_an_empty_group() -> None:
    sums = group_sums(np.array([[1.0, 10.0], [2.0, 20.0], [4.0, 40.0]]), np.array([2, 0, 2]), 3)

    assert sums.tolist() == [[2.0, 20.0], [0.0, 0.0], [5.0, 50.0]]
