"""Layouts hm3d and openeqa: OpenGL cameras in a world that is y up."""

from __future__ import annotations

from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings import open_recording
from ovip.scene.types import F64, Intrinsics

# habitat: y is up. Its camera at the origin without a turn looks along -z; ours, z up, then looks along +y.
FORWARD_IN_OURS = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])


def opengl_pose(index: int) -> F64:
    """At x = index, 1.5 m above the floor (y), no turn."""
    pose = np.eye(4)
    pose[:3, 3] = [index, 1.5, 4.0]
    return pose


@pytest.fixture
def walk(tmp_path: Path, write_rgb, write_depth) -> Path:
    folder = tmp_path / "00824-Dd4bFSTQ8gi"
    (folder / "pose").mkdir(parents=True)
    for index in range(3):
        name = f"Dd4bFSTQ8gi_{index:06d}"
        write_rgb(folder / "rgb" / f"{name}.png", seed=index)
        write_depth(folder / "depth" / f"{name}.png", 2000 + index)
        row = " ".join(f"{value:.6f}" for value in opengl_pose(index).ravel())
        (folder / "pose" / f"{name}.txt").write_text(row + "\n")
    return folder


@pytest.fixture
def episode(tmp_path: Path, write_rgb, write_depth) -> Path:
    folder = tmp_path / "002-hm3d-wcojb4TFT35"
    for index in range(3):
        write_rgb(folder / f"{index:05d}-rgb.png", seed=index)
        write_depth(folder / f"{index:05d}-depth.png", 6553)
        np.savetxt(folder / f"{index:05d}.txt", opengl_pose(index))
    k = np.eye(4)
    k[[0, 1, 0, 1], [0, 1, 2, 2]] = (40, 40, 32, 24)
    np.savetxt(folder / "intrinsic_color.txt", k)
    return folder


@pytest.mark.parametrize("layout", ["hm3d", "openeqa"])
def test_the_world_is_turned_z_up_and_the_camera_looks_forward(
    walk: Path, episode: Path, layout: str
) -> None:
    recording = open_recording(walk if layout == "hm3d" else episode, layout)
    pose = recording.load(2).world_from_camera
    np.testing.assert_allclose(pose[:3, 3], [2, -4, 1.5], atol=1e-9)
    np.testing.assert_allclose(pose[:3, :3], FORWARD_IN_OURS, atol=1e-9)
    np.testing.assert_allclose(recording.world_from_source[:3, :3] @ [0, 1, 0], [0, 0, 1], atol=1e-12)


def test_a_walk_is_seen_at_ninety_degrees_unless_told_otherwise(walk: Path) -> None:
    recording = open_recording(walk, "hm3d")
    assert astuple(recording.intrinsics) == pytest.approx((32, 32, 31.5, 23.5, 64, 48))
    assert recording.depth_scale == 1000
    assert recording.notes == ("no intrinsics on disk: used fx = fy = 32 by hfov",)
    wide = open_recording(walk, "hm3d", options={"hfov": "120"})
    assert wide.intrinsics.fx == pytest.approx(32 / np.tan(np.radians(60)))


def test_an_episode_brings_its_camera(episode: Path) -> None:
    recording = open_recording(episode, "openeqa")
    assert recording.intrinsics == Intrinsics(40, 40, 32, 24, 64, 48)
    assert recording.depth_scale == 6553.5
    assert recording.names() == ("00000", "00001", "00002")


@pytest.mark.parametrize("degrees", ["wide", "0", "180"])
def test_a_view_that_cannot_be_is_an_error(walk: Path, degrees: str) -> None:
    with pytest.raises(InvalidInput, match="option hfov: expected"):
        open_recording(walk, "hm3d", options={"hfov": degrees})


def test_a_frame_without_its_pose_is_skipped(walk: Path, episode: Path) -> None:
    (walk / "pose" / "Dd4bFSTQ8gi_000001.txt").unlink()
    assert [frame.reason for frame in open_recording(walk, "hm3d").skipped] == ["no pose"]
    (episode / "00001-depth.png").unlink()
    assert [frame.reason for frame in open_recording(episode, "openeqa").skipped] == ["no depth image"]


def test_poses_under_other_names_are_an_error(walk: Path) -> None:
    for index, path in enumerate(sorted((walk / "pose").iterdir())):
        path.rename(walk / "pose" / f"{index}.txt")
    with pytest.raises(InvalidInput, match=r"expected a pose named as its image \(Dd4bFSTQ8gi_000000\.txt\)"):
        open_recording(walk, "hm3d")


@pytest.mark.parametrize(("layout", "other"), [("hm3d", "openeqa"), ("openeqa", "hm3d")])
def test_a_wrong_folder_is_told_the_right_layout(walk: Path, episode: Path, layout: str, other: str) -> None:
    folder = walk if layout == "hm3d" else episode
    with pytest.raises(InvalidInput, match=rf"expected layout {other} .*This looks like layout {layout}\."):
        open_recording(folder, other)
