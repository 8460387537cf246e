"""Opening any recording: strides, fingerprints, sizes, wrong folders."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.recordings.text import natural


def test_a_stride_keeps_the_original_positions(ovip_folder) -> None:
    recording = open_recording(ovip_folder(7), "ovip", stride=3)
    assert len(recording) == 3
    assert [frame.index for frame in recording] == [0, 3, 6]


def test_going_on_after_an_index_yields_only_later_frames(ovip_folder) -> None:
    recording = open_recording(ovip_folder(5), "ovip", stride=2)
    assert [frame.index for frame in recording.frames(after=1)] == [2, 4]
    assert list(recording.frames(after=4)) == []


def test_it_can_be_iterated_again(ovip_folder) -> None:
    recording = open_recording(ovip_folder(2), "ovip")
    assert [frame.index for frame in recording] == [frame.index for frame in recording] == [0, 1]


def test_the_fingerprint_knows_poses_names_camera_and_up_but_not_the_stride(ovip_folder) -> None:
    folder = ovip_folder()
    first = open_recording(folder, "ovip").fingerprint()
    assert open_recording(folder, "ovip", stride=2).fingerprint() == first
    assert open_recording(folder, "ovip", up=(0, 0.1, 1)).fingerprint() != first
    camera = (folder / "intrinsics.json").read_text()
    (folder / "intrinsics.json").write_text(camera.replace("31.5", "31.25"))
    assert open_recording(folder, "ovip").fingerprint() != first
    (folder / "intrinsics.json").write_text(camera)
    assert open_recording(folder, "ovip").fingerprint() == first
    poses = (folder / "poses.txt").read_text()
    (folder / "poses.txt").write_text(poses.replace("1.3", "1.4", 1))
    assert open_recording(folder, "ovip").fingerprint() != first
    (folder / "poses.txt").write_text(poses)
    (folder / "rgb" / "000003.jpg").unlink()
    assert open_recording(folder, "ovip").fingerprint() != first


@pytest.mark.parametrize("kind", ["rgb", "depth"])
def test_images_of_another_size_than_the_intrinsics_are_an_error(
    ovip_folder, write_rgb, write_depth, kind
) -> None:
    folder = ovip_folder()
    if kind == "rgb":
        write_rgb(folder / "rgb" / "000002.jpg", (32, 24))
    else:
        write_depth(folder / "depth" / "000002.png", 5, (32, 24))
    with pytest.raises(InvalidInput, match=r"000002\.\w+: expected 64x48 pixels .* got 32x24"):
        open_recording(folder, "ovip")


def test_depth_of_eight_bits_is_an_error(ovip_folder) -> None:
    folder = ovip_folder()
    cv2.imwrite(str(folder / "depth" / "000001.png"), np.zeros((48, 64), np.uint8))
    with pytest.raises(
        InvalidInput, match=r"000001\.png: expected a 16-bit PNG of one channel, got 8-bit png"
    ):
        open_recording(folder, "ovip")


def test_broken_images_and_poses_are_skipped_one_by_one(ovip_folder) -> None:
    folder = ovip_folder(6)
    (folder / "rgb" / "000000.jpg").write_bytes(b"")
    (folder / "depth" / "000001.png").write_bytes(b"not an image")
    lines = (folder / "poses.txt").read_text().splitlines()
    lines[2] = lines[2].replace("1 0", "nan 0", 1)
    lines[3] = lines[3].replace("1 0", "2 0", 1)
    (folder / "poses.txt").write_text("\n".join(lines))
    recording = open_recording(folder, "ovip")
    assert [frame.index for frame in recording] == [4, 5]
    reasons = [frame.reason for frame in recording.skipped]
    assert reasons[:3] == [
        "colour image missing or not a JPEG or PNG",
        "depth image missing or not a PNG",
        "pose not finite (tracking lost)",
    ]
    assert reasons[3].startswith("pose: expected a rigid world_from_camera")


def test_nothing_that_can_be_used_is_an_error_with_the_reasons(ovip_folder) -> None:
    folder = ovip_folder(3)
    for path in (folder / "depth").iterdir():
        path.unlink()
    with pytest.raises(
        InvalidInput, match=r"walk: expected frames .* got none to use: no depth image \(3 frames\)"
    ):
        open_recording(folder, "ovip")


def test_a_folder_of_another_layout_is_told_the_one_that_fits(tum, ovip_folder, sevenscenes, replica) -> None:
    folders = {"tum": tum(), "ovip": ovip_folder(), "7scenes": sevenscenes(), "replica": replica()}
    for layout, folder in folders.items():
        for other in folders.keys() - {layout}:
            with pytest.raises(
                InvalidInput, match=rf"expected layout {other} .* This looks like layout {layout}\."
            ):
                open_recording(folder, other, up=(0, 0, 1))


def test_the_folder_above_a_recording_is_told_the_one_inside(ovip_folder) -> None:
    with pytest.raises(InvalidInput, match=r"found walk/\. The folder walk inside looks like layout ovip\."):
        open_recording(ovip_folder().parent, "7scenes")


def test_an_empty_folder_a_file_and_nothing_are_told_apart(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"expected layout tum \(rgb\.txt, .*found an empty folder\."):
        open_recording(tmp_path, "tum")
    (tmp_path / "a.bag").write_bytes(b"")
    with pytest.raises(InvalidInput, match="got a file there"):
        open_recording(tmp_path / "a.bag", "tum")
    with pytest.raises(InvalidInput, match="got nothing there"):
        open_recording(tmp_path / "missing", "tum")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"layout": "kitti"}, "layout: expected one of ovip, 7scenes, tum, replica, .*, got 'kitti'"),
        ({"layout": "ovip", "options": {"hfov": "90"}}, "layout ovip takes depth_scale .*; got hfov"),
        ({"layout": "ovip", "options": {"depth_scale": "mm"}}, "option depth_scale: .* got 'mm'"),
        ({"layout": "ovip", "options": {"depth_scale": "0"}}, "option depth_scale: .* above 0, got '0'"),
        ({"layout": "ovip", "stride": 0}, "stride: expected 1 or more, got 0"),
        ({"layout": "ovip", "up": (0.0, 0.0, 0.0)}, "up: expected three finite numbers"),
        ({"layout": "ovip", "up": "north"}, "up: expected 'auto' or three numbers"),
    ],
)
def test_wrong_arguments_say_what_was_expected(ovip_folder, arguments, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        open_recording(ovip_folder(), **arguments)


def test_natural_order_puts_two_before_ten() -> None:
    assert sorted(["f10", "f2", "f1b", "f1"], key=natural) == ["f1", "f1b", "f2", "f10"]
