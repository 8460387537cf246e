"""Object point clouds as PLY 1.0: x y z red green blue object_id, text or little-endian binary.

`object_id` counts the objects in the order of the header's comments, which name each one's id and label.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ovip.scene.types import F32, F64, U8

_ROW = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("red", "u1"),
        ("green", "u1"),
        ("blue", "u1"),
        ("object_id", "<i4"),
    ]
)
_ROWS_AT_ONCE = 20_000


class PlyFormat(StrEnum):
    ASCII = "ascii"
    BINARY = "binary_little_endian"


@dataclass(frozen=True, slots=True)
class PlyObject:
    """One object's cloud. points: `(N, 3)` metres; colors: `(N, 3)` RGB."""

    object_id: str
    label: str
    points: F32 | F64
    colors: U8


def write_ply(objects: Sequence[PlyObject], form: PlyFormat, comments: Sequence[str] = ()) -> Iterator[bytes]:
    """The file in pieces: the header, then rows, object after object."""
    yield _header(objects, form, comments)
    for index, obj in enumerate(objects):
        for start in range(0, len(obj.points), _ROWS_AT_ONCE):
            rows = _rows(obj, index, slice(start, start + _ROWS_AT_ONCE))
            yield rows.tobytes() if form is PlyFormat.BINARY else _text(rows)


def _header(objects: Sequence[PlyObject], form: PlyFormat, comments: Sequence[str]) -> bytes:
    lines = [
        "ply",
        f"format {form.value} 1.0",
        *(f"comment {_one_line(comment)}" for comment in comments),
        *(f"comment object {i} {obj.object_id} {_one_line(obj.label)}" for i, obj in enumerate(objects)),
        f"element vertex {sum(len(obj.points) for obj in objects)}",
        *(f"property float {axis}" for axis in "xyz"),
        *(f"property uchar {channel}" for channel in ("red", "green", "blue")),
        "property int object_id",
        "end_header",
    ]
    return ("\n".join(lines) + "\n").encode("ascii", "replace")


def _rows(obj: PlyObject, index: int, part: slice) -> np.ndarray:
    points, colors = obj.points[part], obj.colors[part]
    rows = np.empty(len(points), dtype=_ROW)
    for axis, name in enumerate("xyz"):
        rows[name] = points[:, axis]
    for channel, name in enumerate(("red", "green", "blue")):
        rows[name] = colors[:, channel]
    rows["object_id"] = index
    return rows


def _text(rows: np.ndarray) -> bytes:
    return b"".join(b"%.5f %.5f %.5f %d %d %d %d\n" % row for row in rows.tolist())


def _one_line(text: str) -> str:
    return " ".join(text.split())
