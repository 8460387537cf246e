"""Depth carried from one frame into another, on a wall and by hand."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.recordings.inspection.agreement import agreement, choose_pairs
from ovip.recordings.inspection.registration import busiest
from ovip.recordings.inspection.views import spread, turns
from ovip.scene.types import F32, F64, Intrinsics

K = Intrinsics(40, 40, 39.5, 29.5, 80, 60)


def wall(distance: float) -> F32:
    return np.full((60, 80), distance, np.float32)


def moved(x: float = 0, z: float = 0) -> F64:
    pose = np.eye(4)
    pose[:3, 3] = [x, 0, z]
    return pose


def test_a_wall_half_a_metre_nearer_agrees_after_half_a_metre_forward() -> None:
    assert agreement(wall(2.0), wall(1.5), moved(z=-0.5), K) == 1.0
    assert agreement(wall(2.0), wall(2.0), moved(z=-0.5), K) == 0.0


def test_three_percent_and_a_centimetre_are_forgiven() -> None:
    # 3 % of 2 m and 1 cm: 7 cm
    assert agreement(wall(2.06), wall(2.0), np.eye(4), K) == 1.0
    assert agreement(wall(2.08), wall(2.0), np.eye(4), K) == 0.0


def test_what_the_other_did_not_measure_says_nothing() -> None:
    second = wall(2.0)
    second[:, :40] = 0
    assert agreement(wall(2.0), second, np.eye(4), K) == 1.0


def test_frames_that_see_nothing_in_common_do_not_agree() -> None:
    assert agreement(wall(2.0), wall(2.0), moved(x=10), K) == 0.0
    assert agreement(wall(0.0), wall(2.0), np.eye(4), K) == 0.0
    assert agreement(wall(2.0), wall(2.0), moved(z=-3), K) == 0.0


def test_pairs_are_a_quarter_metre_apart_and_look_the_same_way() -> None:
    poses = np.array([moved(x=0.1 * index) for index in range(40)])
    pairs = choose_pairs(poses)
    assert len(pairs) == 11  # of twelve starts the last has nothing after it
    assert {second - first for first, second in pairs} == {3}


def test_a_camera_that_only_turns_is_paired_by_turning() -> None:
    poses = np.tile(np.eye(4), (40, 1, 1))
    for index, angle in enumerate(np.radians(3 * np.arange(40.0))):
        poses[index, :2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pairs = choose_pairs(poses)
    assert {second - first for first, second in pairs} == {3}
    np.testing.assert_allclose(turns(poses[3, :3, :3], poses[0, :3, :3]), 9)


def test_a_camera_that_stands_has_no_pairs() -> None:
    assert choose_pairs(np.tile(np.eye(4), (10, 1, 1))) == []


def test_the_busiest_stretches_do_not_overlap() -> None:
    steps = np.zeros(60)
    steps[10:14], steps[40:44] = 0.3, 0.1
    poses = np.array([moved(x=x) for x in np.cumsum(steps)])
    starts = busiest(poses)
    assert 5 <= starts[0] <= 10
    assert 35 <= starts[1] <= 40
    assert min(np.diff(sorted(starts))) >= 9
    assert busiest(poses[:5]) == [0]


@pytest.mark.parametrize(("count", "most", "expected"), [(1, 5, [0]), (3, 5, [0, 1, 2]), (9, 3, [0, 4, 8])])
def test_positions_are_spread_from_first_to_last(count: int, most: int, expected: list[int]) -> None:
    assert spread(count, most) == expected
