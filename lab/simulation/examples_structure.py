"""Walls with openings, floors and ceilings of a drawn plan, as triangles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from lab.simulation.catalogue.ears import triangulated
from lab.simulation.examples_plan import Piece, Wall
from lab.simulation.home import Material, Mesh
from ovip.scene.types import F64, I32, U8

Opening = tuple[float, float, float, float]
"""Along a wall from, to; above its level from, to: metres."""
PAINT: U8 = np.array([236, 233, 226], np.uint8)
SEAM = 0.003
"""Metres by which an end stays behind the wall that it meets, so that no two faces lie in one plane."""
GROUND: U8 = np.array([176, 160, 140], np.uint8)


def wall_mesh(wall: Wall, openings: Sequence[Opening], z: float) -> Mesh | None:
    """A wall standing at height `z`, cut into boxes around its openings; None where nothing of it is left."""
    along = wall.end - wall.start
    length = float(np.linalg.norm(along))
    if length < 1e-6 or max(wall.heights) < 1e-3:
        return None
    reach = wall.thickness / 2 - SEAM
    ends = (-reach * wall.joined[0], length + reach * wall.joined[1])
    cut = (_panel(wall, along / length, part, length, z) for part in _parts(ends, openings))
    panels = [panel for panel in cut if panel is not None]
    if not panels:
        return None
    corners = np.concatenate([panel[0] for panel in panels])
    sides = np.concatenate([panel[1] for panel in panels])
    left, right = (Material(side if side is not None else PAINT) for side in wall.sides)
    return flat_mesh(corners, (left, right), sides)


def openings_of(wall: Wall, pieces: Iterable[Piece]) -> list[Opening]:
    """What the doors and windows of its level cut out of a wall."""
    return [cut for piece in pieces if piece.level == wall.level and (cut := _cut(wall, piece)) is not None]


def thresholds(wall: Wall, openings: Sequence[Opening]) -> list[F64]:
    """The floor under each opening that reaches down to it: corners `(4, 2)`."""
    ahead = (wall.end - wall.start) / max(float(np.linalg.norm(wall.end - wall.start)), 1e-9)
    across = np.array([-ahead[1], ahead[0]]) * wall.thickness / 2
    doors = [
        (wall.start + ahead * low, wall.start + ahead * high)
        for low, high, foot, _ in openings
        if foot < 0.05
    ]
    return [np.stack([a - across, b - across, b + across, a + across]) for a, b in doors]


def flat_mesh(
    corners: F64,
    materials: tuple[Material, ...],
    material_ids: I32,
) -> Mesh:
    """Triangles `(T, 3, 3)` metres, each with its own normal; pictures are a metre wide."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    axes = np.array([[1, 2], [0, 2], [0, 1]])[np.abs(normals).argmax(axis=1)]
    uv = np.take_along_axis(corners, np.broadcast_to(axes[:, None, :], (len(corners), 3, 2)), axis=2)
    return Mesh(
        vertices=corners.reshape(-1, 3).astype(np.float32),
        triangles=np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3),
        normals=np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        uv=uv.astype(np.float32),
        material_ids=material_ids.astype(np.int32),
        materials=materials,
        object_ids=np.zeros(len(corners), np.uint16),
    )


def slab_mesh(polygon: F64, z: float, holes: Sequence[F64], color: U8, upward: bool = True) -> Mesh | None:
    """A polygon `(N, 2)` at height `z` without its holes (convex rings); None where nothing is left of it."""
    pieces = [
        polygon[list(corner)] for corner in triangulated(np.column_stack([polygon, np.zeros(len(polygon))]))
    ]
    for hole in holes:
        pieces = [part for piece in pieces for part in _outside(piece, _counter_clockwise(hole))]
    flats = [piece[[0, i, i + 1]] for piece in pieces for i in range(1, len(piece) - 1)]
    flats = [_counter_clockwise(flat) for flat in flats if abs(_signed(flat)) > 1e-8]
    if not flats:
        return None
    corners = np.dstack([np.stack(flats), np.full((len(flats), 3), z)])
    return flat_mesh(
        corners if upward else corners[:, ::-1], (Material(color),), np.zeros(len(flats), np.int32)
    )


def footprint(piece: Piece, widen: float = 0.0) -> F64:
    """The four corners `(4, 2)` of a piece's rectangle on the plan, counter-clockwise."""
    half = np.array([piece.size[0], piece.size[1] + 2 * widen]) / 2
    ring = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    c, s = np.cos(piece.yaw), np.sin(piece.yaw)
    corners: F64 = ring @ np.array([[c, s], [-s, c]]) + piece.position[:2]
    return corners


def _cut(wall: Wall, piece: Piece) -> Opening | None:
    along = wall.end - wall.start
    length = float(np.linalg.norm(along))
    if length < 1e-6:
        return None
    ahead = along / length
    across = np.array([-ahead[1], ahead[0]])
    if abs(float(np.array([np.cos(piece.yaw), np.sin(piece.yaw)]) @ across)) > 0.3:
        return None
    at = piece.position[:2] - wall.start
    if abs(float(at @ across)) > (wall.thickness + piece.size[1]) / 2:
        return None
    middle, half = float(at @ ahead), piece.size[0] / 2
    if middle + half < 0 or middle - half > length:
        return None
    return (middle - half, middle + half, float(piece.position[2]), float(piece.position[2]) + piece.size[2])


def _parts(ends: tuple[float, float], openings: Sequence[Opening]) -> list[Opening]:
    """A wall's face without its openings, as rectangles."""
    edges = sorted({*ends, *(min(max(t, ends[0]), ends[1]) for o in openings for t in o[:2])})
    parts = []
    for start, end in pairwise(edges):
        if end - start < 1e-4:
            continue
        middle = (start + end) / 2
        bands = sorted((o[2], o[3]) for o in openings if o[0] < middle < o[1])
        low = 0.0
        for bottom, top in bands:
            if bottom > low + 1e-4:
                parts.append((start, end, low, bottom))
            low = max(low, top)
        parts.append((start, end, low, np.inf))
    return parts


def _panel(wall: Wall, ahead: F64, part: Opening, length: float, z: float) -> tuple[F64, I32] | None:
    """A box of a wall, its upper edge as high as the wall there: triangles, and 0 or 1 for the side each is of."""
    start, end, low, high = part
    tops = [min(high, float(np.interp(t, (0, length), wall.heights))) for t in (start, end)]
    if max(tops) <= low:
        return None
    across = np.array([-ahead[1], ahead[0]]) * wall.thickness / 2
    ring = []
    for side in (across, -across):
        for t, top in ((start, tops[0]), (end, tops[1])):
            foot = wall.start + ahead * t + side
            ring.append(((*foot, z + low), (*foot, z + max(top, low))))
    (a, e), (b, f), (c, g), (d, h) = ring
    quads = ((b, a, e, f), (c, d, h, g), (a, c, g, e), (d, b, f, h), (e, g, h, f), (a, b, d, c))
    triangles = [(q[0], q[1], q[2]) for q in quads] + [(q[0], q[2], q[3]) for q in quads]
    return np.asarray(triangles, np.float64), np.array([0, 1, 0, 0, 0, 0] * 2, np.int32)


def _outside(piece: F64, hole: F64) -> list[F64]:
    """A convex piece without a convex hole, as convex pieces."""
    parts, inside = [], piece
    for a, b in zip(hole, np.roll(hole, -1, axis=0), strict=True):
        outer = _clipped(inside, b, a)
        if len(outer) >= 3:
            parts.append(outer)
        inside = _clipped(inside, a, b)
        if len(inside) < 3:
            return parts
    return parts


def _clipped(piece: F64, a: F64, b: F64) -> F64:
    """What of a convex piece lies left of the line from `a` to `b`."""
    if not len(piece):
        return piece
    side = (b[0] - a[0]) * (piece[:, 1] - a[1]) - (b[1] - a[1]) * (piece[:, 0] - a[0])
    kept = []
    for i in range(len(piece)):
        j = (i + 1) % len(piece)
        if side[i] >= 0:
            kept.append(piece[i])
        if (side[i] > 0 > side[j]) or (side[i] < 0 < side[j]):
            kept.append(piece[i] + (piece[j] - piece[i]) * side[i] / (side[i] - side[j]))
    return np.asarray(kept, np.float64).reshape(-1, 2)


def _signed(ring: F64) -> float:
    x, y = ring[:, 0], ring[:, 1]
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def _counter_clockwise(ring: F64) -> F64:
    return ring if _signed(ring) > 0 else ring[::-1]
