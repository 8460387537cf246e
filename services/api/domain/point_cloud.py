"""The point clouds of objects as one compact binary message for drawing.

All little-endian:

| offset      | what                                                             |
|-------------|------------------------------------------------------------------|
| 0           | "OVPC"                                                           |
| 4           | uint32 format, 1                                                 |
| 8           | uint64 map version                                               |
| 16          | uint32 N points                                                  |
| 20          | uint32 J bytes of JSON                                           |
| 24          | N x 3 float32, metres                                            |
| 24 + 12 N   | N uint32, index of the point's object in the JSON                |
| 24 + 16 N   | N x 3 uint8, red green blue                                      |
| 24 + 19 N   | J bytes, UTF-8 JSON array of object ids                          |
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping

import numpy as np

from ovip.answer_json import OutputFrame
from ovip.scene.types import F32, U8

MAGIC = b"OVPC"
FORMAT = 1
_HEADER = struct.Struct("<4sIQII")


def pack_points(clouds: Mapping[str, tuple[F32, U8]], map_version: int, frame: OutputFrame) -> bytes:
    """Object id -> (points `(N, 3)` world metres, colours `(N, 3)` RGB) as the message above, in `frame`."""
    ids = json.dumps(list(clouds)).encode()
    counts = [len(points) for points, _ in clouds.values()]
    points = [frame.points(points).astype("<f4") for points, _ in clouds.values()]
    colors = [colors.astype(np.uint8) for _, colors in clouds.values()]
    return b"".join(
        [
            _HEADER.pack(MAGIC, FORMAT, map_version, sum(counts), len(ids)),
            *(part.tobytes() for part in points),
            np.repeat(np.arange(len(counts)), counts).astype("<u4").tobytes(),
            *(part.tobytes() for part in colors),
            ids,
        ]
    )
