"""Tiny recordings in each layout, written as the datasets write them; 64x48 pixels."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.scene.types import F64

WIDTH, HEIGHT = 64, 48
DATA = Path(__file__).resolve().parents[5] / "shared" / "data"

WriteRgb = Callable[..., bytes]
WriteDepth = Callable[..., bytes]
Make = Callable[..., Path]


def _write_rgb(path: Path, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0) -> bytes:
    path.parent.mkdir(parents=True, exist_ok=True)
    image = np.random.default_rng(seed).integers(0, 255, (size[1], size[0], 3), dtype=np.uint8)
    path.write_bytes(cv2.imencode(path.suffix, image)[1].tobytes())
    return path.read_bytes()


def _write_depth(path: Path, value: int = 1500, size: tuple[int, int] = (WIDTH, HEIGHT)) -> bytes:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(".png", np.full((size[1], size[0]), value, np.uint16))[1].tobytes())
    return path.read_bytes()


def _pose(index: int) -> F64:
    """Looks along +y from x = index, 1.3 m high, upright."""
    pose = np.eye(4)
    pose[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    pose[:3, 3] = [index, 0, 1.3]
    return pose


def _row(pose: F64) -> str:
    return " ".join(f"{value:.9g}" for value in pose.ravel())


@pytest.fixture
def write_rgb() -> WriteRgb:
    return _write_rgb


@pytest.fixture
def write_depth() -> WriteDepth:
    return _write_depth


@pytest.fixture
def pose_at() -> Callable[[int], F64]:
    return _pose


@pytest.fixture
def kitchen() -> Path:
    return _data("kitchen")


@pytest.fixture
def small_house() -> Path:
    return _data("small_house")


def _data(name: str) -> Path:
    if not (DATA / name).is_dir():
        pytest.skip(f"../shared/data/{name} is not here: the test on this real recording was skipped")
    return DATA / name


@pytest.fixture
def sevenscenes(tmp_path: Path) -> Make:
    def make(numbers: tuple[int, ...] = (0, 4, 8)) -> Path:
        folder = tmp_path / "seven"
        folder.mkdir()
        (folder / "camera-intrinsics.txt").write_text("60 0 32\n0 60 24\n0 0 1\n")
        for index, number in enumerate(numbers):
            _write_rgb(folder / f"frame-{number:06d}.color.jpg", seed=number)
            _write_depth(folder / f"frame-{number:06d}.depth.png")
            text = "\n".join("\t".join(f"{value:e}" for value in row) for row in _pose(index))
            (folder / f"frame-{number:06d}.pose.txt").write_text(text + "\n")
        return folder

    return make


@pytest.fixture
def tum(tmp_path: Path) -> Make:
    def make(name: str = "rgbd_dataset_freiburg1_desk") -> Path:
        """Colour at 10.0, 10.1, 10.2 s; depth 5 ms later; poses every 10 ms, x = 10 * (t - 10)."""
        folder = tmp_path / name
        for step in range(3):
            _write_rgb(folder / "rgb" / f"{10 + step / 10:.6f}.png", (640, 480), seed=step)
            _write_depth(folder / "depth" / f"{10.005 + step / 10:.6f}.png", 5000, (640, 480))
        listed = [f"{10 + step / 10:.6f}" for step in range(3)]
        (folder / "rgb.txt").write_text("# color images\n" + "".join(f"{t} rgb/{t}.png\n" for t in listed))
        listed = [f"{10.005 + step / 10:.6f}" for step in range(3)]
        (folder / "depth.txt").write_text("# depth\n" + "".join(f"{t} depth/{t}.png\n" for t in listed))
        poses = [
            f"{9.9 + step / 100:.4f} {step / 10 - 1:.4f} 0 1.3 -0.7071068 0 0 0.7071068\n"
            for step in range(50)
        ]
        (folder / "groundtruth.txt").write_text("# timestamp tx ty tz qx qy qz qw\n" + "".join(poses))
        return folder

    return make


@pytest.fixture
def replica(tmp_path: Path) -> Make:
    def make(camera: bool = True, count: int = 3) -> Path:
        folder = tmp_path / "Replica" / "room0"
        size = (WIDTH, HEIGHT) if camera else (1200, 680)
        for index in range(count):
            _write_rgb(folder / "results" / f"frame{index:06d}.jpg", size, seed=index)
            _write_depth(folder / "results" / f"depth{index:06d}.png", 6553, size)
        (folder / "traj.txt").write_text("".join(_row(_pose(index)) + "\n" for index in range(count)))
        values = {"w": WIDTH, "h": HEIGHT, "fx": 60.0, "fy": 60.0, "cx": 31.5, "cy": 23.5, "scale": 6553.5}
        if camera:
            (folder.parent / "cam_params.json").write_text(json.dumps({"camera": values}))
        return folder

    return make


@pytest.fixture
def ovip_folder(tmp_path: Path) -> Make:
    def make(count: int = 4) -> Path:
        folder = tmp_path / "walk"
        for index in range(count):
            _write_rgb(folder / "rgb" / f"{index:06d}.jpg", seed=index)
            _write_depth(folder / "depth" / f"{index:06d}.png")
        (folder / "poses.txt").write_text("".join(_row(_pose(index)) + "\n" for index in range(count)))
        values = {"width": WIDTH, "height": HEIGHT, "fx": 60.0, "fy": 60.0, "cx": 31.5, "cy": 23.5}
        (folder / "intrinsics.json").write_text(json.dumps({**values, "depth_scale": 1000.0}))
        return folder

    return make
