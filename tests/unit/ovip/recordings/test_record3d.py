"""Layout record3d: a recording of the Record3D app, unpacked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.recordings.images import decode_raw_depth
from ovip.scene.types import Intrinsics

CONFIG = """camera_params:
  cx: 24.0
  cy: 31.25
  fx: 5.0e+1
  fy: 51.0
  image_height: 64
  image_width: 48
  png_depth_scale: 1000.0
dataset_name: record3d
"""


@pytest.fixture
def unpacked(tmp_path: Path, write_rgb, write_depth) -> Path:
    folder = tmp_path / "kitchen_r3d"
    for name in ("conf", "poses"):
        (folder / name).mkdir(parents=True)
    for number in (0, 9, 10):
        write_rgb(folder / "rgb" / f"{number}.png", (48, 64), seed=number)
        write_depth(folder / "depth" / f"{number}.png", 1500, (48, 64))
        conf = np.full((64, 48), 2, np.uint8)
        conf[:10], conf[10:20] = 0, 1
        np.save(folder / "conf" / f"{number}.npy", conf)
        pose = np.eye(4, dtype=np.float32)
        pose[:3, 3] = [number, 1.5, 4.0]
        np.save(folder / "poses" / f"{number}.npy", pose)
    (folder / "dataconfig.yaml").write_text(CONFIG)
    return folder


def test_frames_poses_and_camera_are_read(unpacked: Path) -> None:
    recording = open_recording(unpacked, "record3d")
    assert recording.names() == ("0", "9", "10")
    assert recording.intrinsics == Intrinsics(50, 51, 24, 31.25, 48, 64)
    pose = recording.load(1).world_from_camera
    np.testing.assert_allclose(pose[:3, 3], [9, -4, 1.5], atol=1e-6)
    np.testing.assert_allclose(pose[:3, 2], [0, 1, 0], atol=1e-6)
    assert recording.load(1).timestamp_ns == 300_000_000


@pytest.mark.parametrize(("confidence", "first"), [("0", 0), ("1", 10), ("2", 20)])
def test_depth_less_sure_than_asked_is_left_out(unpacked: Path, confidence: str, first: int) -> None:
    recording = open_recording(unpacked, "record3d", options={"confidence": confidence})
    raw = decode_raw_depth(recording.load(0).depth_bytes)
    assert raw is not None
    assert (raw[:first] == 0).all()
    assert (raw[first:] == 1500).all()


def test_depth_that_was_sorted_out_before_is_used_as_it_is(unpacked: Path, write_depth) -> None:
    for number in (0, 9, 10):
        ready = write_depth(unpacked / "high_conf_depth" / f"{number}.png", 1700, (48, 64))
    assert open_recording(unpacked, "record3d").load(2).depth_bytes == ready


def test_without_confidence_all_depth_is_used_and_that_is_told(unpacked: Path) -> None:
    for path in (unpacked / "conf").iterdir():
        path.unlink()
    (unpacked / "conf").rmdir()
    recording = open_recording(unpacked, "record3d")
    assert recording.notes == ("no conf/: depth of every confidence is used",)
    assert len(recording) == 3


def test_a_packed_archive_is_told_to_be_unpacked_first(tmp_path: Path) -> None:
    (tmp_path / "a.r3d").write_bytes(b"PK")
    with pytest.raises(
        InvalidInput, match="packs its depth as LZFSE, which is not read here; unpack it first"
    ):
        open_recording(tmp_path / "a.r3d", "record3d")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("  fy: 51.0\n", "", "expected camera_params with fx, .* got no fy"),
        ("fy: 51.0", "fy: -51.0", r"dataconfig\.yaml: intrinsics: expected focal lengths"),
        ("fy: 51.0", "fy: 5.1.0", r"dataconfig\.yaml: expected a number, got '5\.1\.0'"),
    ],
)
def test_a_wrong_camera_file_says_what_was_expected(unpacked: Path, old: str, new: str, message: str) -> None:
    (unpacked / "dataconfig.yaml").write_text(CONFIG.replace(old, new))
    with pytest.raises(InvalidInput, match=message):
        open_recording(unpacked, "record3d")


def test_a_wrong_pose_and_a_wrong_confidence_are_named(unpacked: Path) -> None:
    np.save(unpacked / "conf" / "9.npy", np.zeros((4, 4), np.uint8))
    with pytest.raises(
        InvalidInput, match=r"9\.png: expected a 16-bit PNG of the same size as 9\.npy \(4, 4\)"
    ):
        open_recording(unpacked, "record3d").load(1)
    np.save(unpacked / "poses" / "9.npy", np.eye(3))
    with pytest.raises(InvalidInput, match=r"9\.npy: expected a 4x4 pose, got an array of shape \(3, 3\)"):
        open_recording(unpacked, "record3d")
    (unpacked / "poses" / "9.npy").write_bytes(b"")
    with pytest.raises(InvalidInput, match=r"9\.npy: expected a NumPy array"):
        open_recording(unpacked, "record3d")


def test_a_confidence_that_is_none_is_an_error(unpacked: Path) -> None:
    with pytest.raises(InvalidInput, match="option confidence: expected 0, 1 or 2, got 'high'"):
        open_recording(unpacked, "record3d", options={"confidence": "high"})
