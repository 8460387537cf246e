"""The simulated walk as a recording on disk."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.simulation import (
    HomeWorld,
    HomeWorldParams,
    SensorParams,
    SimulatedRoom,
    write_home_recording,
    write_recording,
)
from ovip.recordings import Recording, open_recording
from ovip.scene.types import Intrinsics
from tests.unit.lab.simulation.box_homes import MUG, TABLE, box_home


@pytest.fixture(scope="module")
def room() -> SimulatedRoom:
    return SimulatedRoom()


@pytest.fixture(scope="module")
def folder(room: SimulatedRoom, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("simulated") / "room"
    assert write_recording(folder, room, room.walk()[::10]) == 11
    return folder


@pytest.fixture(scope="module")
def recording(folder: Path) -> Recording:
    return open_recording(folder, "ovip")


def test_it_is_read_back_as_it_was_rendered(room: SimulatedRoom, recording: Recording) -> None:
    assert recording.intrinsics == room.intrinsics
    assert recording.skipped == ()
    for pose, frame in zip(room.walk()[::10], recording, strict=True):
        rgb, depth, ids = room.render(pose)
        np.testing.assert_allclose(frame.world_from_camera, pose, atol=1e-12)
        stored = cv2.imdecode(np.frombuffer(frame.depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
        np.testing.assert_allclose(stored / frame.depth_scale, depth, atol=0.00051)
        image = cv2.imdecode(np.frombuffer(frame.rgb_bytes, np.uint8), cv2.IMREAD_COLOR_RGB)
        assert np.abs(image.astype(int) - rgb).mean() < 4
        assert frame.onboard is not None
        assert all(np.unique(ids[detection.mask]).size == 1 for detection in frame.onboard)


def test_times_rise_by_a_tenth_of_a_second(recording: Recording) -> None:
    assert set(np.diff([frame.timestamp_ns for frame in recording]).tolist()) == {100_000_000}


def test_the_truth_lies_beside_it(room: SimulatedRoom, folder: Path) -> None:
    truth = json.loads((folder / "objects.json").read_text())
    assert len(truth) == len(room.objects)
    mug = next(thing for thing in truth if (thing["color"], thing["label"]) == ("white", "mug"))
    np.testing.assert_allclose(
        mug["aabb_low"] + mug["aabb_high"], room.object_with(mug["object_id"]).box, atol=1e-6
    )


def test_up_is_found_in_it(folder: Path) -> None:
    up = open_recording(folder, "ovip", up="auto").world_from_source[2, :3]
    assert np.degrees(np.arccos(up[2])) < 0.5


def test_the_same_seed_writes_the_same_bytes(room: SimulatedRoom, tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_recording(tmp_path / name, SimulatedRoom(3), room.walk()[:2])
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*") if path.is_file())
    assert len(files) == 2 * 3 + 4
    assert all((tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes() for name in files)


@pytest.fixture(scope="module")
def home_world() -> HomeWorld:
    pytest.importorskip("open3d", reason="a home is rendered by Open3D")
    small = Intrinsics(fx=115.0, fy=115.0, cx=79.5, cy=59.5, width=160, height=120)
    return HomeWorld(box_home(), small, 0, HomeWorldParams(SensorParams(), onboard=True, frames=10))


@pytest.fixture(scope="module")
def home_folder(home_world: HomeWorld, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("simulated") / "home"
    assert write_home_recording(folder, home_world) == 10
    return folder


def test_a_homes_recording_opens_and_its_poses_are_those_the_robot_believed(
    home_world: HomeWorld, home_folder: Path
) -> None:
    recording = open_recording(home_folder, "ovip")
    true_poses = np.loadtxt(home_folder / "true_poses.txt").reshape(-1, 4, 4)
    np.testing.assert_array_equal(true_poses, home_world.walk())
    believed = np.array([frame.world_from_camera for frame in recording])
    drift = np.linalg.norm(believed[:, :3, 3] - true_poses[:, :3, 3], axis=1)
    assert 0 < drift.max() < 0.1
    for (before, pose), (index, frame) in zip(
        pairwise(home_world.walk()), list(enumerate(recording))[1:], strict=True
    ):
        sight = home_world.observe(pose, index, before)
        stored = cv2.imdecode(np.frombuffer(frame.depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
        np.testing.assert_allclose(stored / frame.depth_scale, sight.depth, atol=0.00051)
        ids = cv2.imread(str(home_folder / "instance" / f"{index:06d}.png"), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(ids, sight.ids)


def test_a_homes_truth_lies_beside_it(home_world: HomeWorld, home_folder: Path) -> None:
    home = home_world.home
    things = json.loads((home_folder / "objects.json").read_text())
    mug = next(thing for thing in things if thing["label"] == "mug")
    assert (mug["object_id"], mug["attributes"], mug["area_id"], mug["structural"]) == (
        MUG,
        ["red"],
        1,
        False,
    )
    np.testing.assert_allclose(mug["aabb_low"] + mug["aabb_high"], home.object_with(MUG).box, atol=1e-6)
    assert len(things) == len(home.objects)
    relations = json.loads((home_folder / "relations.json").read_text())
    assert relations == [{"subject": MUG, "kind": "on", "object": TABLE}]
    areas = json.loads((home_folder / "areas.json").read_text())
    assert [area["function"] for area in areas["areas"]] == ["living room", "bedroom"]
    assert areas["storeys"] == [{"floor": 0, "z": 0.0, "ceiling_z": 2.6}]
    np.testing.assert_allclose(areas["rooms"][0]["polygon"], home.rooms[0].polygon)
    assert "nobody's work" in (home_folder / "ATTRIBUTION.txt").read_text()


def test_visibility_counts_the_frames_that_show_a_thing(home_folder: Path) -> None:
    visibility = json.loads((home_folder / "visibility.json").read_text())
    pixels = [
        (cv2.imread(str(path), cv2.IMREAD_UNCHANGED) == TABLE).sum()
        for path in sorted((home_folder / "instance").iterdir())
    ]
    assert visibility[str(TABLE)] == {
        "frames": sum(count >= 100 for count in pixels),
        "best_frame": int(np.argmax(pixels)),
        "most_pixels": max(pixels),
    }
