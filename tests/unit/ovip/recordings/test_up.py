"""Finding which way is up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from ovip.recordings import parse_up
from ovip.recordings.up import find_up, rotation_to_z_up, unit_up
from ovip.scene.types import F32, F64, Intrinsics

K = Intrinsics(140, 140, 79.5, 59.5, 160, 120)
# normal and offset of n.x = d: the floor, a table's height is left to the kitchen, four walls, the ceiling
ROOM = [((0, 0, 1), 0), ((1, 0, 0), 0), ((1, 0, 0), 5), ((0, 1, 0), 0), ((0, 1, 0), 4), ((0, 0, 1), 2.6)]

angles = st.floats(-np.pi, np.pi)


def _looking(x: float, y: float, z: float, yaw: float, pitch: float) -> F64:
    forward = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)])
    right = np.array([np.sin(yaw), -np.cos(yaw), 0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = x, y, z
    return pose


def _depth(pose: F64, planes: list[tuple[tuple[float, ...], float]], noise: float = 0.0) -> F32:
    """The nearest of the planes along each ray, z-depth in metres, seen from either side."""
    v, u = np.mgrid[: K.height, : K.width]
    rays = np.stack([(u - K.cx) / K.fx, (v - K.cy) / K.fy, np.ones(u.shape)], axis=2) @ pose[:3, :3].T
    depth = np.full(u.shape, np.inf)
    for normal, offset in planes:
        with np.errstate(divide="ignore"):
            z = (offset - pose[:3, 3] @ normal) / (rays @ np.array(normal, float))
        depth = np.where((z > 0) & (z < depth), z, depth)
    grain = np.random.default_rng(0).normal(0, 1, depth.shape) * noise * depth**2
    return np.where(np.isfinite(depth), depth + grain, 0).astype(np.float32)


def _views(pitch: float, noise: float = 0.0) -> list[tuple[F32, F64]]:
    poses = [_looking(2 + 0.3 * i, 1.5 + 0.1 * i, 1.3, 0.7 * i, pitch) for i in range(5)]
    return [(_depth(pose, ROOM, noise), pose) for pose in poses]


def _degrees(a: F64, b: F64) -> float:
    return float(np.degrees(np.arccos(np.clip(a @ b, -1, 1))))


@settings(deadline=None, max_examples=15)
@given(angles, angles, angles, st.sampled_from([-0.6, -0.3, 0.0]))
def test_up_is_found_in_any_world_frame(a: float, b: float, c: float, pitch: float) -> None:
    turn = np.eye(4)
    turn[:3, :3] = _looking(0, 0, 0, a, b / 2)[:3, :3] @ _looking(0, 0, 0, c, 0)[:3, :3].T
    up = find_up([(depth, turn @ pose) for depth, pose in _views(pitch)], K)
    assert _degrees(up, turn[:3, 2]) < 1


def test_up_is_found_under_a_depth_cameras_noise() -> None:
    assert _degrees(find_up(_views(-0.4, noise=0.004), K), np.array([0.0, 0, 1])) < 1.5


def test_the_same_views_give_the_same_up() -> None:
    np.testing.assert_array_equal(find_up(_views(-0.4, 0.004), K), find_up(_views(-0.4, 0.004), K))


def test_no_plane_below_the_cameras_asks_for_up() -> None:
    wall = [((0.0, 1.0, 0.0), 3.0)]
    pose = _looking(0, 0, 1.3, np.pi / 2, 0)
    with pytest.raises(InvalidInput, match=r"found none; pass --up x,y,z"):
        find_up([(_depth(pose, wall), pose)], K)


def test_two_slopes_that_are_alike_ask_for_up() -> None:
    roof = [((0.6, 0.0, 0.8), 0.0), ((-0.6, 0.0, 0.8), 0.0)]  # a valley along y, symmetric about the camera
    pose = _looking(0, 0, 1.3, np.pi / 2, -0.5)
    with pytest.raises(InvalidInput, match=r"two directions are as likely.*pass --up x,y,z"):
        find_up([(_depth(pose, roof), pose)], K)


def test_cameras_turned_every_way_ask_for_up() -> None:
    upright = _looking(0, 0, 1, 0, 0)
    over = upright @ np.diag([-1.0, -1, 1, 1])
    with pytest.raises(InvalidInput, match="turned every way"):
        find_up([(_depth(pose, ROOM), pose) for pose in (upright, over)], K)


def test_no_views_ask_for_up() -> None:
    with pytest.raises(InvalidInput, match="got none; pass --up"):
        find_up([], K)


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_the_rotation_takes_up_to_z_and_is_a_rotation(up: tuple[float, float, float]) -> None:
    unit = unit_up(up)
    turn = rotation_to_z_up(unit)
    np.testing.assert_allclose(turn[:3, :3] @ unit, [0, 0, 1], atol=1e-6)
    np.testing.assert_allclose(turn[:3, :3] @ turn[:3, :3].T, np.eye(3), atol=1e-6)
    assert np.linalg.det(turn[:3, :3]) > 0
    np.testing.assert_array_equal(turn[:3, 3], 0)


@pytest.mark.parametrize("aside", [1e-13, 1e-9, 1e-6, 1e-3])
def test_an_up_that_is_nearly_straight_down_still_turns_to_z(aside: float) -> None:
    unit = unit_up((0.0, aside, -0.5))
    turn = rotation_to_z_up(unit)[:3, :3]
    np.testing.assert_allclose(turn @ unit, [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-9)


def test_z_up_is_left_alone_and_straight_down_turns_about_x() -> None:
    np.testing.assert_array_equal(rotation_to_z_up(np.array([0.0, 0, 1])), np.eye(4))
    np.testing.assert_array_equal(rotation_to_z_up(np.array([0.0, 0, -1])), np.diag([1.0, -1, -1, 1]))


def test_up_as_typed() -> None:
    assert parse_up("auto") == "auto"
    assert parse_up("0,-2,0") == (0, -1, 0)
    for text in ("up", "1,2", "0,0,0", "nan,0,1"):
        with pytest.raises(InvalidInput, match="up: expected"):
            parse_up(text)
