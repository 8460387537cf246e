"""A walk through the simulated home as a recording on disk (layout `ovip`), its truth beside it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np

from lab.simulation.detecting import onboard_detections
from lab.simulation.room import SimulatedRoom
from ovip.recordings import RecordedFrame, write_folder
from ovip.scene.types import F64, U8, U16

DEPTH_SCALE = 1000.0
JPEG_QUALITY = 95
START_NS = 1_700_000_000_000_000_000
STEP_NS = 100_000_000


def write_recording(folder: Path, room: SimulatedRoom, poses: Sequence[F64] | None = None) -> int:
    """Renders `poses` (the room's own walk where None) into `folder` and returns how many frames there are.

    The robot's own detections lie in detections/, the truth in objects.json: object_id, label, color,
    structural, aabb_low, aabb_high. The folder must not hold a recording yet.
    """
    count = write_folder(
        folder, room.intrinsics, recorded_frames(room, room.walk() if poses is None else poses)
    )
    truth = [
        {
            "object_id": thing.object_id,
            "label": thing.label,
            "color": thing.color,
            "structural": thing.structural,
            "aabb_low": thing.box[:3].round(6).tolist(),
            "aabb_high": thing.box[3:].round(6).tolist(),
        }
        for thing in room.objects
    ]
    (folder / "objects.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return count


def recorded_frames(room: SimulatedRoom, poses: Sequence[F64], first: int = 0) -> Iterator[RecordedFrame]:
    """What the robot sends from each pose, ten frames a second: images and what it detected on board.

    first: the index of the first of them.
    """
    for index, pose in enumerate(poses, first):
        rgb, depth, ids = room.render(pose)
        yield RecordedFrame(
            index=index,
            timestamp_ns=START_NS + index * STEP_NS,
            world_from_camera=pose,
            rgb_bytes=_encoded(".jpg", rgb[..., ::-1], (cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY)),
            rgb_encoding="jpeg",
            depth_bytes=_encoded(".png", (depth * DEPTH_SCALE).round().astype(np.uint16), ()),
            depth_scale=DEPTH_SCALE,
            onboard=onboard_detections(room, ids),
        )


def _encoded(extension: str, image: U8 | U16, options: Sequence[int]) -> bytes:
    return cv2.imencode(extension, image, list(options))[1].tobytes()
