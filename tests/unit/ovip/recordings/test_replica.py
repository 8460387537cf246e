"""Layout replica: NICE-SLAM's render."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.scene.types import Intrinsics


def test_frames_poses_and_camera_are_read(replica, pose_at) -> None:
    folder = replica()
    recording = open_recording(folder, "replica")
    frames = list(recording)
    assert recording.name == "room0"
    assert recording.intrinsics == Intrinsics(60, 60, 31.5, 23.5, 64, 48)
    assert recording.depth_scale == frames[0].depth_scale == 6553.5
    assert recording.notes == ()
    np.testing.assert_allclose(frames[2].world_from_camera, pose_at(2), atol=1e-9)
    assert frames[2].depth_bytes == (folder / "results" / "depth000002.png").read_bytes()
    assert frames[1].timestamp_ns == 33_333_333


def test_without_camera_file_the_documented_camera_is_used_and_said(replica) -> None:
    recording = open_recording(replica(camera=False, count=1), "replica")
    assert recording.intrinsics == Intrinsics(600, 600, 599.5, 339.5, 1200, 680)
    assert recording.depth_scale == 6553.5
    assert recording.notes[0].startswith("no cam_params.json in the folder above: used")


def test_a_frame_keeps_its_own_pose_where_others_are_missing(replica, pose_at) -> None:
    folder = replica()
    (folder / "results" / "frame000001.jpg").unlink()
    (folder / "results" / "depth000001.png").unlink()
    frames = list(open_recording(folder, "replica"))
    np.testing.assert_allclose(frames[1].world_from_camera, pose_at(2), atol=1e-9)


def test_fewer_poses_than_frames_is_an_error(replica) -> None:
    folder = replica()
    lines = (folder / "traj.txt").read_text().splitlines()
    (folder / "traj.txt").write_text("\n".join(lines[:2]))
    with pytest.raises(InvalidInput, match=r"line 3 for frame000002\.jpg, got 2 lines"):
        open_recording(folder, "replica")


def test_a_missing_trajectory_is_named(replica) -> None:
    folder = replica()
    (folder / "traj.txt").unlink()
    with pytest.raises(InvalidInput, match=r"traj\.txt: expected a readable text file"):
        open_recording(folder, "replica")


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        ({"w": 64}, r"\"camera\""),
        (
            {"camera": {"w": 64, "h": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5}},
            "expected a number under 'scale'",
        ),
        ({"camera": {"w": 64, "h": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5, "scale": 0}}, "above 0"),
        (
            {"camera": {"w": 64.5, "h": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5, "scale": 1}},
            "whole w and h",
        ),
    ],
)
def test_a_wrong_camera_file_says_what_was_expected(replica, camera: dict[str, object], message: str) -> None:
    folder = replica()
    (folder.parent / "cam_params.json").write_text(json.dumps(camera))
    with pytest.raises(InvalidInput, match=message):
        open_recording(folder, "replica")
