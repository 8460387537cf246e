"""Layout `record3d`: recordings of the Record3D app on an iPhone or iPad, unpacked as ConceptGraphs does.

rgb/N.png, depth/N.png (both at the size that dataconfig.yaml says), conf/N.npy (0 low, 1 middle, 2 high),
poses/N.npy, dataconfig.yaml. Depth: uint16, png_depth_scale units a metre (1000), 0 = none; what is less sure
than option confidence (2) is left out, by conf/ or, where it lies ready, high_conf_depth/. Pose: ARKit's 4x4
world_from_camera of an OpenGL camera (x right, y up, z back), turned here. World: y up. Time: not kept; 30
frames a second by number. A .r3d archive itself packs depth as LZFSE, for which Python has no maintained
library: it must be unpacked first.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.images import decode_raw_depth
from ovip.recordings.layout import OPENGL_FROM_OPENCV, Contents, ImageSource, ListedFrame, Options
from ovip.recordings.sources import ImageFile, MadeDepth, images_in
from ovip.recordings.text import checked, read_text
from ovip.recordings.up import Up
from ovip.scene.types import F64, U16, Intrinsics

FRAME_NS = 1_000_000_000 / 30
SUREST = 2
OPTIONS = {"confidence": f"least confidence of a depth value that is used: 0, 1 or 2 ({SUREST})"}
_LINE = re.compile(r"^\s*(\w+)\s*:\s*([-+.\deE]+)\s*(?:#.*)?$", re.MULTILINE)


class Record3d:
    """Reads unpacked recordings of Record3D."""

    name = "record3d"
    expects = "rgb/N.png, depth/N.png, poses/N.npy and dataconfig.yaml (an unpacked .r3d)"
    options: Options = OPTIONS
    up: Up = (0.0, 1.0, 0.0)

    def fits(self, path: Path) -> bool:
        exported = (path / "rgb").is_dir() and any((path / "poses").glob("*.npy"))
        return exported or path.suffix == ".r3d" or (path / "rgbd").is_dir()

    def read(self, path: Path, options: Options) -> Contents:
        if path.is_file() or (path / "rgbd").is_dir():
            raise InvalidInput(
                f"{path}: a .r3d archive packs its depth as LZFSE, which is not read here; unpack it first, for "
                f"example by ConceptGraphs' preprocess_r3d_file.py, into {self.expects}"
            )
        intrinsics, scale = _camera(path / "dataconfig.yaml")
        least = _confidence(options)
        source, note = _depth_source(path, least, (intrinsics.width, intrinsics.height))
        frames = tuple(
            _frame(index, color, path, source) for index, color in enumerate(images_in(path / "rgb"))
        )
        return Contents(intrinsics, scale, frames, notes=(note,) if note else ())


DepthOf = Callable[[str], ImageSource | None]


def _depth_source(folder: Path, least: int, size: tuple[int, int]) -> tuple[DepthOf, str]:
    """Where a frame's depth comes from, by its name, and a word on it for the user."""
    plain, ready, conf = folder / "depth", folder / "high_conf_depth", folder / "conf"
    if least == SUREST and ready.is_dir():
        return lambda name: _file(ready / f"{name}.png"), ""
    if least == 0 or not conf.is_dir():
        note = "" if least == 0 else "no conf/: depth of every confidence is used"
        return lambda name: _file(plain / f"{name}.png"), note
    return lambda name: _sure(plain / f"{name}.png", conf / f"{name}.npy", least, size), ""


def _file(path: Path) -> ImageSource | None:
    return ImageFile(path) if path.exists() else None


def _sure(depth: Path, conf: Path, least: int, size: tuple[int, int]) -> ImageSource | None:
    def load() -> U16:
        raw = decode_raw_depth(ImageFile(depth).read())
        sure = _array(conf)
        if raw is None or sure.shape != raw.shape:
            raise InvalidInput(
                f"{depth}: expected a 16-bit PNG of the same size as {conf.name} {sure.shape}, got another"
            )
        return np.where(sure >= least, raw, 0).astype(np.uint16)

    return MadeDepth(str(depth), size, load) if depth.exists() and conf.exists() else None


def _frame(index: int, color: Path, folder: Path, depth_of: DepthOf) -> ListedFrame:
    pose = folder / "poses" / f"{color.stem}.npy"
    number = int(color.stem) if color.stem.isdecimal() else index
    return ListedFrame(
        name=color.stem,
        timestamp_ns=round(number * FRAME_NS),
        pose=_pose(pose) if pose.exists() else None,
        rgb=ImageFile(color),
        depth=depth_of(color.stem),
    )


def _pose(path: Path) -> F64:
    pose = _array(path).astype(np.float64)
    if pose.shape != (4, 4):
        raise InvalidInput(f"{path}: expected a 4x4 pose, got an array of shape {pose.shape}")
    return np.asarray(pose @ np.diag(OPENGL_FROM_OPENCV))


def _array(path: Path) -> F64:
    try:
        array = np.load(path, allow_pickle=False)
    except (OSError, EOFError, ValueError) as error:
        raise InvalidInput(f"{path}: expected a NumPy array, got: {error}") from error
    return np.asarray(array)


def _camera(path: Path) -> tuple[Intrinsics, float]:
    values = {key: _float(word, path) for key, word in _LINE.findall(read_text(path))}
    wanted = ("fx", "fy", "cx", "cy", "image_width", "image_height")
    missing = [key for key in wanted if key not in values]
    if missing:
        raise InvalidInput(
            f"{path}: expected camera_params with {', '.join(wanted)}, got no {', '.join(missing)}"
        )
    fx, fy, cx, cy, width, height = (values[key] for key in wanted)
    return checked(Intrinsics(fx, fy, cx, cy, int(width), int(height)), path), values.get(
        "png_depth_scale", 1000.0
    )


def _float(word: str, path: Path) -> float:
    try:
        return float(word)
    except ValueError as error:
        raise InvalidInput(f"{path}: expected a number, got {word!r}") from error


def _confidence(options: Options) -> int:
    word = options.get("confidence", str(SUREST))
    if word not in {"0", "1", "2"}:
        raise InvalidInput(f"option confidence: expected 0, 1 or 2, got {word!r}")
    return int(word)
