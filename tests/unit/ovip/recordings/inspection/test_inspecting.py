"""Inspecting a walk through a simulated home: as it is, and broken in the ways that recordings are."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lab.simulation.room import SimulatedRoom
from lab.simulation.writing import write_recording
from ovip.recordings import open_recording
from ovip.recordings.inspection import Finding, draw_sheet, inspect_recording, worst
from ovip.scene.types import F64

FRAMES = 36
FLIP = np.diag([1.0, -1, -1, 1])
Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("simulated") / "walk"
    room = SimulatedRoom(0)
    write_recording(folder, room, room.walk()[:FRAMES])
    return folder


@pytest.fixture
def copy(walk: Path, tmp_path: Path) -> Path:
    folder = tmp_path / "copy"
    shutil.copytree(walk, folder)
    return folder


def look(folder: Path, up: tuple[float, float, float] | None = None) -> dict[str, Finding]:
    return {f.check: f for f in inspect_recording(open_recording(folder, "ovip", up=up))}


def change_camera(folder: Path, **changes: float) -> None:
    camera = json.loads((folder / "intrinsics.json").read_text())
    (folder / "intrinsics.json").write_text(json.dumps({**camera, **changes}))


def change_poses(folder: Path, change: Callable[[F64], F64]) -> None:
    poses = np.loadtxt(folder / "poses.txt").reshape(-1, 4, 4)
    rows = [change(pose).ravel() for pose in poses]
    np.savetxt(folder / "poses.txt", rows, fmt="%.9g")


def quaternion_reordered(pose: F64) -> F64:
    x, y, z, w = Rotation.from_matrix(pose[:3, :3]).as_quat()
    wrong = pose.copy()
    wrong[:3, :3] = Rotation.from_quat([w, x, y, z]).as_matrix()
    return wrong


def in_millimetres(pose: F64) -> F64:
    larger = pose.copy()
    larger[:3, 3] *= 1000
    return larger


def test_a_right_recording_has_nothing_wrong(walk: Path) -> None:
    found = look(walk)
    assert {finding.level for finding in found.values()} == {"ok"}
    assert list(found) == [
        "frames",
        "times",
        "path",
        "intrinsics",
        "depth",
        "agreement",
        "up",
        "registration",
    ]
    assert found["agreement"].figures["agree"] > 0.9  # type: ignore[operator]
    assert found["frames"].says == f"{FRAMES} frames of 320x240"


@pytest.mark.parametrize("claimed", [5000, 6553.5, 256])
def test_a_wrong_depth_scale_is_told_with_the_one_that_fits(copy: Path, claimed: float) -> None:
    change_camera(copy, depth_scale=claimed)
    found = look(copy)["agreement"]
    assert found.level == "wrong"
    assert "if depth had 1000 units a metre (--option depth_scale=1000)" in found.says


@pytest.mark.parametrize(
    ("break_", "says"),
    [
        (lambda pose: pose @ FLIP, "the camera's axes were OpenGL's"),
        (np.linalg.inv, "the poses were camera_from_world"),
        (lambda pose: FLIP @ np.linalg.inv(pose), "the poses were camera_from_world of an OpenGL camera"),
        (quaternion_reordered, "quaternions were in the order qw qx qy qz"),
        (in_millimetres, "poses were in millimetres"),
    ],
)
def test_a_wrong_convention_of_poses_is_named(copy: Path, break_: Callable[[F64], F64], says: str) -> None:
    change_poses(copy, break_)
    found = look(copy)["agreement"]
    assert found.level == "wrong"
    assert found.says.endswith(f"if {says}") or f"if {says} (" in found.says


def test_a_wrong_focal_length_is_named(copy: Path) -> None:
    change_camera(copy, fx=460, fy=460)
    found = look(copy)["agreement"]
    assert found.level == "wrong"
    assert found.says.endswith("if the focal length were 0.5 times as long")


def test_depth_of_other_frames_is_out_of_step_with_poses_and_with_colour(copy: Path) -> None:
    for number in range(FRAMES - 3):
        shutil.copy(copy / "depth" / f"{number + 3:06d}.png", copy / "depth" / f"{number:06d}.png")
    found = look(copy)
    assert found["agreement"].says.endswith("if depth had the pose of the frame 3 later")
    assert found["agreement"].level == found["registration"].level == "wrong"
    assert "depth of 3 frames earlier fits the colour better" in found["registration"].says


def test_colour_of_other_frames_is_out_of_step_with_depth_alone(copy: Path) -> None:
    for number in range(FRAMES - 2):
        shutil.copy(copy / "rgb" / f"{number + 2:06d}.jpg", copy / "rgb" / f"{number:06d}.jpg")
    found = look(copy)
    assert found["agreement"].level == "ok"
    assert found["registration"].level == "wrong"
    assert "depth of 2 frames later" in found["registration"].says


def test_depth_beside_its_colour_is_told_with_the_way_back(copy: Path) -> None:
    for path in (copy / "depth").iterdir():
        moved = np.roll(cv2.imread(str(path), cv2.IMREAD_UNCHANGED), 9, axis=1)
        cv2.imwrite(str(path), moved)
    found = look(copy)["registration"]
    assert found.level == "warning"
    assert "moved by (-9, 0) pixels" in found.says


def test_a_world_that_is_not_z_up_is_told_with_the_up_to_pass(copy: Path) -> None:
    change_poses(copy, lambda pose: Y_UP @ pose)
    found = look(copy)["up"]
    assert found.level == "wrong"
    up = np.array([float(word) for word in found.says.rpartition("--up ")[2].split(",")])
    np.testing.assert_allclose(up, [0, 1, 0], atol=0.02)
    assert look(copy, up=(0, 1, 0))["up"].level == "ok"


def test_images_that_do_not_decode_are_named(copy: Path) -> None:
    whole = (copy / "rgb" / "000000.jpg").read_bytes()
    png = (copy / "depth" / "000000.png").read_bytes()
    (copy / "depth" / "000000.png").write_bytes(png[:60])
    (copy / "rgb" / "000000.jpg").write_bytes(whole)
    found = look(copy)["images"]
    assert (found.level, found.says) == ("wrong", "1 of the frames looked at do not decode: 000000")


def test_frames_too_few_or_too_far_apart_are_not_judged(walk: Path) -> None:
    one = {f.check: f for f in inspect_recording(open_recording(walk, "ovip", stride=FRAMES))}
    assert {check for check, finding in one.items() if finding.level == "warning"} == {
        "times",
        "path",
        "agreement",
        "registration",
    }
    far = inspect_recording(open_recording(walk, "ovip", stride=9))
    assert worst(far) == "warning"


def test_two_looks_find_the_same(walk: Path) -> None:
    assert look(walk) == look(walk)


def test_the_worst_of_some_findings() -> None:
    ok, warning, wrong = (Finding("depth", level, "") for level in ("ok", "warning", "wrong"))
    assert worst([]) == worst([ok]) == "ok"
    assert worst([ok, warning]) == "warning"
    assert worst([wrong, ok, warning]) == "wrong"


def test_a_contact_sheet_shows_colour_above_depth_of_twelve_frames(walk: Path) -> None:
    recording = open_recording(walk, "ovip")
    sheet = draw_sheet(recording)
    # three rows of four; 180 pixels high at the sheet's 240 wide; a line of words above, gaps below
    assert sheet.shape == (3 * (16 + 2 * 180 + 12), 4 * (240 + 6), 3)
    first = cv2.imdecode(np.frombuffer(recording.load(0).rgb_bytes, np.uint8), cv2.IMREAD_COLOR)
    small = cv2.resize(first, (240, 180), interpolation=cv2.INTER_AREA)
    np.testing.assert_array_equal(sheet[16:196, :240], small)
    assert len(np.unique(sheet[202:382, :240].reshape(-1, 3), axis=0)) > 20


def test_a_sheet_of_one_frame_is_one_tile(walk: Path) -> None:
    assert draw_sheet(open_recording(walk, "ovip", stride=FRAMES)).shape == (388, 246, 3)


def test_kitchen_fits_but_its_depth_lies_beside_its_colour(kitchen: Path) -> None:
    found = {f.check: f for f in inspect_recording(open_recording(kitchen, "7scenes"))}
    assert {check for check, finding in found.items() if finding.level != "ok"} == {"registration"}
    assert found["agreement"].figures["agree"] > 0.85  # type: ignore[operator]


def test_small_house_has_nothing_wrong(small_house: Path) -> None:
    found = inspect_recording(open_recording(small_house / "seq_a", "ovip", stride=4))
    assert {finding.level for finding in found} == {"ok"}
