"""Layout `ovip`: our own folder form, read and written here.

rgb/NNNNNN.jpg (or .png), depth/NNNNNN.png, poses.txt, intrinsics.json {"fx", "fy", "cx", "cy", "width",
"height", "depth_scale"}; where there are some, timestamps.txt and detections/NNNNNN.json (what the robot saw
on board). Depth: uint16 z-depth, `depth_scale` units a metre (1000 where not said), 0 = none. Pose: line
NNNNNN of poses.txt, counted from 0, 16 numbers row-major world_from_camera, camera x right, y down, z
forward. World: z up. Time: line NNNNNN of timestamps.txt, whole nanoseconds; without it 10 frames a second.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ovip.errors import InvalidInput
from ovip.recordings.frames import RecordedFrame
from ovip.recordings.layout import NO_OPTIONS, Contents, ListedFrame, Options
from ovip.recordings.onboard import write_onboard
from ovip.recordings.sources import ImageFile
from ovip.recordings.text import (
    data_lines,
    depth_scale_of,
    intrinsics_of,
    natural,
    read_json,
    read_pose_lines,
)
from ovip.recordings.up import Up
from ovip.scene.types import F64, Intrinsics

DEPTH_SCALE = 1000.0
FRAME_NS = 100_000_000
_IMAGE = re.compile(r"^(\d+)\.(jpg|jpeg|png)$", re.IGNORECASE)


class OvipFolder:
    """Reads our own folder form."""

    name = "ovip"
    expects = "rgb/NNNNNN.jpg, depth/NNNNNN.png, poses.txt (16 numbers a line) and intrinsics.json"
    options = NO_OPTIONS
    up: Up = None

    def fits(self, folder: Path) -> bool:
        return (folder / "rgb").is_dir() and (
            (folder / "poses.txt").is_file() or (folder / "intrinsics.json").is_file()
        )

    def read(self, folder: Path, options: Options) -> Contents:
        colors = sorted(
            (p for p in (folder / "rgb").iterdir() if _IMAGE.match(p.name)), key=lambda p: natural(p.name)
        )
        if not colors:
            raise InvalidInput(f"{folder / 'rgb'}: expected images NNNNNN.jpg or .png, got none")
        camera = folder / "intrinsics.json"
        values = read_json(camera)
        scale = depth_scale_of(values, "depth_scale", camera) if "depth_scale" in values else DEPTH_SCALE
        poses = read_pose_lines(folder / "poses.txt")
        times = _read_times(folder / "timestamps.txt", len(poses))
        return Contents(
            intrinsics_of(values, camera), scale, tuple(_frame(path, folder, poses, times) for path in colors)
        )


def write_folder(folder: Path, intrinsics: Intrinsics, frames: Iterable[RecordedFrame]) -> int:
    """Writes `frames` as a new recording, numbered from 0 in the order given, and returns how many.

    `folder` must not hold a recording yet; the frames must share one depth scale.
    """
    if (folder / "poses.txt").exists():
        raise InvalidInput(f"{folder}: expected a folder without a recording, got one that has a poses.txt")
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    poses, times, scales = [], [], set()
    for number, frame in enumerate(frames):
        _write_images(folder, f"{number:06d}", frame)
        poses.append(" ".join(f"{value:.17g}" for value in frame.world_from_camera.ravel()))
        times.append(str(frame.timestamp_ns))
        scales.add(frame.depth_scale)
    if len(scales) > 1:
        raise InvalidInput(f"{folder}: expected frames of one depth scale, got {sorted(scales)}")
    camera = {name: getattr(intrinsics, name) for name in ("fx", "fy", "cx", "cy", "width", "height")}
    camera["depth_scale"] = scales.pop() if scales else DEPTH_SCALE
    (folder / "intrinsics.json").write_text(json.dumps(camera, indent=1) + "\n", encoding="utf-8")
    (folder / "timestamps.txt").write_text("".join(f"{time}\n" for time in times), encoding="utf-8")
    (folder / "poses.txt").write_text("".join(f"{pose}\n" for pose in poses), encoding="utf-8")
    return len(poses)


@contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """A folder beside `folder` to write a recording into; it gets that name once all of it is written.

    What an interrupted run left there is thrown away. Raises InvalidInput where `folder` holds anything already.
    """
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise InvalidInput(f"{folder}: expected a folder that does not exist yet or is empty, got one in use")
    partial = folder.with_name(f".{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    try:
        partial.mkdir(parents=True)
        yield partial
        if folder.exists():
            folder.rmdir()
        partial.rename(folder)
    except OSError as error:
        raise InvalidInput(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _frame(color: Path, folder: Path, poses: list[F64], times: list[int]) -> ListedFrame:
    number = int(color.stem)
    if number >= len(poses):
        raise InvalidInput(
            f"{folder / 'poses.txt'}: expected a pose a line, line {number + 1} for {color.name}, "
            f"got {len(poses)} lines"
        )
    depth = folder / "depth" / f"{color.stem}.png"
    onboard = folder / "detections" / f"{color.stem}.json"
    return ListedFrame(
        name=color.stem,
        timestamp_ns=times[number],
        pose=poses[number],
        rgb=ImageFile(color),
        depth=ImageFile(depth) if depth.exists() else None,
        onboard=onboard if onboard.exists() else None,
    )


def _read_times(path: Path, count: int) -> list[int]:
    if not path.exists():
        return [number * FRAME_NS for number in range(count)]
    lines = data_lines(path)
    if len(lines) != count:
        raise InvalidInput(f"{path}: expected a time for each of the {count} poses, got {len(lines)}")
    wrong = next(((line, text) for line, text in lines if not text.isdecimal()), None)
    if wrong is not None:
        raise InvalidInput(f"{path} line {wrong[0]}: expected whole nanoseconds, got {wrong[1]!r}")
    return [int(text) for _, text in lines]


def _write_images(folder: Path, name: str, frame: RecordedFrame) -> None:
    extension = "jpg" if frame.rgb_encoding == "jpeg" else "png"
    (folder / "rgb" / f"{name}.{extension}").write_bytes(frame.rgb_bytes)
    (folder / "depth" / f"{name}.png").write_bytes(frame.depth_bytes)
    if frame.onboard is not None:
        (folder / "detections").mkdir(exist_ok=True)
        write_onboard(folder / "detections" / f"{name}.json", frame.onboard)
