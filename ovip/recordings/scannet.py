"""Layout `scannet`: ScanNet as its exporter writes it; also NICE-SLAM's form, with all of it in frames/.

color/N.jpg (1296x968), depth/N.png (640x480), pose/N.txt, intrinsic/intrinsic_{color,depth}.txt; N = 0, 1, .. 10.
Depth: uint16 millimetres, 0 = none. Pose: 4x4 world_from_camera, camera x right, y down, z forward; -inf where
tracking was lost. World: z up. Time: N at 30 Hz. Colour is brought to the size of the depth image when it is
read, and the depth camera's intrinsics hold for both (the two cameras differ by less than a pixel there).
"""

from __future__ import annotations

from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.images import ImageHeader, read_header
from ovip.recordings.layout import NO_OPTIONS, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile, ResizedColor, first_header, images_in
from ovip.recordings.text import intrinsics_of_matrix, read_matrix
from ovip.recordings.up import Up
from ovip.scene.types import Intrinsics

DEPTH_SCALE = 1000.0
FRAME_NS = 1_000_000_000 / 30


class ScanNet:
    """Reads an exported ScanNet scan."""

    name = "scannet"
    expects = "color/N.jpg, depth/N.png, pose/N.txt and intrinsic/intrinsic_depth.txt, here or in frames/"
    options = NO_OPTIONS
    up: Up = None

    def fits(self, folder: Path) -> bool:
        root = _root(folder)
        return (root / "color").is_dir() and (root / "intrinsic").is_dir()

    def read(self, folder: Path, options: Options) -> Contents:
        root = _root(folder)
        colors = [path for path in images_in(root / "color") if path.stem.isdecimal()]
        if not colors:
            raise InvalidInput(f"{root / 'color'}: expected images named by their number (0.jpg), got none")
        size = first_header(images_in(root / "depth"))
        frames = tuple(_frame(path, root, size) for path in colors)
        if all(frame.pose is None for frame in frames):
            raise InvalidInput(f"{root / 'pose'}: expected a pose N.txt for each image, got none")
        intrinsics, notes = _camera(root, size, colors)
        return Contents(intrinsics, DEPTH_SCALE, frames, notes=notes)


def _root(folder: Path) -> Path:
    return folder / "frames" if (folder / "frames").is_dir() else folder


def _frame(color: Path, root: Path, size: ImageHeader) -> ListedFrame:
    depth, pose = root / "depth" / f"{color.stem}.png", root / "pose" / f"{color.stem}.txt"
    own = read_header(color)
    fits = own is None or (own.width, own.height) == (size.width, size.height)
    return ListedFrame(
        name=color.stem,
        timestamp_ns=round(int(color.stem) * FRAME_NS),
        pose=read_matrix(pose, 4, 4) if pose.exists() else None,
        rgb=ImageFile(color) if fits else ResizedColor(color, size.width, size.height),
        depth=ImageFile(depth) if depth.exists() else None,
    )


def _camera(root: Path, size: ImageHeader, colors: list[Path]) -> tuple[Intrinsics, tuple[str, ...]]:
    color = first_header(colors)
    notes: tuple[str, ...] = ()
    if (color.width, color.height) != (size.width, size.height):
        sizes = f"{color.width}x{color.height} is brought to the depth image's {size.width}x{size.height}"
        notes = (f"colour of {sizes}, with the depth camera's intrinsics",)
    own = root / "intrinsic" / "intrinsic_depth.txt"
    if own.exists():
        return intrinsics_of_matrix(own, size.width, size.height), notes
    k = intrinsics_of_matrix(root / "intrinsic" / "intrinsic_color.txt", color.width, color.height)
    x, y = size.width / color.width, size.height / color.height
    scaled = Intrinsics(
        k.fx * x, k.fy * y, (k.cx + 0.5) * x - 0.5, (k.cy + 0.5) * y - 0.5, size.width, size.height
    )
    return scaled, (*notes, "no intrinsic/intrinsic_depth.txt: used the colour camera's, scaled")
