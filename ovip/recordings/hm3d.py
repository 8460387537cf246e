"""Layout `hm3d`: walks rendered by Habitat through HM3D-Semantics, as HOV-SG makes them.

SCENE/rgb/NAME.png, depth/NAME.png, pose/NAME.txt, one name in all three. Depth: uint16 millimetres, 0 = none.
Pose: 16 numbers row-major world_from_camera of an OpenGL camera (x right, y up, z back), turned here. World:
y up. Intrinsics: none on disk; a horizontal view of 90 degrees (option hfov), square pixels, so fx = width / 2.
Time: not kept; ten frames a second by position.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.layout import OPENGL_FROM_OPENCV, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile, first_header, images_in
from ovip.recordings.text import parse_numbers, read_matrix
from ovip.recordings.up import Up
from ovip.scene.types import Intrinsics

DEPTH_SCALE = 1000.0
FRAME_NS = 100_000_000
HFOV = 90.0
OPTIONS = {"hfov": f"horizontal field of view in degrees ({HFOV:g})"}


class Hm3d:
    """Reads HOV-SG's walks through HM3D-Semantics."""

    name = "hm3d"
    expects = "rgb/NAME.png, depth/NAME.png and pose/NAME.txt (16 numbers), one name in all three"
    options: Options = OPTIONS
    up: Up = (0.0, 1.0, 0.0)

    def fits(self, folder: Path) -> bool:
        return (folder / "rgb").is_dir() and any((folder / "pose").glob("*.txt"))

    def read(self, folder: Path, options: Options) -> Contents:
        colors = images_in(folder / "rgb")
        frames = tuple(_frame(index, path, folder) for index, path in enumerate(colors))
        if all(frame.pose is None for frame in frames):
            raise InvalidInput(
                f"{folder / 'pose'}: expected a pose named as its image ({colors[0].stem}.txt), got none"
            )
        header = first_header(colors)
        k = pinhole(header.width, header.height, _hfov(options))
        return Contents(
            k, DEPTH_SCALE, frames, notes=(f"no intrinsics on disk: used fx = fy = {k.fx:g} by hfov",)
        )


def pinhole(width: int, height: int, hfov: float) -> Intrinsics:
    """A camera of square pixels that sees `hfov` degrees across, pixel centres at integers."""
    focal = width / 2 / math.tan(math.radians(hfov) / 2)
    return Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)


def _frame(index: int, color: Path, folder: Path) -> ListedFrame:
    depth, pose = folder / "depth" / f"{color.stem}.png", folder / "pose" / f"{color.stem}.txt"
    return ListedFrame(
        name=color.stem,
        timestamp_ns=index * FRAME_NS,
        pose=read_matrix(pose, 4, 4) @ np.diag(OPENGL_FROM_OPENCV) if pose.exists() else None,
        rgb=ImageFile(color),
        depth=ImageFile(depth) if depth.exists() else None,
    )


def _hfov(options: Options) -> float:
    word = options.get("hfov", str(HFOV))
    numbers = parse_numbers(word, "option hfov")
    if numbers.size != 1 or not 1 < numbers[0] < 179:
        raise InvalidInput(f"option hfov: expected degrees between 1 and 179, got {word!r}")
    return float(numbers[0])
