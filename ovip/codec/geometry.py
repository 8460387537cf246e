"""Vectors, boxes, poses, cameras, outlines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.types import F64, Box2, Intrinsics
from ovip.v1 import types_pb2


def vector_message(v: Sequence[float] | F64) -> types_pb2.Vector3:
    return types_pb2.Vector3(x=float(v[0]), y=float(v[1]), z=float(v[2]))


def vector_value(m: types_pb2.Vector3) -> F64:
    return np.array([m.x, m.y, m.z])


def vectors_value(vectors: Iterable[types_pb2.Vector3]) -> F64:
    """`(N, 3)`."""
    return np.array([[v.x, v.y, v.z] for v in vectors], dtype=np.float64).reshape(-1, 3)


def box_message(box: F64) -> types_pb2.Box3:
    return types_pb2.Box3(low=vector_message(box[:3]), high=vector_message(box[3:]))


def box_value(m: types_pb2.Box3) -> F64:
    return np.concatenate([vector_value(m.low), vector_value(m.high)])


def box2_message(box: Box2) -> types_pb2.Box2:
    return types_pb2.Box2(x0=box.x0, y0=box.y0, x1=box.x1, y1=box.y1)


def box2_value(m: types_pb2.Box2) -> Box2:
    return Box2(m.x0, m.y0, m.x1, m.y1)


def pose_message(pose: F64) -> types_pb2.Pose:
    return types_pb2.Pose(world_from_camera=matrix_numbers(pose))


def pose_value(m: types_pb2.Pose) -> F64:
    """`(4, 4)`; only the count is checked here, `camera.check_pose` checks the rest."""
    return matrix_value(m.world_from_camera, "pose")


def matrix_numbers(matrix: F64) -> list[float]:
    """16 numbers, row-major, of a `(4, 4)`."""
    numbers: list[float] = np.asarray(matrix, np.float64).ravel().tolist()
    return numbers


def matrix_value(numbers: Iterable[float], what: str) -> F64:
    matrix = np.array(list(numbers), dtype=np.float64)
    if matrix.size != 16:
        raise InvalidInput(f"{what}: expected 16 numbers (4x4 row-major), got {matrix.size}")
    return matrix.reshape(4, 4)


def matrix_or_none(numbers: Sequence[float], what: str) -> F64 | None:
    """None for no numbers."""
    return matrix_value(numbers, what) if numbers else None


def intrinsics_message(k: Intrinsics) -> types_pb2.Intrinsics:
    return types_pb2.Intrinsics(fx=k.fx, fy=k.fy, cx=k.cx, cy=k.cy, width=k.width, height=k.height)


def intrinsics_value(m: types_pb2.Intrinsics) -> Intrinsics:
    return Intrinsics(m.fx, m.fy, m.cx, m.cy, m.width, m.height)


def polygon_message(ring: F64) -> types_pb2.Polygon:
    return types_pb2.Polygon(xy=np.asarray(ring, np.float64).ravel().tolist())


def polygon_value(m: types_pb2.Polygon) -> F64:
    return np.array(list(m.xy), dtype=np.float64).reshape(-1, 2)
