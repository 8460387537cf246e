"""Pixels of many masks as points in voxels, all at once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.camera import lift_pixels
from ovip.scene.types import F64, I64, Frame
from ovip.scene.voxels import downsample, voxel_cells, voxel_keys
from services.perception.domain.voxel_clouds import Clouds, voxel_clouds
from tests.builders import camera, colour_noise, frame, pose

K = camera(48, 36, 45.0)


def _seen(seed: int, at: F64 | None = None) -> tuple[Frame, I64, I64]:
    """A frame of depth noise, its pixels shuffled, and one of three owners for each."""
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.3, 0.6, (K.height, K.width)).astype(np.float32)
    pixels = rng.permutation(depth.size)
    return (
        frame(depth, k=K, rgb=colour_noise(K, seed), world_from_camera=at),
        pixels,
        rng.integers(0, 3, len(pixels)),
    )


def _of(clouds: Clouds, owner: int) -> tuple[bytes, bytes]:
    own = clouds.owners == owner
    return clouds.points[own].tobytes(), clouds.colors[own].tobytes()


@given(
    st.integers(0, 2**32 - 1),
    st.floats(-math.pi, math.pi),
    st.floats(-9000, 9000),
    st.sampled_from([0.02, 0.05]),
)
@settings(max_examples=40)
def test_each_voxel_has_one_point_which_lies_in_it_and_voxels_come_by_key(
    seed: int, yaw: float, x: float, size: float
) -> None:
    """Far from the world's origin float32 is coarse, and a mean could round out of its voxel."""
    seen, pixels, owners = _seen(seed, pose(x, -x / 2, 1.0, yaw, pitch=0.3))

    clouds = voxel_clouds(seen, pixels, owners, size)

    assert (np.diff(clouds.owners) >= 0).all()
    for owner in range(3):
        own = clouds.owners == owner
        keys = voxel_keys(clouds.points[own], size)
        assert (np.diff(keys) > 0).all()
        assert np.array_equal(voxel_cells(keys), clouds.cells[own])


def test_points_and_colours_are_the_means_of_their_pixels() -> None:
    seen, pixels, _ = _seen(1, pose(1, 2, 1.5, yaw=0.7, pitch=0.2))
    points = lift_pixels(pixels, seen.depth.ravel()[pixels], K, seen.world_from_camera)
    means, colors = downsample(points, 0.05, seen.rgb.reshape(-1, 3)[pixels])

    clouds = voxel_clouds(seen, pixels, np.zeros(len(pixels), np.int64), 0.05)

    assert colors is not None
    assert clouds.points == pytest.approx(means, abs=2e-6)
    assert np.abs(clouds.colors.astype(int) - colors).max() <= 1


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_neither_the_other_owners_nor_the_order_of_pixels_changes_a_bit(seed: int) -> None:
    seen, pixels, owners = _seen(seed)
    together = voxel_clouds(seen, pixels, owners, 0.02)

    for owner in range(3):
        own = np.sort(pixels[owners == owner])
        alone = voxel_clouds(seen, own, np.zeros(len(own), np.int64), 0.02)
        assert _of(alone, 0) == _of(together, owner)


def test_no_pixels_have_no_points() -> None:
    seen, _, _ = _seen(0)
    none = np.zeros(0, np.int64)

    clouds = voxel_clouds(seen, none, none, 0.02)

    assert clouds.points.shape == clouds.colors.shape == clouds.cells.shape == (0, 3)
    assert clouds.kept(np.zeros(0, np.bool_)).owners.shape == (0,)


def test_what_is_kept_keeps_its_order() -> None:
    seen, pixels, owners = _seen(3)
    clouds = voxel_clouds(seen, pixels, owners, 0.02)
    keep = clouds.points[:, 0] > 0

    kept = clouds.kept(keep)

    assert np.array_equal(kept.points, clouds.points[keep])
    assert np.array_equal(kept.colors, clouds.colors[keep])
    assert np.array_equal(kept.cells, clouds.cells[keep])
    assert np.array_equal(kept.owners, clouds.owners[keep])
