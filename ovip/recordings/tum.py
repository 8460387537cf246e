"""Layout `tum`: TUM RGB-D; lists of time-stamped images and a motion-capture trajectory.

Depth: uint16, 5000 units a metre, 0 = none, registered to colour. Pose: groundtruth.txt, 'timestamp tx ty tz
qx qy qz qw', world_from_camera, camera x right, y down, z forward. World: z up. Time: the colour image's,
seconds since the epoch. Images and poses are matched by nearest time, at most 0.02 s apart, as the dataset's
associate.py does. Intrinsics: the dataset has no file; intrinsics.json in the folder wins, else the published
ones of its camera.
"""

from __future__ import annotations

import re
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.layout import NO_OPTIONS, Contents, ListedFrame, Options
from ovip.recordings.sources import ImageFile
from ovip.recordings.text import data_lines, depth_scale_of, intrinsics_of, parse_numbers, read_json
from ovip.recordings.up import Up
from ovip.scene.types import F64, I64, Intrinsics

DEPTH_SCALE = 5000.0
MAX_DT_NS = 20_000_000
# fx, fy, cx, cy as published with the dataset, for 640x480; lens distortion is not undone.
PUBLISHED = {
    "freiburg1": (517.3, 516.5, 318.6, 255.3),
    "freiburg2": (520.9, 521.0, 325.1, 249.7),
    "freiburg3": (535.4, 539.2, 320.1, 247.6),
}
ROS_DEFAULT = (525.0, 525.0, 319.5, 239.5)


class Tum:
    """Reads TUM RGB-D sequences."""

    name = "tum"
    expects = (
        "rgb.txt, depth.txt and groundtruth.txt ('timestamp file' or 'timestamp tx ty tz qx qy qz qw' a line)"
    )
    options = NO_OPTIONS
    up: Up = None

    def fits(self, folder: Path) -> bool:
        lists = ("rgb.txt", "depth.txt", "groundtruth.txt")
        return sum((folder / name).is_file() for name in lists) >= 2

    def read(self, folder: Path, options: Options) -> Contents:
        rgb, depth = _read_list(folder / "rgb.txt"), _read_list(folder / "depth.txt")
        pose_times, poses = _read_trajectory(folder / "groundtruth.txt")
        rgb_times = np.array([time for time, _ in rgb], dtype=np.int64)
        depth_of = associate(rgb_times, np.array([time for time, _ in depth], dtype=np.int64), MAX_DT_NS)
        pose_of = nearest(rgb_times, pose_times, MAX_DT_NS)
        frames = tuple(
            ListedFrame(
                name=name,
                timestamp_ns=time,
                pose=poses[p] if p >= 0 else None,
                rgb=ImageFile(folder / name),
                depth=ImageFile(folder / depth[d][1]) if d >= 0 else None,
            )
            for (time, name), d, p in zip(rgb, depth_of.tolist(), pose_of.tolist(), strict=True)
        )
        if all(frame.depth is None or frame.pose is None for frame in frames):
            raise InvalidInput(
                f"{folder}: expected depth images and poses within {MAX_DT_NS / 1e9} s of the colour images, "
                "got none (are the three lists of one sequence?)"
            )
        intrinsics, scale, notes = _camera(folder, frames)
        return Contents(intrinsics, scale, frames, notes=notes)


def associate(times: I64, others: I64, max_dt: int) -> I64:
    """For each of `(N,)` times the index of its partner among `(M,)` others, each used once; -1 = none.

    Closest pairs are taken first, within `max_dt`; ties go to the earlier time, then the earlier partner.
    """
    order = np.argsort(others, kind="stable")
    low = np.searchsorted(others[order], times - max_dt, side="left")
    high = np.searchsorted(others[order], times + max_dt, side="right")
    pairs = [
        (abs(int(others[j]) - int(times[i])), i, int(j))
        for i in range(len(times))
        for j in order[low[i] : high[i]]
    ]
    partner = np.full(len(times), -1, dtype=np.int64)
    taken: set[int] = set()
    for _, i, j in sorted(pairs):
        if partner[i] < 0 and j not in taken:
            partner[i] = j
            taken.add(j)
    return partner


def nearest(times: I64, others: I64, max_dt: int) -> I64:
    """For each of `(N,)` times the index of the nearest of `(M,)` rising others, -1 beyond `max_dt`."""
    if len(others) == 0:
        return np.full(len(times), -1, dtype=np.int64)
    right = np.clip(np.searchsorted(others, times), 0, len(others) - 1)
    left = np.maximum(right - 1, 0)
    best = np.where(np.abs(others[left] - times) <= np.abs(others[right] - times), left, right)
    return np.where(np.abs(others[best] - times) <= max_dt, best, -1).astype(np.int64)


def pose_of_quaternion(numbers: F64) -> F64:
    """tx ty tz qx qy qz qw `(7,)` -> `(4, 4)`; all NaN where the quaternion has no length."""
    length = float(np.linalg.norm(numbers[3:]))
    if not np.isfinite(numbers).all() or length < 1e-6:
        return np.full((4, 4), np.nan)
    x, y, z, w = numbers[3:] / length
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = numbers[:3]
    return pose


def _read_list(path: Path) -> list[tuple[int, str]]:
    """Time in nanoseconds and file name of each line, in order of time."""
    found = []
    for line, text in data_lines(path):
        words = text.split(maxsplit=1)
        if len(words) != 2:
            raise InvalidInput(f"{path} line {line}: expected 'timestamp file', got {text!r}")
        found.append((_nanoseconds(words[0], f"{path} line {line}"), words[1]))
    if not found:
        raise InvalidInput(f"{path}: expected lines 'timestamp file', got none")
    return sorted(found)


def _read_trajectory(path: Path) -> tuple[I64, list[F64]]:
    rows = []
    for line, text in data_lines(path):
        words = text.split()
        if len(words) != 8:
            raise InvalidInput(f"{path} line {line}: expected 'timestamp tx ty tz qx qy qz qw', got {text!r}")
        where = f"{path} line {line}"
        rows.append(
            (_nanoseconds(words[0], where), pose_of_quaternion(parse_numbers(" ".join(words[1:]), where)))
        )
    if not rows:
        raise InvalidInput(f"{path}: expected poses 'timestamp tx ty tz qx qy qz qw', got none")
    rows.sort(key=lambda row: row[0])
    return np.array([time for time, _ in rows], dtype=np.int64), [pose for _, pose in rows]


def _nanoseconds(word: str, where: str) -> int:
    try:
        return int(Decimal(word).scaleb(9).to_integral_value())
    except (InvalidOperation, ValueError, OverflowError) as error:
        raise InvalidInput(f"{where}: expected a time in seconds, got {word!r}") from error


def _camera(folder: Path, frames: tuple[ListedFrame, ...]) -> tuple[Intrinsics, float, tuple[str, ...]]:
    own = folder / "intrinsics.json"
    if own.exists():
        values = read_json(own)
        scale = depth_scale_of(values, "depth_scale", own) if "depth_scale" in values else DEPTH_SCALE
        return intrinsics_of(values, own), scale, ()
    headers = (frame.rgb.header() for frame in frames if frame.rgb)
    header = next((found for found in headers if found), None)
    if header is not None and (header.width, header.height) != (640, 480):
        raise InvalidInput(
            f"{folder}: expected 640x480 images (the size of the published intrinsics), "
            f"got {header.width}x{header.height}; "
            'put an intrinsics.json {"fx", "fy", "cx", "cy", "width", "height"} into the folder'
        )
    match = re.search(r"(?:freiburg|fr)([123])(?!\d)", folder.resolve().name.lower())
    camera = f"freiburg{match[1]}" if match else ""
    numbers = PUBLISHED.get(camera, ROS_DEFAULT)
    source = (
        f"published for {camera}"
        if camera
        else "of the dataset's ROS default (the folder's name has no freiburg1-3)"
    )
    return (
        Intrinsics(*numbers, 640, 480),
        DEPTH_SCALE,
        (f"no intrinsics.json: used fx, fy, cx, cy {numbers}, {source}",),
    )
