"""Layout `openeqa`: episodes of OpenEQA in HM3D, one flat folder.

NNNNN-rgb.png, NNNNN-depth.png, NNNNN.txt, intrinsic_color.txt. Depth: uint16, 6553.5 units a metre, 0 = none.
Pose: 4x4 world_from_camera of an OpenGL camera (x right, y up, z back), turned here. World: y up. Time: not
kept; ten frames a second by position. (OpenEQA's ScanNet episodes have this form too, but ScanNet's poses and
millimetres: read ScanNet's own export instead.)
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.layout import NO_OPTIONS, OPENGL_FROM_OPENCV, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile, first_header
from ovip.recordings.text import intrinsics_of_matrix, natural, read_matrix
from ovip.recordings.up import Up

DEPTH_SCALE = 6553.5
FRAME_NS = 100_000_000


class OpenEqa:
    """Reads OpenEQA's HM3D episodes."""

    name = "openeqa"
    expects = "NNNNN-rgb.png, NNNNN-depth.png, NNNNN.txt and intrinsic_color.txt"
    options = NO_OPTIONS
    up: Up = (0.0, 1.0, 0.0)

    def fits(self, folder: Path) -> bool:
        return any(folder.glob("*-rgb.png")) and (folder / "intrinsic_color.txt").is_file()

    def read(self, folder: Path, options: Options) -> Contents:
        colors = sorted(folder.glob("*-rgb.png"), key=lambda path: natural(path.name))
        frames = tuple(_frame(index, path) for index, path in enumerate(colors))
        if all(frame.pose is None for frame in frames):
            raise InvalidInput(f"{folder}: expected a pose NNNNN.txt beside each NNNNN-rgb.png, got none")
        header = first_header(colors)
        k = intrinsics_of_matrix(folder / "intrinsic_color.txt", header.width, header.height)
        return Contents(k, DEPTH_SCALE, frames)


def _frame(index: int, color: Path) -> ListedFrame:
    name = color.name.removesuffix("-rgb.png")
    depth, pose = color.with_name(f"{name}-depth.png"), color.with_name(f"{name}.txt")
    return ListedFrame(
        name=name,
        timestamp_ns=index * FRAME_NS,
        pose=read_matrix(pose, 4, 4) @ np.diag(OPENGL_FROM_OPENCV) if pose.exists() else None,
        rgb=ImageFile(color),
        depth=ImageFile(depth) if depth.exists() else None,
    )
