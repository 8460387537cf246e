"""Points of objects, in parts: an object larger than a part goes on in the next."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from ovip.codec.arrays import colors, colors_value, floats, floats_value
from ovip.codec.objects import PART_BYTES
from ovip.errors import Corrupt
from ovip.scene.types import F32, U8
from ovip.v1 import mapper_pb2

_POINT_BYTES = 15  # three float32 and three bytes of colour

Clouds = dict[str, tuple[F32, U8]]
"""Object id -> points `(N, 3)` world metres, colours `(N, 3)`."""


def points_parts(
    version: int, clouds: Mapping[str, tuple[F32, U8]], part_bytes: int = PART_BYTES
) -> Iterator[mapper_pb2.GetObjectPointsResponse]:
    """The clouds as messages of about `part_bytes` at most; one at least."""
    part, room = mapper_pb2.GetObjectPointsResponse(version=version), part_bytes
    for piece in _pieces(clouds, max(1, part_bytes // _POINT_BYTES)):
        size = piece.ByteSize()
        if part.objects and size > room:
            yield part
            part, room = mapper_pb2.GetObjectPointsResponse(version=version), part_bytes
        part.objects.append(piece)
        room -= size
    yield part


def points_value(parts: Iterable[mapper_pb2.GetObjectPointsResponse]) -> tuple[int, Clouds]:
    """The map's version and the clouds, in the order sent; Corrupt where parts are of different versions."""
    parts = list(parts)
    if not parts:
        raise Corrupt("points: the stream ended before its first part")
    versions = sorted({part.version for part in parts})
    if len(versions) > 1:
        raise Corrupt(f"points: expected parts of one version, got {versions}")
    pieces: dict[str, list[tuple[F32, U8]]] = {}
    for part in parts:
        for item in part.objects:
            pieces.setdefault(item.object_id, []).append(_piece_value(item))
    return versions[0], {object_id: _joined(of_one) for object_id, of_one in pieces.items()}


def _pieces(clouds: Mapping[str, tuple[F32, U8]], most: int) -> Iterator[mapper_pb2.ObjectPoints]:
    """Each cloud in runs of at most `most` points; an empty cloud is one empty piece."""
    for object_id, (xyz, rgb) in clouds.items():
        for at in range(0, max(len(xyz), 1), most):
            yield mapper_pb2.ObjectPoints(
                object_id=object_id, points=floats(xyz[at : at + most]), colors=colors(rgb[at : at + most])
            )


def _piece_value(m: mapper_pb2.ObjectPoints) -> tuple[F32, U8]:
    if len(m.points) != 4 * len(m.colors):
        raise Corrupt(f"object {m.object_id}: {len(m.points)} bytes of points, {len(m.colors)} of colours")
    return floats_value(m.points, 3), colors_value(m.colors)


def _joined(pieces: list[tuple[F32, U8]]) -> tuple[F32, U8]:
    if len(pieces) == 1:
        return pieces[0]
    return np.concatenate([xyz for xyz, _ in pieces]), np.concatenate([rgb for _, rgb in pieces])
