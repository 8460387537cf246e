"""Layout scannet: the exporter's folders, and NICE-SLAM's."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.scene.types import Intrinsics

NUMBERS = (0, 2, 10)


@pytest.fixture
def scan(tmp_path: Path, write_rgb, write_depth, pose_at):
    def make(inside: str = "", color_size: tuple[int, int] = (130, 97)) -> Path:
        folder = tmp_path / "scene0000_00"
        root = folder / inside
        for index, number in enumerate(NUMBERS):
            write_rgb(root / "color" / f"{number}.jpg", color_size, seed=number)
            write_depth(root / "depth" / f"{number}.png", 1000 + number)
            (root / "pose").mkdir(exist_ok=True)
            rows = pose_at(index)
            np.savetxt(root / "pose" / f"{number}.txt", rows, fmt="%.6f")
        (root / "intrinsic").mkdir()
        for name, numbers in {"depth": (60, 60, 31.5, 23.5), "color": (130, 128, 64.5, 48)}.items():
            k = np.eye(4)
            k[[0, 1, 0, 1], [0, 1, 2, 2]] = numbers
            np.savetxt(root / "intrinsic" / f"intrinsic_{name}.txt", k, fmt="%.6f")
            np.savetxt(root / "intrinsic" / f"extrinsic_{name}.txt", np.eye(4), fmt="%.6f")
        return folder

    return make


@pytest.mark.parametrize("inside", ["", "frames"])
def test_frames_in_natural_order_poses_and_the_depth_camera_are_read(scan, pose_at, inside: str) -> None:
    recording = open_recording(scan(inside), "scannet")
    frames = list(recording)
    assert recording.names() == ("0", "2", "10")
    assert recording.intrinsics == Intrinsics(60, 60, 31.5, 23.5, 64, 48)
    assert recording.depth_scale == 1000
    assert frames[2].timestamp_ns == 333_333_333
    np.testing.assert_allclose(frames[2].world_from_camera, pose_at(2), atol=1e-6)
    np.testing.assert_array_equal(recording.poses()[1], frames[1].world_from_camera)


def test_colour_is_brought_to_the_size_of_depth_and_that_is_told(scan) -> None:
    folder = scan()
    gradient = np.zeros((97, 130, 3), np.uint8)
    gradient[..., 1] = np.linspace(0, 250, 130).astype(np.uint8)
    cv2.imwrite(str(folder / "color" / "0.jpg"), gradient, [cv2.IMWRITE_JPEG_QUALITY, 98])
    recording = open_recording(folder, "scannet")
    image = cv2.imdecode(np.frombuffer(recording.load(0).rgb_bytes, np.uint8), cv2.IMREAD_COLOR)
    assert image.shape == (48, 64, 3)
    np.testing.assert_allclose(image[24, :, 1], np.linspace(1, 249, 64), atol=5)
    assert recording.notes == (
        "colour of 130x97 is brought to the depth image's 64x48, with the depth camera's intrinsics",
    )


def test_colour_of_the_same_size_is_passed_on_as_it_is(scan) -> None:
    folder = scan(color_size=(64, 48))
    recording = open_recording(folder, "scannet")
    assert recording.load(1).rgb_bytes == (folder / "color" / "2.jpg").read_bytes()
    assert recording.notes == ()


def test_a_pose_of_minus_infinity_is_skipped(scan) -> None:
    folder = scan()
    (folder / "pose" / "2.txt").write_text("-inf -inf -inf -inf\n" * 4)
    recording = open_recording(folder, "scannet")
    assert recording.names() == ("0", "10")
    assert recording.skipped[0].reason == "pose not finite (tracking lost)"


def test_without_the_depth_cameras_intrinsics_the_colour_cameras_are_scaled(scan) -> None:
    folder = scan()
    (folder / "intrinsic" / "intrinsic_depth.txt").unlink()
    recording = open_recording(folder, "scannet")
    k = recording.intrinsics
    np.testing.assert_allclose(
        [k.fx, k.fy, k.cx, k.cy], [64, 128 * 48 / 97, 31.5, 48.5 * 48 / 97 - 0.5], atol=1e-9
    )
    assert recording.notes[1].startswith("no intrinsic/intrinsic_depth.txt")


@pytest.mark.parametrize(
    ("gone", "message"),
    [
        ("depth", r"depth: expected images \(.jpg or .png\), got none"),
        ("pose", r"pose: expected a pose N\.txt for each image, got none"),
        ("intrinsic", r"intrinsic_color\.txt: expected a readable text file"),
    ],
)
def test_what_is_missing_is_named(scan, gone: str, message: str) -> None:
    folder = scan()
    for path in (folder / gone).iterdir():
        path.unlink()
    with pytest.raises(InvalidInput, match=message):
        open_recording(folder, "scannet")


def test_a_folder_without_color_is_told_what_was_expected_and_what_is_there(ovip_folder) -> None:
    with pytest.raises(
        InvalidInput,
        match=r"expected layout scannet \(color/N\.jpg.*found depth/, intrinsics\.json, .*layout ovip",
    ):
        open_recording(ovip_folder(), "scannet")
