"""Layout `replica`: Replica as rendered for NICE-SLAM and iMAP.

SCENE/results/frameNNNNNN.jpg and depthNNNNNN.png; SCENE/traj.txt; ../cam_params.json. Depth: uint16, `scale`
units a metre (6553.5), 0 = none. Pose: line NNNNNN of traj.txt, 16 numbers row-major world_from_camera,
camera x right, y down, z forward, as it is. World: z up. Time: 30 Hz by the frame's number.
"""

from __future__ import annotations

import re
from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.layout import NO_OPTIONS, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile
from ovip.recordings.text import depth_scale_of, intrinsics_of, natural, read_json, read_pose_lines
from ovip.recordings.up import Up
from ovip.scene.types import F64, Intrinsics

DEPTH_SCALE = 6553.5
DOCUMENTED = Intrinsics(600.0, 600.0, 599.5, 339.5, 1200, 680)
FRAME_NS = 1_000_000_000 / 30
_FRAME = re.compile(r"^frame(\d+)\.(jpg|jpeg|png)$", re.IGNORECASE)


class Replica:
    """Reads NICE-SLAM's render of Replica."""

    name = "replica"
    expects = (
        "results/frameNNNNNN.jpg, results/depthNNNNNN.png, traj.txt, and cam_params.json in the folder above"
    )
    options = NO_OPTIONS
    up: Up = None

    def fits(self, folder: Path) -> bool:
        return (folder / "traj.txt").is_file() or any((folder / "results").glob("frame*"))

    def read(self, folder: Path, options: Options) -> Contents:
        results = folder / "results"
        if not results.is_dir():
            raise InvalidInput(
                f"{folder}: expected a folder results/ with frameNNNNNN.jpg and depthNNNNNN.png, got none"
            )
        colors = sorted(
            (path for path in results.iterdir() if _FRAME.match(path.name)), key=lambda p: natural(p.name)
        )
        if not colors:
            raise InvalidInput(f"{results}: expected images frameNNNNNN.jpg, got none")
        poses = read_pose_lines(folder / "traj.txt")
        frames = tuple(_frame(path, poses, folder) for path in colors)
        intrinsics, scale, notes = _camera(folder)
        return Contents(intrinsics, scale, frames, notes=notes)


def _frame(color: Path, poses: list[F64], folder: Path) -> ListedFrame:
    match = _FRAME.match(color.name)
    assert match is not None
    number = int(match[1])
    if number >= len(poses):
        raise InvalidInput(
            f"{folder / 'traj.txt'}: expected a pose a line, line {number + 1} for {color.name}, "
            f"got {len(poses)} lines"
        )
    depth = color.with_name(f"depth{match[1]}.png")
    return ListedFrame(
        name=color.stem,
        timestamp_ns=round(number * FRAME_NS),
        pose=poses[number],
        rgb=ImageFile(color),
        depth=ImageFile(depth) if depth.exists() else None,
    )


def _camera(folder: Path) -> tuple[Intrinsics, float, tuple[str, ...]]:
    for path in (folder.resolve().parent / "cam_params.json", folder / "cam_params.json"):
        if path.exists():
            camera = read_json(path).get("camera")
            if not isinstance(camera, dict):
                raise InvalidInput(
                    f'{path}: expected {{"camera": {{w, h, fx, fy, cx, cy, scale}}}}, got {camera!r}'
                )
            return intrinsics_of(camera, path, "w", "h"), depth_scale_of(camera, "scale", path), ()
    note = (
        "no cam_params.json in the folder above: used the render's documented 1200x680, fx = fy = 600, "
        "cx 599.5, cy 339.5, depth 6553.5 units a metre"
    )
    return DOCUMENTED, DEPTH_SCALE, (note,)
