"""Makes the values that tests need: cameras, poses, frames, detections, batches, settings."""

from __future__ import annotations

import dataclasses
import math
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from ovip.client import Hello, OutgoingFrame
from ovip.config import KernelSettings
from ovip.scene.boxes import box_of
from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, U8, U16, Box2, Detection, DetectionBatch, Frame, Intrinsics

SECOND = 1_000_000_000
DIMENSION = 8
CENTRE = Box2(24.0, 16.0, 40.0, 32.0)


def kernel_settings(data_dir: Path, **changes: Any) -> KernelSettings:
    """Settings of a store of its own in `data_dir`, whatever the environment says."""
    shared: dict[str, Any] = {"redis_url": None, "blob_url": None, "api_key": None, "store_fsync": "everysec"}
    return KernelSettings(_env_file=None, data_dir=data_dir, **{**shared, **changes})


# Cameras and poses


def camera(width: int = 64, height: int = 48, focal: float = 60.0) -> Intrinsics:
    """A small pinhole camera with its principal point in the middle."""
    return Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2, width, height)


def pose(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0, pitch: float = 0.0) -> F64:
    """world_from_camera of a camera at `(x, y, z)` that looks along +x at yaw 0, and down for positive pitch."""
    forward = np.array([math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), -math.sin(pitch)])
    right = np.array([math.sin(yaw), -math.cos(yaw), 0.0])
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2] = right, np.cross(forward, right), forward
    made[:3, 3] = x, y, z
    return made


# Images


def colour_noise(k: Intrinsics, seed: int = 0) -> U8:
    """`(H, W, 3)` random colours."""
    return np.random.default_rng(seed).integers(0, 256, (k.height, k.width, 3), dtype=np.uint8)


def depth_units(k: Intrinsics, metres: float = 2.0, scale: float = 1000.0) -> U16:
    """`(H, W)` of one depth."""
    return np.full((k.height, k.width), round(metres * scale), np.uint16)


def png(image: npt.NDArray[Any]) -> bytes:
    """PNG bytes of a grey, 16-bit or RGB image."""
    bgr = cv2.cvtColor(image, cv2.COLOR_RGB2BGR) if image.ndim == 3 else image
    return bytes(cv2.imencode(".png", bgr)[1].tobytes())


def jpeg(rgb: U8, quality: int = 95) -> bytes:
    """JPEG bytes of an RGB image."""
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    return bytes(cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes())


def png_claiming(width: int, height: int, bits: int, colour_type: int) -> bytes:
    """A small well-formed PNG whose header claims any size."""
    head = struct.pack(">IIBBBBB", width, height, bits, colour_type, 0, 0, 0)
    body = zlib.compress(b"\0" * 1000)
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", head) + _chunk(b"IDAT", body) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def frame(
    depth: F32 | float = 2.0,
    frame_id: str = "r.s.00000001",
    k: Intrinsics | None = None,
    rgb: U8 | None = None,
    world_from_camera: F64 | None = None,
) -> Frame:
    """A decoded frame; a number for `depth` makes a flat wall that far away."""
    k = k or camera()
    shape = (k.height, k.width)
    return Frame(
        frame_id=frame_id,
        timestamp_ns=SECOND,
        intrinsics=k,
        world_from_camera=np.eye(4) if world_from_camera is None else world_from_camera,
        rgb=np.zeros((*shape, 3), np.uint8) if rgb is None else rgb,
        depth=np.broadcast_to(np.asarray(depth, np.float32), shape).copy(),
    )


# What a robot sends


def hello(
    scene: str = "kitchen", session: str = "s1", k: Intrinsics | None = None, robot: str = "r1"
) -> Hello:
    """The first word of a robot's stream."""
    return Hello(scene, robot, session, k or camera())


def outgoing(sequence: int, k: Intrinsics | None = None, **changes: Any) -> OutgoingFrame:
    """A frame of noise before a wall two metres away."""
    k = k or camera()
    made: dict[str, Any] = {
        "sequence": sequence,
        "timestamp_ns": sequence * SECOND,
        "world_from_camera": pose(z=1.0),
        "rgb": png(colour_noise(k, sequence)),
        "depth": png(depth_units(k)),
        "depth_scale": 1000.0,
    }
    return OutgoingFrame(**{**made, **changes})


# Detections


def axis(i: int, dimension: int = DIMENSION) -> F32:
    """The unit feature along axis `i`."""
    made = np.zeros(dimension, np.float32)
    made[i] = 1.0
    return made


def leaning(i: int, j: int, cosine: float, dimension: int = DIMENSION) -> F32:
    """A unit feature whose cosine with axis `i` is `cosine`, the rest of it along axis `j`."""
    return normalize(cosine * axis(i, dimension) + math.sqrt(1 - cosine**2) * axis(j, dimension))


def block(low: Sequence[float], high: Sequence[float], step: float = 0.05) -> F32:
    """Points `(N, 3)` that fill a box, its corners included."""
    ticks = [np.linspace(a, b, max(2, round((b - a) / step) + 1)) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float32)


def detection(
    label: str = "cup",
    low: Sequence[float] = (0.0, 0.0, 0.0),
    high: Sequence[float] = (0.2, 0.2, 0.2),
    feature: F32 | None = None,
    box2: Box2 = CENTRE,
    points: F32 | None = None,
    detection_id: str = "f/0",
    color: Sequence[int] = (200, 100, 50),
) -> Detection:
    """A lifted detection whose points fill the box from `low` to `high`."""
    points = block(low, high) if points is None else points
    return Detection(
        detection_id=detection_id,
        label=label,
        score=0.9,
        box2=box2,
        box=box_of(points),
        feature=axis(0) if feature is None else feature,
        points=points,
        colors=np.tile(np.array(color, np.uint8), (len(points), 1)),
    )


def batch(
    number: int, *detections: Detection, late: bool = False, k: Intrinsics | None = None
) -> DetectionBatch:
    """The detections of frame `number`."""
    return DetectionBatch(
        frame_id=f"r.s.{number:08d}",
        timestamp_ns=number * SECOND,
        intrinsics=k or camera(),
        world_from_camera=np.eye(4),
        detections=detections,
        surface=np.zeros((0, 3), np.float32),
        words=tuple(sorted({d.label for d in detections})),
        late=late,
    )


def random_run(seed: int, frames: int, dimension: int = 6) -> list[DetectionBatch]:
    """A robot that looks at six things from anywhere: moved boxes, mixed labels, some false ones, some late."""
    rng = np.random.default_rng(seed)
    kinds = normalize(rng.normal(size=(6, dimension)).astype(np.float32))
    places = rng.uniform(0, 2.0, (6, 3))

    def seen() -> Detection:
        i = int(rng.integers(6))
        low = places[i] + rng.normal(0, 0.03, 3)
        high = low + rng.uniform(0.1, 0.5, 3)
        corner = rng.integers(0, 30, 2)
        return detection(
            str(rng.choice(["cup", "mug", "table"]))
            if rng.random() < 0.2
            else ["cup", "mug", "table"][i % 3],
            points=block(tuple(low), tuple(high), 0.12),
            feature=normalize((kinds[i] + rng.normal(0, 0.1, dimension)).astype(np.float32)),
            box2=Box2(float(corner[0]), float(corner[1]), float(corner[0]) + 20, float(corner[1]) + 15),
            color=tuple(int(c) for c in rng.integers(0, 256, 3)),
        )

    return [
        batch(n, *(seen() for _ in range(int(rng.integers(0, 5)))), late=bool(rng.random() < 0.1))
        for n in range(1, frames + 1)
    ]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal through and through: dataclasses by field, arrays by type, shape and number."""
    if dataclasses.is_dataclass(a) and not isinstance(a, type):
        return type(a) is type(b) and all(
            same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a)
        )
    if isinstance(a, np.ndarray):
        return (
            isinstance(b, np.ndarray) and a.dtype == b.dtype and a.shape == b.shape and np.array_equal(a, b)
        )
    if isinstance(a, tuple | list):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    return bool(a == b)
