"""Polygons cut into triangles."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F64


def triangulated(ring: F64) -> list[tuple[int, int, int]]:
    """Triangles of a flat, open ring `(N, 3)` of corners in space, as its row numbers; it may be concave.

    Ears are clipped one by one; where none is left (the ring crosses itself), the rest is fanned.
    """
    flat = _flattened(ring)
    left = list(range(len(ring)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if _is_ear(flat, left, i)), None)
        if ear is None:
            break
        triangles.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    triangles.extend((left[0], left[i], left[i + 1]) for i in range(1, len(left) - 1))
    return triangles


def _flattened(ring: F64) -> F64:
    """The ring seen along its normal, counter-clockwise: `(N, 2)`."""
    normal = np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)
    axis = int(np.abs(normal).argmax())
    plane = np.delete(ring, axis, axis=1)
    if (normal[axis] > 0) == (axis == 1):
        plane = plane[:, ::-1]
    return plane


def _is_ear(flat: F64, left: list[int], at: int) -> bool:
    """Whether a corner turns left and its triangle holds no other corner."""
    a, b, c = flat[left[at - 1]], flat[left[at]], flat[left[(at + 1) % len(left)]]
    if _turn(a, b, c) <= 0:
        return False
    others = [i for i in left if i not in (left[at - 1], left[at], left[(at + 1) % len(left)])]
    p = flat[others]
    p = p[~((p == a).all(1) | (p == b).all(1) | (p == c).all(1))]
    inside = (_turns(a, b, p) >= 0) & (_turns(b, c, p) >= 0) & (_turns(c, a, p) >= 0)
    return not bool(inside.any())


def _turn(a: F64, b: F64, c: F64) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _turns(a: F64, b: F64, points: F64) -> F64:
    turns: F64 = (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])
    return turns
