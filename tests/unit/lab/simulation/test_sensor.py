"""The noise of a real camera: nothing when switched off, the measured law when on, the same by seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lab.simulation.camera import pose_looking
from lab.simulation.sensor import NO_NOISE, Sensor, SensorParams
from ovip.scene.camera import check_pose
from ovip.scene.types import F32, Intrinsics

K = Intrinsics(fx=115.0, fy=115.0, cx=79.5, cy=59.5, width=160, height=120)
POSE = pose_looking((1.0, 2.0, 1.3), 0.4, -0.3)


def grey() -> np.ndarray:
    return np.full((120, 160, 3), 120, dtype=np.uint8)


def wall(z: float) -> F32:
    """A wall straight ahead."""
    return np.full((120, 160), z, dtype=np.float32)


def test_all_at_zero_is_the_identity() -> None:
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 255, (120, 160, 3)).astype(np.uint8)
    depth = rng.uniform(0, 9, (120, 160)).astype(np.float32)
    before = pose_looking((1.2, 2.0, 1.3), 0.6, -0.3)
    seen, measured, tracked = Sensor(K, NO_NOISE, 3).observe(rgb, depth, POSE, 7, before)
    np.testing.assert_array_equal(seen, rgb)
    np.testing.assert_array_equal(measured, depth)
    np.testing.assert_array_equal(tracked, POSE)


def test_a_seed_and_an_index_give_the_same_noise_in_any_order() -> None:
    first, again, other = Sensor(K, seed=1), Sensor(K, seed=1), Sensor(K, seed=2)
    late = first.observe(grey(), wall(2), POSE, 500)
    early = first.observe(grey(), wall(2), POSE, 4)
    for a, b in zip(early, again.observe(grey(), wall(2), POSE, 4), strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(late, again.observe(grey(), wall(2), POSE, 500), strict=True):
        np.testing.assert_array_equal(a, b)
    assert (other.observe(grey(), wall(2), POSE, 4)[1] != early[1]).any()
    assert (again.observe(grey(), wall(2), POSE, 5)[1] != early[1]).any()


@pytest.mark.parametrize(("z", "sigma"), [(0.4, 0.0012), (1.4, 0.0031), (3.4, 0.0183)])
def test_depth_noise_grows_with_the_square_of_the_distance(z: float, sigma: float) -> None:
    params = replace(NO_NOISE, axial=(0.0012, 0.0019))  # 0.0012 + 0.0019 * 1 = 0.0031; + 0.0019 * 9 = 0.0183
    _, measured, _ = Sensor(K, params).observe(grey(), wall(z), POSE, 0)
    assert measured.std() == pytest.approx(sigma, rel=0.03)
    assert measured.mean() == pytest.approx(z, abs=4 * sigma / 138)


def test_depth_is_rounded_to_its_step() -> None:
    _, measured, _ = Sensor(K, replace(NO_NOISE, step=0.01)).observe(grey(), wall(1.2345), POSE, 0)
    np.testing.assert_allclose(measured, 1.23, atol=1e-6)


def test_nothing_returns_from_beyond_the_range() -> None:
    depth = wall(1.0)
    depth[:, :50], depth[:, 50:100] = 0.2, 6.0
    _, measured, _ = Sensor(K, replace(NO_NOISE, nearest=0.3, farthest=5.0)).observe(grey(), depth, POSE, 0)
    assert (measured[:, :100] == 0).all()
    assert (measured[:, 100:] == 1.0).all()


def test_nothing_returns_from_a_floor_seen_at_a_grazing_angle() -> None:
    v = np.arange(120)[:, None] + np.zeros(160)
    below = np.maximum((v - K.cy) / K.fy, 1e-9)
    depth = np.where(v > 60, np.minimum(1.3 / below, 30), 30).astype(
        np.float32
    )  # a floor 1.3 m below, level view
    _, measured, _ = Sensor(K, replace(NO_NOISE, grazing=80.0)).observe(grey(), depth, POSE, 0)
    near, far = slice(100, 118), slice(67, 77)  # 70 to 63 degrees from the normal; 86 to 81
    assert (measured[near] > 0).all()
    assert (measured[far, 40:120] == 0).all()


def test_depth_edges_and_dark_surfaces_lose_their_share() -> None:
    depth = wall(1.0)
    depth[:, 80:] = 2.0
    _, measured, _ = Sensor(K, replace(NO_NOISE, edge_loss=0.5)).observe(grey(), depth, POSE, 0)
    assert (measured[:, 79:81] == 0).mean() == pytest.approx(0.5, abs=0.12)
    assert (measured[:, :78] > 0).all()
    dark = grey()
    dark[:60] = 5
    _, measured, _ = Sensor(K, replace(NO_NOISE, dark_loss=0.4)).observe(dark, wall(1.0), POSE, 0)
    assert (measured[:60] == 0).mean() == pytest.approx(0.4, abs=0.02)
    assert (measured[60:] > 0).all()


def test_a_pose_drifts_slowly_and_no_further_than_said() -> None:
    sensor = Sensor(K, replace(NO_NOISE, drift_position=0.01, drift_turn=0.004, drift_frames=60.0), seed=5)
    tracked = np.array([check_pose(sensor.observe(grey(), wall(2), POSE, i)[2]) for i in range(0, 1500, 1)])
    error = tracked[:, :3, 3] - POSE[:3, 3]
    assert np.abs(error[0]).max() < 0.01
    assert 0.005 < error.std() < 0.015
    assert np.abs(np.diff(error, axis=0)).std() < 0.003  # sqrt(1 - exp(-2 / 60)) = 0.18 of 1 cm a frame
    turned = np.array([np.trace(t[:3, :3].T @ POSE[:3, :3]) for t in tracked])
    angle = np.arccos(np.clip((turned - 1) / 2, -1, 1))
    assert 0.003 < angle.mean() < 0.012  # three axes of 0.004


def test_turning_blurs_along_the_turn_and_standing_still_does_not() -> None:
    rgb = grey()
    rgb[:, 80:] = 200
    rgb[60:] //= 2
    sensor = Sensor(K, replace(NO_NOISE, blur=0.1))
    turned = pose_looking((1.0, 2.0, 1.3), 0.9, -0.3)
    blurred, _, _ = sensor.observe(rgb, wall(2), POSE, 0, turned)  # 0.5 rad x 115 px x 0.1: about 6 px
    still, _, _ = sensor.observe(rgb, wall(2), POSE, 0, POSE)
    np.testing.assert_array_equal(still, rgb)
    across = len(np.unique(blurred[20, 60:100, 0]))
    assert across > 4
    assert len(np.unique(blurred[50:70, 20, 0])) <= 3


def test_the_default_loses_some_of_a_room_and_stays_near_the_truth() -> None:
    v = np.mgrid[:120, :160][0]
    below = np.maximum((v - 40) / K.fy, 1e-9)
    depth = np.minimum(1.3 / below, 3.5).astype(np.float32)
    _, measured, _ = Sensor(K, SensorParams(), 1).observe(grey(), depth, POSE, 0)
    assert 0.8 < (measured > 0).mean() <= 1.0
    there = measured > 0
    assert np.abs(measured - depth)[there].mean() < 0.03
