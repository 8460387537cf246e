"""Builders: rooms as the coarse clouds that a camera in them would send, and evidence made of them."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32, F64
from services.regions.domain.evidence import FloorEvidence

Span = tuple[float, float]


def plane(x: Span, y: Span, z: Span, step: float = 0.04) -> F32:
    """Points of an axis-aligned rectangle: one of the three spans has no length."""
    axes = [
        np.arange(low + step / 2, max(high, low + step), step) if high > low else [low]
        for low, high in (x, y, z)
    ]
    grid = np.meshgrid(*axes, indexing="ij")
    return np.stack([axis.ravel() for axis in grid], axis=1).astype(np.float32)


def room(x: Span, y: Span, floor: float = 0.0, height: float = 2.5) -> F32:
    """Floor, ceiling and four walls, seen from inside."""
    z = (floor, floor + height)
    return np.concatenate(
        [
            plane(x, y, (floor, floor)),
            plane(x, y, (z[1], z[1])),
            plane(x, (y[0], y[0]), z),
            plane(x, (y[1], y[1]), z),
            plane((x[0], x[0]), y, z),
            plane((x[1], x[1]), y, z),
        ]
    )


def without(points: F32, x: Span, y: Span, z: Span) -> F32:
    """The points outside a box: a doorway, a blind spot."""
    inside = np.ones(len(points), bool)
    for axis, (low, high) in enumerate((x, y, z)):
        inside &= (points[:, axis] >= low) & (points[:, axis] <= high)
    return points[~inside]


def seen(*views: tuple[F32, F64 | tuple[float, float, float]]) -> FloorEvidence:
    """Evidence of (cloud, camera position) pairs, as frames f0, f1, .."""
    evidence = FloorEvidence()
    for number, (points, camera) in enumerate(views):
        evidence.add(f"f{number}", points, np.asarray(camera, dtype=np.float64))
    return evidence


def two_rooms() -> FloorEvidence:
    """Rooms of 4 x 4 m side by side, x 0.025 .. 4.025 and 4.225 .. 8.225, a doorway 0.9 m wide between them.

    The doorway (y 1.6 .. 2.5) is 2 m high: above it is wall.
    """
    door = ((-1.0, 9.0), (1.6, 2.5), (-0.1, 2.0))
    left = _opened(room((0.025, 4.025), (0.025, 4.025)), 4.025, door)
    right = _opened(room((4.225, 8.225), (0.025, 4.025)), 4.225, door)
    sill = plane((4.025, 4.225), (1.6, 2.5), (0.0, 0.0))
    return seen(
        (np.concatenate([left, sill]), (2.0, 2.0, 1.2)),
        (np.concatenate([right, sill]), (6.0, 2.0, 1.2)),
    )


def _opened(points: F32, wall_x: float, door: tuple[Span, Span, Span]) -> F32:
    return without(points, (wall_x - 0.01, wall_x + 0.01), door[1], door[2])
