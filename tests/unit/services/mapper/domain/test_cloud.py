"""Voxel sums: merging adds, in any order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.types import F32, U8
from ovip.scene.voxels import voxel_keys
from services.mapper.domain.cloud import MOST_VOXELS, VoxelCloud, clouds_of

SIZE = 0.5
STEP = SIZE / 256
POINTS = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 25), st.just(3)), elements=st.floats(-3, 3, width=32)
)


def _colors(points: F32) -> U8:
    return (np.abs(points * 50) % 256).astype(np.uint8)


def _cloud(points: F32) -> VoxelCloud:
    return VoxelCloud.of(points, _colors(points), SIZE)


def _same(a: VoxelCloud, b: VoxelCloud) -> bool:
    return a.level == b.level and np.array_equal(a.keys, b.keys) and np.array_equal(a.tally, b.tally)


def test_voxel_sums_by_hand() -> None:
    points = np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [0.6, 0.1, 0.1]], np.float32)
    colors = np.array([[10, 0, 0], [20, 0, 0], [90, 80, 70]], np.uint8)

    cloud = VoxelCloud.of(points, colors, SIZE)

    assert cloud.counts.tolist() == [2, 1]
    assert cloud.points == pytest.approx(np.array([[0.2, 0.1, 0.1], [0.6, 0.1, 0.1]]), abs=STEP)
    assert cloud.colors.tolist() == [[15, 0, 0], [90, 80, 70]]
    assert cloud.box == pytest.approx([0.2, 0.1, 0.1, 0.6, 0.1, 0.1], abs=STEP)


def test_the_mean_counts_every_voxel_once_however_often_it_was_seen() -> None:
    near, far = np.full((99, 3), 0.1, np.float32), np.full((1, 3), 0.9, np.float32)
    points = np.concatenate([near, far])

    cloud = VoxelCloud.of(points, np.zeros((100, 3), np.uint8), SIZE)

    assert cloud.mean[:3] == pytest.approx([0.5, 0.5, 0.5], abs=STEP)


@given(POINTS)
def test_a_voxels_mean_is_that_of_its_points_to_a_step(points: F32) -> None:
    cloud = _cloud(points)
    keys = voxel_keys(points, SIZE)

    for key, mean in zip(cloud.keys, cloud.means, strict=True):
        assert mean == pytest.approx(points[keys == key].mean(axis=0), abs=STEP)


@given(POINTS, POINTS)
def test_merging_is_commutative_to_the_bit(a: F32, b: F32) -> None:
    assert _same(_cloud(a).merged(_cloud(b)), _cloud(b).merged(_cloud(a)))


@given(POINTS, POINTS, POINTS)
def test_merging_is_associative_to_the_bit(a: F32, b: F32, c: F32) -> None:
    left = _cloud(a).merged(_cloud(b)).merged(_cloud(c))
    right = _cloud(a).merged(_cloud(b).merged(_cloud(c)))

    assert _same(left, right)


@given(POINTS, POINTS)
def test_merging_two_clouds_is_the_cloud_of_all_points(a: F32, b: F32) -> None:
    assert _same(_cloud(a).merged(_cloud(b)), _cloud(np.concatenate([a, b])))


@given(POINTS, POINTS)
def test_merging_loses_no_point_and_changes_neither_cloud(a: F32, b: F32) -> None:
    one, other = _cloud(a), _cloud(b)
    before = (one.tally.tobytes(), other.tally.tobytes())

    merged = one.merged(other)

    assert merged.counts.sum() == len(a) + len(b)
    assert merged.tally.sum(axis=0).tolist() == (one.tally.sum(axis=0) + other.tally.sum(axis=0)).tolist()
    assert (one.tally.tobytes(), other.tally.tobytes()) == before


@given(POINTS)
def test_the_box_of_a_cloud_lies_in_the_box_of_its_points(points: F32) -> None:
    box = _cloud(points).box

    assert (box[:3] >= points.min(axis=0) - STEP).all()
    assert (box[3:] <= points.max(axis=0) + STEP).all()


def test_keeping_some_voxels_keeps_their_sums() -> None:
    cloud = _cloud(np.array([[0.1, 0.1, 0.1], [2.0, 0.1, 0.1]], np.float32))

    kept = cloud.kept(np.array([False, True]))

    assert len(kept) == 1
    assert kept.points[0] == pytest.approx([2.0, 0.1, 0.1], abs=STEP)


def test_clouds_made_together_are_those_made_apart() -> None:
    rng = np.random.default_rng(3)
    parts = [rng.uniform(-1, 1, (n, 3)).astype(np.float32) for n in (1, 40, 7)]

    together = clouds_of(parts, [_colors(part) for part in parts], SIZE)

    assert all(_same(one, _cloud(part)) for one, part in zip(together, parts, strict=True))


# Coarser voxels


@given(POINTS)
def test_coarser_voxels_have_the_same_sums_as_points_binned_coarsely(points: F32) -> None:
    """Two voxels in one: the means stay those of the points, to a step."""
    coarse = _cloud(points).coarser()
    keys = voxel_keys(points, 2 * SIZE)

    assert coarse.keys.tolist() == sorted(set(keys.tolist()))
    assert coarse.counts.sum() == len(points)
    for key, mean in zip(coarse.keys, coarse.means, strict=True):
        assert mean == pytest.approx(points[keys == key].mean(axis=0), abs=STEP)


@given(POINTS, POINTS)
def test_coarsening_before_merging_and_after_are_the_same(a: F32, b: F32) -> None:
    before = _cloud(a).coarser().merged(_cloud(b))

    assert _same(before, _cloud(a).merged(_cloud(b)).coarser())


def test_a_floor_of_any_size_has_a_bounded_number_of_voxels() -> None:
    """20 x 20 m at 2 cm would be a million; what is merged in later is coarsened with it."""
    side = np.arange(0.01, 4.0, 0.02)
    tile = np.stack([*np.meshgrid(side, side), np.zeros((200, 200))], axis=-1).reshape(-1, 3)
    floor = None
    for x in range(5):
        for y in range(5):
            points = (tile + np.array([4 * x, 4 * y, 0.01])).astype(np.float32)
            part = VoxelCloud.of(points, np.zeros((len(points), 3), np.uint8), 0.02)
            floor = floor.merged(part) if floor else part

    assert floor is not None
    assert len(floor) <= MOST_VOXELS
    assert floor.counts.sum() == 25 * 40_000
    assert floor.box == pytest.approx([0, 0, 0.01, 20, 20, 0.01], abs=floor.edge)


def test_a_voxel_seen_without_end_keeps_its_mean_and_never_overflows() -> None:
    cloud = _cloud(np.full((1, 3), 0.3, np.float32))
    for _ in range(40):  # doubling: 2**40 points
        cloud = cloud.merged(cloud)

    assert cloud.points[0] == pytest.approx([0.3, 0.3, 0.3], abs=STEP)
    assert cloud.colors.tolist() == [[15, 15, 15]]
