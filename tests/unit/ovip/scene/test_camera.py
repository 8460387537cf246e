"""Cameras: what a pose and intrinsics must be, depth to the world and back."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.errors import InvalidInput
from ovip.scene.camera import FARTHEST_WORLD, backproject, check_intrinsics, check_pose, lift_pixels, project
from ovip.scene.types import F32, F64, Intrinsics
from ovip.scene.voxels import voxel_cells, voxel_keys
from tests.builders import camera, pose

ANGLES = st.floats(-math.pi, math.pi)
METRES = st.floats(-100, 100)
POSES = st.builds(pose, METRES, METRES, METRES, ANGLES, st.floats(-1.5, 1.5))


def _changed(row: int, column: int, value: float) -> F64:
    made = pose(1, 2, 3, 0.4, 0.2)
    made[row, column] = value
    return made


# Poses


@given(POSES)
def test_a_rigid_pose_is_taken_as_it_is(rigid: F64) -> None:
    assert np.array_equal(check_pose(rigid), rigid)


def test_a_pose_of_float32_is_near_enough_to_rigid() -> None:
    assert check_pose(pose(1, 2, 3, 0.7, 0.3).astype(np.float32).astype(np.float64)).dtype == np.float64


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (np.eye(3), r"expected 16 numbers .* got shape \(3, 3\)"),
        (_changed(0, 3, math.nan), "expected finite numbers, got NaN or infinity"),
        (_changed(1, 1, math.inf), "expected finite numbers"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "right-handed.* with determinant -1"),
        (np.diag([2.0, 2.0, 2.0, 1.0]), "expected a rigid world_from_camera"),
        (_changed(0, 0, 0.5), "expected a rigid world_from_camera"),
        (np.zeros((4, 4)), "expected a rigid world_from_camera"),
        (_changed(3, 0, 0.1), "expected last row 0 0 0 1"),
        (_changed(3, 3, 2.0), "expected last row 0 0 0 1"),
        (pose(x=1e7), "expected a position in metres within"),
        (pose(yaw=0.3).T + _changed(0, 3, 5.0), "pose: expected"),
    ],
)
def test_a_pose_that_is_none_is_refused_in_words(bad: F64, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        check_pose(bad)


@given(hnp.arrays(np.float64, (4, 4), elements=st.floats(allow_nan=True, allow_infinity=True)))
def test_any_sixteen_numbers_are_a_rigid_pose_or_refused(numbers: F64) -> None:
    try:
        taken = check_pose(numbers)
    except InvalidInput:
        return
    assert np.allclose(taken[:3, :3] @ taken[:3, :3].T, np.eye(3), atol=1e-2)


def test_huge_numbers_that_cancel_are_refused() -> None:
    bad = np.eye(4)
    bad[0, :3], bad[1, :3] = [1e200, 1e200, 0], [1e200, -1e200, 0]

    with pytest.raises(InvalidInput, match="rigid"):
        check_pose(bad)


def test_the_farthest_pose_still_has_voxels_of_its_own() -> None:
    """Voxel keys reach 20 km at 2 cm; a pose that is let in, and what it sees, must stay inside."""
    corners = np.array([[FARTHEST_WORLD + 100.0] * 3, [-FARTHEST_WORLD - 100.0] * 3])

    cells = voxel_cells(voxel_keys(corners, 0.02))

    assert np.array_equal(cells, np.floor(corners / 0.02).astype(np.int64))


# Intrinsics


def test_plausible_intrinsics_are_taken() -> None:
    kinect = Intrinsics(585.0, 585.0, 320.0, 240.0, 640, 480)

    assert check_intrinsics(kinect) is kinect


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fx": math.nan}, "expected finite fx, fy, cx, cy"),
        ({"cy": math.inf}, "expected finite fx, fy, cx, cy"),
        ({"width": 0}, "expected width and height of 16 to 8192 pixels, got 0x48"),
        ({"height": 10_000}, "expected width and height of 16 to 8192"),
        ({"fx": 0.0}, "expected focal lengths in pixels"),
        ({"fy": -60.0}, "expected focal lengths in pixels"),
        ({"fx": 1e6}, "expected focal lengths in pixels"),
        ({"cx": -500.0}, "expected the principal point near the image"),
        ({"cy": 500.0}, "expected the principal point near the image"),
    ],
)
def test_intrinsics_that_are_none_are_refused_in_words(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        check_intrinsics(replace(camera(), **change))


# Depth to the world and back


def test_backprojection_by_hand() -> None:
    """f = 60, c = (31.5, 23.5): pixel (61, 23) at 2 m -> x = 29.5/60*2, y = -0.5/60*2, z = 2 in the camera."""
    depth = np.zeros((48, 64), np.float32)
    depth[23, 61] = 2.0

    points, index = backproject(depth, camera(), np.eye(4))

    assert index.tolist() == [23 * 64 + 61]
    assert points[0] == pytest.approx([29.5 / 30, -0.5 / 30, 2.0])


def test_a_camera_that_looks_along_x_sees_its_depth_along_x() -> None:
    depth = np.zeros((48, 64), np.float32)
    depth[23, 31] = 3.0

    points, _ = backproject(depth, camera(), pose(x=1.0, z=1.5))

    assert points[0] == pytest.approx([4.0, 0.0, 1.5], abs=0.03)


def test_right_in_the_image_is_right_of_the_robot_and_down_is_down() -> None:
    k = camera()
    right_low = 47 * 64 + 63

    point = lift_pixels(np.array([right_low]), np.array([2.0]), k, pose(z=1.0))[0]

    assert point[1] < 0
    assert point[2] < 1.0


def test_no_depth_makes_no_points() -> None:
    points, index = backproject(np.zeros((48, 64), np.float32), camera(), np.eye(4))

    assert points.shape == (0, 3)
    assert index.shape == (0,)


def test_only_masked_pixels_are_lifted() -> None:
    depth = np.ones((48, 64), np.float32)
    mask = np.zeros((48, 64), bool)
    mask[3, 5] = mask[10, 2] = True
    depth[10, 2] = 0.0

    _, index = backproject(depth, camera(), np.eye(4), mask)

    assert index.tolist() == [3 * 64 + 5]


@given(
    POSES, hnp.arrays(np.float32, (48, 64), elements=st.one_of(st.just(0.0), st.floats(0.25, 10, width=32)))
)
def test_projecting_what_was_lifted_gives_the_pixels_and_depths_back(where: F64, depth: F32) -> None:
    k = camera()
    points, index = backproject(depth, k, where)

    uv, z = project(points, k, where)

    assert uv[:, 0] == pytest.approx(index % k.width, abs=0.05)
    assert uv[:, 1] == pytest.approx(index // k.width, abs=0.05)
    assert z == pytest.approx(depth.ravel()[index], abs=1e-3)


def test_what_lies_behind_the_camera_has_a_negative_depth() -> None:
    _, z = project(np.array([[0.0, 0.0, -2.0]]), camera(), np.eye(4))

    assert z.tolist() == [-2.0]
