"""From masks to points: known planes and spheres, what is dropped, what is kept."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.types import Bools, Frame
from ovip.scene.voxels import voxel_keys
from services.perception.domain.lifting import LiftParams, lift, lift_all, surface_cloud
from tests.builders import camera, colour_noise, frame, pose

K = camera(160, 120, 150.0)
PARAMS = LiftParams()


def _mask(rows: slice, columns: slice) -> Bools:
    mask = np.zeros((K.height, K.width), bool)
    mask[rows, columns] = True
    return mask


def _sphere(centre_z: float, radius: float) -> tuple[Frame, Bools]:
    """A frame that sees a sphere on its axis before nothing, and the sphere's mask."""
    v, u = np.mgrid[: K.height, : K.width]
    ray = np.stack([(u - K.cx) / K.fx, (v - K.cy) / K.fy, np.ones(u.shape)], axis=-1)
    a, b, c = (ray**2).sum(axis=-1), -2 * centre_z, centre_z**2 - radius**2
    root = b**2 - 4 * a * c
    hit = root > 0
    depth = np.where(hit, (-b - np.sqrt(np.maximum(root, 0))) / (2 * a), 0.0)
    return frame(depth.astype(np.float32), k=K), np.asarray(hit)


def test_a_wall_two_metres_ahead_is_lifted_to_its_plane() -> None:
    """40 x 40 pixels, two shaved off each side: 36 pixels at 2 m and f 150 are 35/150*2 = 0.467 m."""
    lifted = lift(frame(2.0, k=K), _mask(slice(40, 80), slice(60, 100)), PARAMS)

    assert lifted is not None
    assert np.ptp(lifted.points[:, 2]) == 0
    assert lifted.points[0, 2] == 2.0
    assert lifted.box[3:] - lifted.box[:3] == pytest.approx([0.467, 0.467, 0.0], abs=0.03)


def test_the_pose_takes_the_wall_into_the_world() -> None:
    lifted = lift(
        frame(2.0, k=K, world_from_camera=pose(1, 2, 1.5)), _mask(slice(40, 80), slice(60, 100)), PARAMS
    )

    assert lifted is not None
    assert lifted.points[:, 0] == pytest.approx(3.0, abs=1e-5)
    assert lifted.points[:, 1].mean() == pytest.approx(2.0, abs=0.02)
    assert lifted.points[:, 2].mean() == pytest.approx(1.5, abs=0.02)


def test_a_sphere_is_lifted_to_its_radius() -> None:
    seen, mask = _sphere(1.0, 0.15)

    lifted = lift(seen, mask, PARAMS)

    assert lifted is not None
    distance = np.linalg.norm(lifted.points - [0, 0, 1.0], axis=1)
    assert distance == pytest.approx(0.15, abs=0.01)
    assert lifted.box[0] == pytest.approx(-0.14, abs=0.02)
    assert lifted.box[2] == pytest.approx(0.85, abs=0.01)


def test_one_point_a_voxel_with_its_own_colour() -> None:
    rgb = np.zeros((K.height, K.width, 3), np.uint8)
    rgb[:, :80], rgb[:, 80:] = (200, 0, 0), (0, 0, 200)

    lifted = lift(frame(2.0, k=K, rgb=rgb), _mask(slice(40, 80), slice(60, 100)), PARAMS)

    assert lifted is not None
    keys = voxel_keys(lifted.points, PARAMS.voxel)
    assert len(np.unique(keys)) == len(keys)
    left = lifted.points[:, 0] < -0.03
    assert (lifted.colors[left] == (200, 0, 0)).all()
    assert (lifted.colors[lifted.points[:, 0] > 0.03] == (0, 0, 200)).all()


def test_only_the_largest_cluster_is_kept() -> None:
    depth = np.full((K.height, K.width), 2.0, np.float32)
    depth[60:66, 90:96] = 4.0  # seen through a gap

    lifted = lift(frame(depth, k=K), _mask(slice(40, 80), slice(60, 100)), PARAMS)

    assert lifted is not None
    assert lifted.points[:, 2].max() < 2.1


def test_what_is_too_small_too_far_or_without_depth_is_dropped() -> None:
    patch = _mask(slice(40, 80), slice(60, 100))

    assert lift(frame(2.0, k=K), _mask(slice(40, 48), slice(60, 68)), PARAMS) is None  # 64 pixels < 80
    assert lift(frame(6.5, k=K), patch, PARAMS) is None  # beyond max_depth
    assert lift(frame(0.0, k=K), patch, PARAMS) is None
    assert lift(frame(2.0, k=K), np.zeros_like(patch), PARAMS) is None


def test_what_is_large_in_pixels_but_few_voxels_is_dropped() -> None:
    """20 x 20 pixels at 0.3 m are 4 cm: a handful of voxels."""
    assert lift(frame(0.3, k=K), _mask(slice(40, 60), slice(60, 80)), PARAMS) is None


def test_a_masks_border_is_shaved_unless_it_is_all_there_is() -> None:
    depth = np.full((K.height, K.width), 2.0, np.float32)
    wide = lift(frame(depth, k=K), _mask(slice(40, 80), slice(60, 100)), LiftParams(edge=0))
    shaved = lift(frame(depth, k=K), _mask(slice(40, 80), slice(60, 100)), PARAMS)
    thin = lift(frame(depth, k=K), _mask(slice(40, 43), slice(20, 140)), PARAMS)

    assert wide is not None and shaved is not None and thin is not None
    assert (wide.box[:2] < shaved.box[:2]).all()
    assert thin.box[3] - thin.box[0] > 1.4


def test_a_mask_at_the_image_border_is_shaved_there_too() -> None:
    lifted = lift(frame(2.0, k=K), _mask(slice(0, 40), slice(0, 40)), PARAMS)

    assert lifted is not None
    assert lifted.box[0] == pytest.approx((2 - K.cx) / K.fx * 2, abs=0.02)


@given(st.integers(0, 2**32 - 1), st.floats(-math.pi, math.pi))
@settings(max_examples=25)
def test_whatever_is_lifted_lies_in_its_box_and_the_same_frame_gives_the_same_points(
    seed: int, yaw: float
) -> None:
    rng = np.random.default_rng(seed)
    depth = rng.choice([0.0, 1.0, 1.02, 2.5], (K.height, K.width)).astype(np.float32)
    seen = frame(depth, k=K, rgb=colour_noise(K, seed), world_from_camera=pose(1, 2, 3, yaw))
    mask = rng.random(depth.shape) < 0.9

    one, other = lift(seen, mask, PARAMS), lift(seen, mask, PARAMS)

    assert one is not None and other is not None
    assert one.points.tobytes() == other.points.tobytes()
    assert (one.points >= one.box[:3] - 1e-6).all()
    assert (one.points <= one.box[3:] + 1e-6).all()
    assert one.points.shape == one.colors.shape


# Many masks


def test_masks_lifted_together_are_lifted_as_each_alone_and_what_is_dropped_is_none() -> None:
    seen, sphere = _sphere(1.0, 0.15)
    depth = np.where(seen.depth > 0, seen.depth, np.float32(1.5))
    seen = frame(depth, k=K, rgb=colour_noise(K, 1), world_from_camera=pose(1, 2, 1, pitch=0.3))
    nothing, corner = np.zeros_like(sphere), _mask(slice(0, 30), slice(0, 40))

    made = lift_all(seen, [corner, nothing, sphere], PARAMS)

    assert made[1] is None
    for mask, together in ((corner, made[0]), (sphere, made[2])):
        alone = lift(seen, mask, PARAMS)
        assert together is not None and alone is not None
        assert together.points.tobytes() == alone.points.tobytes()
        assert together.colors.tobytes() == alone.colors.tobytes()
        assert together.box.tolist() == alone.box.tolist()
        assert (np.diff(voxel_keys(together.points, PARAMS.voxel)) > 0).all()


def test_no_masks_lift_to_nothing() -> None:
    assert lift_all(frame(2.0, k=K), [], PARAMS) == []


def test_equal_clusters_tie_to_the_one_of_the_first_point() -> None:
    """Two walls of 12 x 12 pixels, alike; the left one has the lower x."""
    depth = np.full((K.height, K.width), 2.0, np.float32)
    mask = _mask(slice(40, 60), slice(20, 40)) | _mask(slice(40, 60), slice(100, 120))

    lifted = lift(frame(depth, k=K), mask, PARAMS)

    assert lifted is not None
    assert lifted.points[:, 0].max() < 0


def test_what_is_near_is_thinned_and_loses_no_voxel() -> None:
    """At 0.5 m and f 150 a voxel of 5 cm is 15 pixels wide: one pixel of four is enough."""
    mask, coarse = _mask(slice(20, 100), slice(20, 140)), LiftParams(voxel=0.05, cluster_cell=0.1)

    thin = lift(frame(0.5, k=K), mask, coarse)
    full = lift(frame(0.5, k=K), mask, replace(coarse, samples=1e9))

    assert thin is not None and full is not None
    assert np.array_equal(voxel_keys(thin.points, 0.05), voxel_keys(full.points, 0.05))
    assert thin.points.tobytes() != full.points.tobytes()


# Surfaces


def test_the_surface_is_all_depth_one_point_a_coarse_voxel() -> None:
    cloud = surface_cloud(frame(2.0, k=K), PARAMS)

    keys = voxel_keys(cloud, PARAMS.surface_voxel)
    assert len(np.unique(keys)) == len(keys)
    assert np.ptp(cloud[:, 0]) == pytest.approx(159 / 150 * 2, abs=0.1)


def test_far_or_absent_depth_makes_no_surface() -> None:
    assert surface_cloud(frame(0.0, k=K), PARAMS).shape == (0, 3)
    assert surface_cloud(frame(9.0, k=K), PARAMS).shape == (0, 3)
