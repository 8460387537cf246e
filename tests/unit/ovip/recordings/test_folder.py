"""Layout ovip: our own folder form, read and written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import OnboardDetection, new_folder, open_recording, write_folder
from ovip.scene.types import Box2, Intrinsics


def test_frames_poses_and_camera_are_read(ovip_folder, pose_at) -> None:
    folder = ovip_folder()
    recording = open_recording(folder, "ovip")
    frames = list(recording)
    assert recording.intrinsics == Intrinsics(60, 60, 31.5, 23.5, 64, 48)
    assert [frame.timestamp_ns for frame in frames] == [0, 100_000_000, 200_000_000, 300_000_000]
    np.testing.assert_allclose(frames[3].world_from_camera, pose_at(3), atol=1e-9)
    assert frames[3].onboard is None


def test_what_is_written_is_read_back(ovip_folder, tmp_path: Path) -> None:
    source = open_recording(ovip_folder(), "ovip")
    mask = np.zeros((48, 64), dtype=bool)
    mask[3:9, 5:20] = True
    seen = (OnboardDetection("mug", 0.75, Box2(5, 3, 20, 9), mask, np.array([0.6, 0.8], np.float32)),)
    frames = [type(frame)(*(getattr(frame, name) for name in frame.__slots__[:-1]), seen) for frame in source]
    assert write_folder(tmp_path / "copy", source.intrinsics, frames) == 4
    copy = open_recording(tmp_path / "copy", "ovip")
    assert copy.fingerprint() == source.fingerprint()
    for before, after in zip(source, copy, strict=True):
        assert before.rgb_bytes == after.rgb_bytes
        assert before.depth_bytes == after.depth_bytes
        assert before.timestamp_ns == after.timestamp_ns
        np.testing.assert_array_equal(before.world_from_camera, after.world_from_camera)
        assert after.onboard is not None
        np.testing.assert_array_equal(after.onboard[0].mask, mask)
        assert (after.onboard[0].label, after.onboard[0].score, after.onboard[0].box2) == (
            "mug",
            0.75,
            seen[0].box2,
        )


def test_no_recording_is_written_over(ovip_folder) -> None:
    folder = ovip_folder()
    with pytest.raises(InvalidInput, match="expected a folder without a recording"):
        write_folder(folder, Intrinsics(60, 60, 31.5, 23.5, 64, 48), [])


def test_a_run_that_fails_in_the_middle_leaves_nothing(tmp_path: Path) -> None:
    with (
        pytest.raises(InvalidInput, match="kept: cannot be written: No space left on device"),
        new_folder(tmp_path / "kept") as folder,
    ):
        (folder / "rgb").mkdir()
        raise OSError(28, "No space left on device")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_appears_only_when_all_of_it_is_written(tmp_path: Path) -> None:
    with new_folder(tmp_path / "kept") as folder:
        (folder / "poses.txt").write_text("")
        assert not (tmp_path / "kept").exists()
    assert [path.name for path in tmp_path.rglob("*")] == ["kept", "poses.txt"]


@pytest.mark.parametrize("name", ["kept", "kept/poses.txt"])
def test_a_new_folder_in_use_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "poses.txt").write_text("mine")
    with pytest.raises(InvalidInput, match="does not exist yet or is empty"), new_folder(tmp_path / name):
        pass
    assert (tmp_path / "kept" / "poses.txt").read_text() == "mine"


def test_a_robot_that_saw_nothing_differs_from_one_that_does_not_detect(ovip_folder) -> None:
    folder = ovip_folder()
    (folder / "detections").mkdir()
    (folder / "detections" / "000001.json").write_text('{"detections": []}')
    assert [frame.onboard for frame in open_recording(folder, "ovip")] == [None, (), None, None]


def test_a_pose_per_frame_number_is_expected(ovip_folder) -> None:
    folder = ovip_folder()
    lines = (folder / "poses.txt").read_text().splitlines()
    (folder / "poses.txt").write_text("\n".join(lines[:-1]))
    with pytest.raises(InvalidInput, match=r"line 4 for 000003\.jpg, got 3 lines"):
        open_recording(folder, "ovip")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("poses.txt", None, r"poses\.txt: expected a readable text file"),
        ("poses.txt", "1 0 0 0\n", r"poses\.txt line 1: expected 16 numbers"),
        ("intrinsics.json", None, r"intrinsics\.json: expected a readable text file"),
        ("intrinsics.json", "{", "expected JSON, got an error at line 1"),
        ("intrinsics.json", "[1]", "expected a JSON object, got list"),
        ("intrinsics.json", '{"fx": 60}', "expected a number under 'fy'"),
        ("timestamps.txt", "1\n2\n", "expected a time for each of the 4 poses, got 2"),
        ("timestamps.txt", "1\n2\n3\nsoon\n", "line 4: expected whole nanoseconds, got 'soon'"),
    ],
)
def test_wrong_files_say_what_was_expected(ovip_folder, name: str, text: str | None, message: str) -> None:
    folder = ovip_folder()
    (folder / name).unlink() if text is None else (folder / name).write_text(text)
    with pytest.raises(InvalidInput, match=message):
        open_recording(folder, "ovip")


def test_intrinsics_that_cannot_be_a_cameras_are_refused(ovip_folder) -> None:
    folder = ovip_folder()
    values = json.loads((folder / "intrinsics.json").read_text())
    (folder / "intrinsics.json").write_text(json.dumps({**values, "fx": -60.0}))
    with pytest.raises(InvalidInput, match=r"intrinsics\.json: intrinsics: expected focal lengths"):
        open_recording(folder, "ovip")


def test_small_house_is_read_and_its_up_is_found(small_house: Path) -> None:
    recording = open_recording(small_house / "seq_a", "ovip", up="auto", stride=3)
    assert len(recording) == 140
    assert recording.skipped == ()
    assert np.degrees(np.arccos(recording.world_from_source[2, 2])) < 0.5
    np.testing.assert_allclose(
        next(iter(recording)).world_from_camera[:3, 3], [4.963, -3.847, 1.2], atol=0.01
    )
