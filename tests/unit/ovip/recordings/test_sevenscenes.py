"""Layout 7scenes: the tsdf-fusion form."""

from __future__ import annotations

import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.scene.types import Intrinsics

UP = (0.0, 0.0, 1.0)


def test_frames_come_in_natural_order_with_bytes_as_on_disk(sevenscenes) -> None:
    folder = sevenscenes((4, 1000000, 30))
    recording = open_recording(folder, "7scenes", up=UP)
    frames = list(recording)
    assert recording.intrinsics == Intrinsics(60, 60, 32, 24, 64, 48)
    assert recording.depth_scale == 1000
    assert [frame.index for frame in frames] == [0, 1, 2]
    assert frames[1].rgb_bytes == (folder / "frame-000030.color.jpg").read_bytes()
    assert frames[1].depth_bytes == (folder / "frame-000030.depth.png").read_bytes()
    assert frames[1].rgb_encoding == "jpeg"
    assert frames[1].timestamp_ns == 1_000_000_000  # frame 30 at 30 Hz


def test_the_poses_are_read_as_they_are(sevenscenes, pose_at) -> None:
    frames = list(open_recording(sevenscenes(), "7scenes", up=UP))
    np.testing.assert_allclose(frames[2].world_from_camera, pose_at(2), atol=1e-6)


def test_up_turns_the_poses_z_up(sevenscenes) -> None:
    recording = open_recording(sevenscenes(), "7scenes", up=(0.0, 1.0, 0.0))
    np.testing.assert_allclose(recording.world_from_source[:3, :3] @ [0, 1, 0], [0, 0, 1], atol=1e-12)
    # the cameras look along the source's +y, which is up now
    np.testing.assert_allclose(next(iter(recording)).world_from_camera[:3, 2], [0, 0, 1], atol=1e-12)


def test_depth_65535_becomes_no_measurement_and_nothing_else_changes(sevenscenes) -> None:
    folder = sevenscenes()
    depth = np.arange(64 * 48, dtype=np.uint16).reshape(48, 64)
    depth[5:9, 7] = 65535
    cv2.imwrite(str(folder / "frame-000004.depth.png"), depth)
    frames = list(open_recording(folder, "7scenes", up=UP))
    got = cv2.imdecode(np.frombuffer(frames[1].depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(got, np.where(depth == 65535, 0, depth))
    assert frames[0].depth_bytes == (folder / "frame-000000.depth.png").read_bytes()


def test_lost_poses_and_missing_files_are_skipped_and_counted(sevenscenes) -> None:
    folder = sevenscenes((0, 1, 2, 3, 4))
    (folder / "frame-000001.pose.txt").write_text("-1.#IND 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    (folder / "frame-000002.depth.png").unlink()
    (folder / "frame-000003.pose.txt").unlink()
    recording = open_recording(folder, "7scenes", up=UP)
    assert len(recording) == 2
    assert [frame.index for frame in recording] == [0, 4]
    assert [(frame.index, frame.reason) for frame in recording.skipped] == [
        (1, "pose not finite (tracking lost)"),
        (2, "no depth image"),
        (3, "no pose"),
    ]


def test_missing_pose_files_are_an_error(sevenscenes) -> None:
    folder = sevenscenes()
    for path in folder.glob("*.pose.txt"):
        path.unlink()
    with pytest.raises(InvalidInput, match=r"expected a frame-NNNNNN\.pose\.txt beside each image, got none"):
        open_recording(folder, "7scenes", up=UP)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, r"expected camera-intrinsics\.txt"),
        ("60 0 32\n0 60 24\n", "expected a 3x3 or 4x4 camera matrix, got 6 numbers"),
        ("sixty 0 32\n0 60 24\n0 0 1\n", "expected numbers, got 'sixty"),
        ("60 0 32\n0 60 24\n0 0 2\n", "expected a camera matrix"),
        ("nan 0 32\n0 60 24\n0 0 1\n", "expected a camera matrix"),
        ("585 0 320\n0 585 240\n0 0 1\n", "intrinsics"),
        ("120 0 64\n0 120 48\n0 0 1\n", "expected intrinsics for the 64x48 images"),
    ],
)
def test_unreadable_or_foreign_intrinsics_are_an_error(sevenscenes, text: str | None, message: str) -> None:
    folder = sevenscenes()
    path = folder / "camera-intrinsics.txt"
    path.unlink() if text is None else path.write_text(text)
    with pytest.raises(InvalidInput, match=message):
        open_recording(folder, "7scenes", up=UP)


def test_a_pose_file_with_too_few_numbers_is_named(sevenscenes) -> None:
    folder = sevenscenes()
    (folder / "frame-000004.pose.txt").write_text("1 0 0 0\n")
    with pytest.raises(InvalidInput, match=r"frame-000004\.pose\.txt: expected 4x4 numbers, got 4"):
        open_recording(folder, "7scenes", up=UP)


def test_up_is_found_in_the_kitchen_within_two_degrees_and_soon(kitchen: Path) -> None:
    started = time.perf_counter()
    recording = open_recording(kitchen, "7scenes")
    assert time.perf_counter() - started < 8
    truth = np.array([0.007, -0.893, -0.450])
    cosine = float(recording.world_from_source[2, :3] @ truth / np.linalg.norm(truth))
    assert np.degrees(np.arccos(cosine)) < 2
    assert open_recording(kitchen, "7scenes", up="auto").fingerprint() == recording.fingerprint()


@pytest.mark.parametrize("stride", [2, 5, 11, 40])
def test_up_in_the_kitchen_does_not_hang_on_the_frames_used(kitchen: Path, stride: int) -> None:
    up = open_recording(kitchen, "7scenes", stride=stride).world_from_source[2, :3]
    assert np.degrees(np.arccos(up @ np.array([0.007, -0.893, -0.450]))) < 2


def test_the_kitchen_streams_as_it_lies_on_disk(kitchen: Path) -> None:
    recording = open_recording(kitchen, "7scenes", up=(0.007, -0.893, -0.450))
    assert len(recording) == 175
    assert recording.skipped == ()
    assert recording.intrinsics == Intrinsics(585, 585, 320, 240, 640, 480)
    frames = list(recording)
    assert frames[1].rgb_bytes == (kitchen / "frame-000004.color.jpg").read_bytes()
    assert all(frame.depth_bytes.startswith(b"\x89PNG") for frame in frames)
    heights = [frame.world_from_camera[2, 3] for frame in frames]
    assert (
        -0.27 - 0.1 < min(heights) < max(heights) < 0.06 + 0.1
    )  # floor at -1.53, cameras 1.26-1.59 above it
