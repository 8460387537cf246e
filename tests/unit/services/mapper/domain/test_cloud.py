"""Voxel sums: merging adds, in any order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.types import F32, U8
from services.mapper.domain.cloud import VoxelCloud

SIZE = 0.5
POINTS = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 25), st.just(3)), elements=st.floats(-3, 3, width=32)
)


def _colors(points: F32) -> U8:
    return (np.abs(points * 50) % 256).astype(np.uint8)


def _cloud(points: F32) -> VoxelCloud:
    return VoxelCloud.of(points, _colors(points), SIZE)


def _near(a: VoxelCloud, b: VoxelCloud) -> bool:
    return (
        np.array_equal(a.keys, b.keys)
        and np.array_equal(a.counts, b.counts)
        and bool(np.allclose(a.sums, b.sums, rtol=1e-12, atol=1e-9))
    )


def test_voxel_sums_by_hand() -> None:
    points = np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [0.6, 0.1, 0.1]], np.float32)
    colors = np.array([[10, 0, 0], [20, 0, 0], [90, 80, 70]], np.uint8)

    cloud = VoxelCloud.of(points, colors, SIZE)

    assert cloud.counts.tolist() == [2, 1]
    assert cloud.points == pytest.approx(np.array([[0.2, 0.1, 0.1], [0.6, 0.1, 0.1]]), abs=1e-6)
    assert cloud.colors.tolist() == [[15, 0, 0], [90, 80, 70]]
    assert cloud.box == pytest.approx([0.2, 0.1, 0.1, 0.6, 0.1, 0.1], abs=1e-6)


def test_the_mean_counts_every_voxel_once_however_often_it_was_seen() -> None:
    near, far = np.full((99, 3), 0.1, np.float32), np.full((1, 3), 0.9, np.float32)
    points = np.concatenate([near, far])

    cloud = VoxelCloud.of(points, np.zeros((100, 3), np.uint8), SIZE)

    assert cloud.mean[:3] == pytest.approx([0.5, 0.5, 0.5], abs=1e-6)


@given(POINTS, POINTS)
def test_merging_is_commutative_up_to_rounding(a: F32, b: F32) -> None:
    assert _near(_cloud(a).merged(_cloud(b)), _cloud(b).merged(_cloud(a)))


@given(POINTS, POINTS, POINTS)
def test_merging_is_associative_up_to_rounding(a: F32, b: F32, c: F32) -> None:
    left = _cloud(a).merged(_cloud(b)).merged(_cloud(c))
    right = _cloud(a).merged(_cloud(b).merged(_cloud(c)))

    assert _near(left, right)


@given(POINTS, POINTS)
def test_merging_two_clouds_is_the_cloud_of_all_points(a: F32, b: F32) -> None:
    assert _near(_cloud(a).merged(_cloud(b)), _cloud(np.concatenate([a, b])))


@given(POINTS, POINTS)
def test_merging_loses_no_point_and_changes_neither_cloud(a: F32, b: F32) -> None:
    one, other = _cloud(a), _cloud(b)
    before = (one.sums.tobytes(), other.sums.tobytes())

    merged = one.merged(other)

    assert merged.counts.sum() == len(a) + len(b)
    assert merged.sums.sum(axis=0) == pytest.approx(one.sums.sum(axis=0) + other.sums.sum(axis=0), abs=1e-6)
    assert (one.sums.tobytes(), other.sums.tobytes()) == before


@given(POINTS)
def test_the_box_of_a_cloud_lies_in_the_box_of_its_points(points: F32) -> None:
    box = _cloud(points).box

    assert (box[:3] >= points.min(axis=0) - 1e-5).all()
    assert (box[3:] <= points.max(axis=0) + 1e-5).all()


def test_keeping_some_voxels_keeps_their_sums() -> None:
    cloud = _cloud(np.array([[0.1, 0.1, 0.1], [2.0, 0.1, 0.1]], np.float32))

    kept = cloud.kept(np.array([False, True]))

    assert len(kept) == 1
    assert kept.points[0] == pytest.approx([2.0, 0.1, 0.1])
