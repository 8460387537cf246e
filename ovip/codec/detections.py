"""Detections and batches of them: what perception hands to the mapper."""

from __future__ import annotations

import numpy as np

from ovip.codec.arrays import colors, colors_value, floats, floats_value
from ovip.codec.geometry import (
    box2_message,
    box2_value,
    box_message,
    box_value,
    intrinsics_message,
    intrinsics_value,
    pose_message,
    pose_value,
)
from ovip.codec.reading import parsed
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import F32, NEAREST_BLOCK, Detection, DetectionBatch, Intrinsics
from ovip.v1 import types_pb2
from ovip.wire import decode_depth_units, encode_depth

_UNITS = 1000.0
"""Of nearest depth, per metre."""


def detection_message(d: Detection) -> types_pb2.Detection:
    return types_pb2.Detection(
        detection_id=d.detection_id,
        label=d.label,
        score=d.score,
        box2=box2_message(d.box2),
        box3=box_message(d.box),
        feature=floats(d.feature),
        points=floats(d.points),
        colors=colors(d.colors),
        second_feature=floats(d.second_feature),
    )


def detection_value(m: types_pb2.Detection) -> Detection:
    if len(m.points) != 4 * len(m.colors):
        raise Corrupt(
            f"detection {m.detection_id}: {len(m.points)} bytes of points, {len(m.colors)} of colours"
        )
    return Detection(
        detection_id=m.detection_id,
        label=m.label,
        score=m.score,
        box2=box2_value(m.box2),
        box=box_value(m.box3),
        feature=floats_value(m.feature),
        points=floats_value(m.points, 3),
        colors=colors_value(m.colors),
        second_feature=floats_value(m.second_feature),
    )


def encode_detection_batch(batch: DetectionBatch) -> bytes:
    """The bytes of a batch, the same for the same batch. Nearest depth is kept to the millimetre, up to 65.535 m.

    InvalidInput where nearest depth does not fit the camera.
    """
    return types_pb2.DetectionBatch(
        frame_id=batch.frame_id,
        pose=pose_message(batch.world_from_camera),
        intrinsics=intrinsics_message(batch.intrinsics),
        timestamp_ns=batch.timestamp_ns,
        detections=[detection_message(d) for d in batch.detections],
        surface_points=floats(batch.surface),
        late=batch.late,
        words=batch.words,
        nearest_depth=_nearest_bytes(batch),
    ).SerializeToString(deterministic=True)


def decode_detection_batch(data: bytes) -> DetectionBatch:
    m = parsed(types_pb2.DetectionBatch, data)
    intrinsics = intrinsics_value(m.intrinsics)
    return DetectionBatch(
        frame_id=m.frame_id,
        timestamp_ns=m.timestamp_ns,
        intrinsics=intrinsics,
        world_from_camera=pose_value(m.pose),
        detections=tuple(detection_value(d) for d in m.detections),
        surface=floats_value(m.surface_points, 3),
        words=tuple(m.words),
        late=m.late,
        nearest=_nearest_value(m.nearest_depth, intrinsics, m.frame_id),
    )


def _nearest_bytes(batch: DetectionBatch) -> bytes:
    if not batch.nearest.size:
        return b""
    blocks = _blocks(batch.intrinsics)
    if batch.nearest.shape != (blocks.height, blocks.width):
        rows, columns = batch.nearest.shape
        raise InvalidInput(
            f"nearest depth of frame {batch.frame_id}: expected {blocks.width}x{blocks.height} blocks of the "
            f"camera's {batch.intrinsics.width}x{batch.intrinsics.height} pixels, got {columns}x{rows}"
        )
    units = np.nan_to_num(batch.nearest.astype(np.float64) * _UNITS, nan=0.0, posinf=0.0, neginf=0.0)
    return encode_depth(np.rint(np.clip(units, 0, 65535)).astype(np.uint16))


def _nearest_value(data: bytes, k: Intrinsics, frame_id: str) -> F32:
    """`(h, w)` metres; `(0, 0)` for no bytes."""
    if not data:
        return np.zeros((0, 0), np.float32)
    try:
        units = decode_depth_units(data, "shuffle_zstd", _blocks(k))
    except InvalidInput as error:
        raise Corrupt(f"nearest depth of frame {frame_id}: {error}") from error
    return np.asarray(units / np.float32(_UNITS), np.float32)


def _blocks(k: Intrinsics) -> Intrinsics:
    """A camera with one pixel a block: the size is all that is read of it."""
    return Intrinsics(k.fx, k.fy, k.cx, k.cy, -(-k.width // NEAREST_BLOCK), -(-k.height // NEAREST_BLOCK))
