"""The simulated walk as a recording on disk."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.simulation import SimulatedRoom, write_recording
from ovip.recordings import Recording, open_recording


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
