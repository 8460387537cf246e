"""Layout `7scenes`: 7-Scenes and 3DMatch as tsdf-fusion packs them, one flat folder of frame-NNNNNN.* files.

Depth: uint16 millimetres; 0 and 65535 mean "no measurement". Pose: frame-NNNNNN.pose.txt, 4x4
world_from_camera, camera x right, y down, z forward. World: the first camera's or any other frame, NOT z-up.
Time: the frame's number at 30 Hz. Intrinsics: camera-intrinsics.txt, 3x3, for the size of the images.
"""

from __future__ import annotations

import re
from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.layout import NO_OPTIONS, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile, first_header
from ovip.recordings.text import intrinsics_of_matrix, natural, read_matrix
from ovip.recordings.up import Up
from ovip.scene.types import Intrinsics

DEPTH_SCALE = 1000.0
INVALID_DEPTH = 65535
FRAME_NS = 1_000_000_000 / 30
_COLOR = re.compile(r"^(frame-(\d+))\.color\.(jpg|jpeg|png)$", re.IGNORECASE)


class SevenScenes:
    """Reads the tsdf-fusion form of 7-Scenes."""

    name = "7scenes"
    expects = (
        "frame-NNNNNN.color.jpg (or .png), frame-NNNNNN.depth.png, frame-NNNNNN.pose.txt and "
        "camera-intrinsics.txt"
    )
    options = NO_OPTIONS
    up: Up = "auto"

    def fits(self, folder: Path) -> bool:
        return any(folder.glob("frame-*.pose.txt")) or any(folder.glob("frame-*.color.*"))

    def read(self, folder: Path, options: Options) -> Contents:
        colors = sorted(
            (path for path in folder.iterdir() if _COLOR.match(path.name)), key=lambda p: natural(p.name)
        )
        if not colors:
            raise InvalidInput(f"{folder}: expected colour images frame-NNNNNN.color.jpg or .png, got none")
        frames = tuple(_frame(path) for path in colors)
        if all(frame.pose is None for frame in frames):
            raise InvalidInput(f"{folder}: expected a frame-NNNNNN.pose.txt beside each image, got none")
        return Contents(_intrinsics(folder, colors), DEPTH_SCALE, frames, invalid_depth=INVALID_DEPTH)


def _frame(color: Path) -> ListedFrame:
    match = _COLOR.match(color.name)
    assert match is not None
    name, number = match[1], int(match[2])
    pose, depth = color.with_name(f"{name}.pose.txt"), color.with_name(f"{name}.depth.png")
    return ListedFrame(
        name=name,
        timestamp_ns=round(number * FRAME_NS),
        pose=read_matrix(pose, 4, 4) if pose.exists() else None,
        rgb=ImageFile(color),
        depth=ImageFile(depth) if depth.exists() else None,
    )


def _intrinsics(folder: Path, colors: list[Path]) -> Intrinsics:
    path = folder / "camera-intrinsics.txt"
    if not path.exists():
        raise InvalidInput(
            f"{folder}: expected camera-intrinsics.txt (3x3 K in pixels). The zips of 7-Scenes itself "
            "come without: write '585 0 320 / 0 585 240 / 0 0 1' on three lines"
        )
    header = first_header(colors)
    found = intrinsics_of_matrix(path, header.width, header.height)
    if not (0.3 < found.cx / found.width < 0.7 and 0.3 < found.cy / found.height < 0.7):
        raise InvalidInput(
            f"{path}: expected intrinsics for the {found.width}x{found.height} images, got a principal point "
            f"({found.cx:g}, {found.cy:g}) far from their middle"
        )
    return found
