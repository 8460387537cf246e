"""The simulated home: exact truth, a walk, and pictures that agree with both."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation import SimulatedRoom, onboard_detections, pose_looking
from ovip.scene.camera import backproject, check_pose, project
from ovip.scene.types import F64

EXPECTED = {
    "table": 1,
    "chair": 3,
    "sofa": 1,
    "tv": 1,
    "bed": 1,
    "refrigerator": 1,
    "sink": 1,
    "oven": 1,
    "bookshelf": 1,
    "mug": 2,
    "bottle": 1,
    "book": 1,
    "laptop": 1,
    "remote": 1,
    "vase": 1,
}


@pytest.fixture(scope="module")
def room() -> SimulatedRoom:
    return SimulatedRoom()


@pytest.fixture(scope="module")
def walk(room: SimulatedRoom) -> list[F64]:
    return room.walk()


def test_it_is_furnished(room: SimulatedRoom) -> None:
    count = Counter(thing.label for thing in room.objects if not thing.structural)
    assert {label: count[label] for label in EXPECTED} == EXPECTED
    assert [thing.object_id for thing in room.objects] == list(range(1, len(room.objects) + 1))
    assert {thing.color for thing in room.objects if thing.label == "mug"} == {"white", "red"}


def test_the_two_mugs_differ_by_what_a_camera_sees(room: SimulatedRoom, walk: list[F64]) -> None:
    colors = {}
    for pose in walk[-15:]:
        rgb, _, ids = room.render(pose)
        for thing in room.objects:
            if thing.label == "mug" and (ids == thing.object_id).sum() > 100:
                colors[thing.color] = rgb[ids == thing.object_id].mean(axis=0)
    assert colors["white"].min() > 170
    assert np.ptp(colors["white"]) < 15
    assert colors["red"][0] > 3 * colors["red"][1:].max()


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_small_things_stand_on_something(seed: int) -> None:
    room = SimulatedRoom(seed)
    tops = {"mug": "table", "laptop": "table", "bottle": "counter", "sink": "counter", "remote": "tv stand"}
    tops |= {"tv": "tv stand", "vase": "bookshelf", "book": "nightstand"}
    for thing in room.objects:
        if thing.label in tops:
            under = next(other for other in room.objects if other.label == tops[thing.label])
            assert thing.box[2] == pytest.approx(under.box[5], abs=0.015)
            assert (thing.box[:2] >= under.box[:2] - 0.01).all()
            assert (thing.box[3:5] <= under.box[3:5] + 0.01).all()


@pytest.mark.parametrize("seed", [0, 5])
def test_every_seen_point_lies_in_the_box_of_its_object(seed: int) -> None:
    room = SimulatedRoom(seed)
    for pose in room.walk()[::12]:
        _, depth, ids = room.render(pose)
        points, index = backproject(depth, room.intrinsics, pose)
        boxes = np.array([thing.box for thing in room.objects])[ids.ravel()[index] - 1]
        assert (points >= boxes[:, :3] - 1e-3).all()
        assert (points <= boxes[:, 3:] + 1e-3).all()


def test_one_frames_depth_lands_on_the_same_things_in_the_next(room: SimulatedRoom, walk: list[F64]) -> None:
    k = room.intrinsics
    for first, second in ((5, 6), (30, 31), (57, 58), (90, 92)):
        _, depth, ids = room.render(walk[first])
        _, next_depth, next_ids = room.render(walk[second])
        points, index = backproject(depth, k, walk[first])
        uv, z = project(points, k, walk[second])
        u, v = uv.round().astype(int).T
        inside = (z > 0) & (u >= 0) & (u < k.width) & (v >= 0) & (v < k.height)
        u, v, z, ids_here = u[inside], v[inside], z[inside], ids.ravel()[index][inside]
        visible = np.abs(next_depth[v, u] - z) < 0.03 * z  # a pixel's rounding on the slanted floor
        seen_through = next_depth[v, u] > 1.03 * z
        assert visible.mean() > 0.8  # the rest is hidden by something nearer
        assert seen_through.mean() < 0.01
        assert (next_ids[v, u][visible] == ids_here[visible]).mean() > 0.99


def test_every_pixel_of_the_closed_home_has_depth(room: SimulatedRoom, walk: list[F64]) -> None:
    for pose in walk[::20]:
        rgb, depth, ids = room.render(pose)
        assert (rgb.shape, rgb.dtype) == ((240, 320, 3), np.uint8)
        assert (depth.dtype, ids.dtype) == (np.float32, np.uint16)
        assert (depth > 0).all()
        assert (ids > 0).all()
        assert depth.max() < 11


def test_a_seed_gives_the_same_home_and_another_seed_another(walk: list[F64]) -> None:
    pose = walk[28]
    first, again, other = (SimulatedRoom(seed).render(pose) for seed in (7, 7, 8))
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
    assert (first[0] != other[0]).any()
    assert (first[1] != other[1]).any()


def test_the_walk_is_smooth_free_and_sees_everything(room: SimulatedRoom, walk: list[F64]) -> None:
    assert 80 <= len(walk) <= 120
    for before, after in pairwise(walk):
        assert np.linalg.norm(after[:3, 3] - before[:3, 3]) <= 0.23
        assert before[:3, 2] @ after[:3, 2] > np.cos(0.23)
    assert all(pose[2, 3] == pytest.approx(1.3) for pose in walk)
    assert all(room.is_free(pose[:2, 3], clearance=0.3) for pose in walk)
    seen: Counter[int] = Counter()
    for pose in walk[::2]:
        ids, counts = np.unique(room.render(pose)[2], return_counts=True)
        seen.update(ids[counts >= 40].tolist())
    things = [thing for thing in room.objects if not thing.structural]
    assert all(seen[thing.object_id] >= 3 for thing in things)


@pytest.mark.parametrize("seed", range(6))
def test_the_walk_is_free_whatever_the_seed(seed: int) -> None:
    room = SimulatedRoom(seed)
    assert all(room.is_free(pose[:2, 3], clearance=0.25) for pose in room.walk())


def test_where_a_robot_can_stand(room: SimulatedRoom) -> None:
    assert room.is_free(np.array([3.0, 1.5]))
    assert room.is_free(np.array([7.05, 2.65]))  # the doorway
    assert not room.is_free(np.array([7.05, 2.65]), clearance=0.5)  # is 0.9 m wide
    assert not room.is_free(np.array([7.05, 1.5]))  # the wall beside it
    assert not room.is_free(np.array([4.6, 2.4]))  # the table
    assert not room.is_free(np.array([9.0, 0.5]))  # outside the house
    assert not room.is_free(np.array([0.1, 1.5]))  # too near the wall


def test_level_and_downward_poses_by_hand() -> None:
    level = pose_looking((1, 2, 3), yaw=0.0, pitch=0.0)
    np.testing.assert_allclose(level[:3, :3] @ [0, 0, 1], [1, 0, 0], atol=1e-12)  # forward is +x
    np.testing.assert_allclose(level[:3, :3] @ [1, 0, 0], [0, -1, 0], atol=1e-12)  # right is -y
    np.testing.assert_allclose(level[:3, :3] @ [0, 1, 0], [0, 0, -1], atol=1e-12)  # down is -z
    down = pose_looking((0, 0, 1), yaw=np.pi / 2, pitch=-np.pi / 6)
    np.testing.assert_allclose(down[:3, 2], [0, np.sqrt(0.75), -0.5], atol=1e-12)


@given(st.floats(-7, 7), st.floats(-1.5, 1.5))
def test_every_pose_is_rigid_and_without_roll(yaw: float, pitch: float) -> None:
    pose = check_pose(pose_looking((0, 0, 0), yaw, pitch))
    assert abs(pose[2, 0]) < 1e-12


def test_on_board_detections_are_the_visible_things(room: SimulatedRoom, walk: list[F64]) -> None:
    _, _, ids = room.render(walk[-5])
    found = onboard_detections(room, ids)
    assert {"table", "chair", "mug", "laptop"} <= {detection.label for detection in found}
    assert not {"wall", "floor", "ceiling"} & {detection.label for detection in found}
    for detection in found:
        assert detection.mask is not None
        pixels = int(detection.mask.sum())
        assert pixels >= 40
        assert detection.score == pytest.approx(1 - 20 / pixels)
        rows, columns = np.nonzero(detection.mask)
        box = detection.box2
        assert (box.x0, box.y0, box.x1, box.y1) == (
            columns.min(),
            rows.min(),
            columns.max() + 1,
            rows.max() + 1,
        )
        (object_id,) = np.unique(ids[detection.mask])
        assert room.object_with(int(object_id)).label == detection.label
        assert (ids == object_id).sum() == pixels


def test_nothing_but_structure_in_view_gives_no_detections(room: SimulatedRoom) -> None:
    _, _, ids = room.render(pose_looking((8.0, 1.5, 1.3), yaw=-np.pi / 2, pitch=0.0))
    assert onboard_detections(room, ids) == ()
