"""A robot's walk through a world as a recording on disk (layout `ovip`), with the truth beside it.

Truth of a room: objects.json. Of a home: objects.json (object_id, label, attributes, structural, box, floor, area),
areas.json (storeys, rooms, functional areas), relations.json, visibility.json (per object: frames with >= 100 pixels,
best frame), instance/NNNNNN.png (uint16 object ids), true_poses.txt where the robot's own poses drift, and
ATTRIBUTION.txt.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from lab.simulation.detecting import Sight
from lab.simulation.home import Area, Home
from lab.simulation.room import SimulatedRoom
from lab.simulation.world import HomeWorld, World
from ovip.recordings import RecordedFrame, write_folder
from ovip.scene.types import F64, U8, U16

DEPTH_SCALE = 1000.0
JPEG_QUALITY = 95
START_NS = 1_700_000_000_000_000_000
STEP_NS = 100_000_000
VISIBLE_PIXELS = 100
_FARTHEST = 65.0  # metres that 16 bits of millimetres hold


def write_recording(folder: Path, room: SimulatedRoom, poses: Sequence[F64] | None = None) -> int:
    """Renders `poses` (the room's own walk where None) into `folder` and returns how many frames there are.

    The robot's own detections lie in detections/, the truth in objects.json: object_id, label, color,
    structural, aabb_low, aabb_high. The folder must not hold a recording yet.
    """
    frames = recorded_frames(room, room.walk() if poses is None else poses)
    count = write_folder(folder, room.intrinsics, frames)
    truth = [
        {
            "object_id": thing.object_id,
            "label": thing.label,
            "color": thing.color,
            "structural": thing.structural,
            **_corners(thing.box),
        }
        for thing in room.objects
    ]
    _write_json(folder / "objects.json", truth)
    return count


@dataclass(frozen=True, slots=True)
class Packing:
    """jpeg: quality of colour, 0 to 100. png: how hard depth is compressed, 0 to 9."""

    jpeg: int = JPEG_QUALITY
    png: int = 3


@dataclass(frozen=True, slots=True)
class HomeRecordingParams:
    """images: how they are packed. instances: whether instance/ is written."""

    images: Packing = Packing(png=9)
    instances: bool = True


def write_home_recording(
    folder: Path,
    world: HomeWorld,
    poses: Sequence[F64] | None = None,
    params: HomeRecordingParams | None = None,
) -> int:
    """Renders `poses` (the world's own walk where None) into `folder`, the truth beside; returns how many frames.

    The folder must not hold a recording yet.
    """
    params = params or HomeRecordingParams()
    true_poses = world.walk() if poses is None else list(poses)
    seen = _Seen(folder if params.instances else None)
    frames = recorded_frames(world, true_poses, 0, params.images, seen)
    count = write_folder(folder, world.intrinsics, frames)
    _write_home_truth(folder, world.home)
    _write_json(folder / "visibility.json", seen.visibility())
    if seen.drifted:
        lines = "".join(" ".join(f"{value:.17g}" for value in pose.ravel()) + "\n" for pose in true_poses)
        (folder / "true_poses.txt").write_text(lines, encoding="utf-8")
    return count


@dataclass(slots=True)
class _Seen:
    """Notes the truth of each frame as it passes: its ids, and which objects are visible in it."""

    folder: Path | None
    drifted: bool = False
    pixels: dict[int, dict[int, int]] = field(default_factory=dict)

    def note(self, index: int, sight: Sight, pose: F64) -> None:
        ids, counts = np.unique(sight.ids, return_counts=True)
        for object_id, count in zip(ids.tolist(), counts.tolist(), strict=True):
            if object_id and count >= VISIBLE_PIXELS:
                self.pixels.setdefault(object_id, {})[index] = count
        self.drifted |= not np.array_equal(sight.pose, pose)
        if self.folder is not None:
            (self.folder / "instance").mkdir(parents=True, exist_ok=True)
            path = self.folder / "instance" / f"{index:06d}.png"
            path.write_bytes(_encoded(".png", sight.ids, _png(9)))

    def visibility(self) -> dict[str, dict[str, int]]:
        return {
            str(object_id): {
                "frames": len(frames),
                "best_frame": max(frames, key=lambda index: frames[index]),
                "most_pixels": max(frames.values()),
            }
            for object_id, frames in sorted(self.pixels.items())
        }


def recorded_frames(
    world: World,
    poses: Sequence[F64],
    first: int = 0,
    packing: Packing | None = None,
    seen: _Seen | None = None,
) -> Iterator[RecordedFrame]:
    """What the robot sends from each true pose, ten frames a second: images and what it detected on board.

    first: the index of the first of them. The poses sent are those that the robot believes.
    """
    packing = packing or Packing()
    before: F64 | None = None
    for index, pose in enumerate(poses, first):
        sight = world.observe(pose, index, before)
        before = pose
        if seen is not None:
            seen.note(index, sight, pose)
        depth = np.where(sight.depth < _FARTHEST, sight.depth * DEPTH_SCALE, 0).round().astype(np.uint16)
        yield RecordedFrame(
            index=index,
            timestamp_ns=START_NS + index * STEP_NS,
            world_from_camera=sight.pose,
            rgb_bytes=_encoded(".jpg", sight.rgb[..., ::-1], (cv2.IMWRITE_JPEG_QUALITY, packing.jpeg)),
            rgb_encoding="jpeg",
            depth_bytes=_encoded(".png", depth, _png(packing.png)),
            depth_scale=DEPTH_SCALE,
            onboard=sight.onboard,
        )


def _write_home_truth(folder: Path, home: Home) -> None:
    things = [
        {
            "object_id": thing.object_id,
            "label": thing.label,
            "attributes": list(thing.attributes),
            "structural": thing.structural,
            "floor": thing.floor,
            "area_id": thing.area_id,
            "surface_area": round(thing.surface_area, 4),
            **_corners(thing.box),
        }
        for thing in home.objects
    ]
    relations = [
        {"subject": one.subject, "kind": one.kind.value, "object": one.object} for one in home.relations
    ]
    storeys = [{"floor": s.floor, "z": s.z, "ceiling_z": s.ceiling_z} for s in home.storeys]
    rooms, areas = ([_area(area) for area in every] for every in (home.rooms, home.areas))
    _write_json(folder / "objects.json", things)
    _write_json(folder / "relations.json", relations)
    _write_json(folder / "areas.json", {"storeys": storeys, "rooms": rooms, "areas": areas})
    (folder / "ATTRIBUTION.txt").write_text(_attribution(home), encoding="utf-8")


def _area(area: Area) -> dict[str, Any]:
    return {
        "area_id": area.area_id,
        "floor": area.floor,
        "function": area.function,
        "name": area.name,
        "room_id": area.room_id,
        "polygon": area.polygon.round(4).tolist(),
    }


def _attribution(home: Home) -> str:
    head = f"Rendered by this project from its simulated home {home.name!r} (seed {home.seed}, style {home.style}).\n"
    return head + f"Furniture: {home.furniture}\n" + "".join(f"{line}\n" for line in home.attributions)


def _corners(box: F64) -> dict[str, list[float]]:
    return {"aabb_low": box[:3].round(6).tolist(), "aabb_high": box[3:].round(6).tolist()}


def _write_json(path: Path, value: Any) -> None:
    path.write_text(json.dumps(value, indent=1) + "\n", encoding="utf-8")


def _png(level: int) -> tuple[int, ...]:
    return (
        cv2.IMWRITE_PNG_COMPRESSION,
        level,
        cv2.IMWRITE_PNG_STRATEGY,
        cv2.IMWRITE_PNG_STRATEGY_FILTERED,
    )


def _encoded(extension: str, image: U8 | U16, options: Sequence[int]) -> bytes:
    return cv2.imencode(extension, image, list(options))[1].tobytes()
