"""Boxes and upright cylinders, and where rays meet them (analytic, vectorised)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ovip.scene.types import F32, F64, Bools

NEVER = np.float32(np.inf)


class Shape(IntEnum):
    """What a solid is: a box turned about the vertical, or an upright cylinder."""

    BOX = 0
    CYLINDER = 1


class Finish(IntEnum):
    """What a surface looks like: how brightness varies over it."""

    PLAIN = 0
    TILES = 1
    WOOD = 2
    FABRIC = 3
    BOOKS = 4


@dataclass(frozen=True, slots=True)
class Solid:
    """One convex piece of something, in metres and world axes.

    half: half sizes along its own axes; a cylinder's are radius, radius, half height. yaw: radians about z, a
    box's. color: RGB 0..255.
    """

    shape: Shape
    center: tuple[float, float, float]
    half: tuple[float, float, float]
    yaw: float
    object_id: int
    color: tuple[int, int, int]
    finish: Finish

    def bounds(self) -> F64:
        """Exact axis-aligned box `(6,)`: low, then high corner."""
        a, b, h = self.half
        c, s = (abs(np.cos(self.yaw)), abs(np.sin(self.yaw))) if self.shape is Shape.BOX else (1.0, 0.0)
        reach = np.array([c * a + s * b, s * a + c * b, h])
        return np.concatenate([self.center - reach, self.center + reach])


def hit(solid: Solid, origin: F64, directions: F32) -> F32:
    """How far along each of `(..., 3)` directions the solid begins -> `(...)`, infinity where it is missed.

    Distances count in lengths of the direction. From inside a solid nothing of it is seen.
    """
    start = (origin - solid.center).astype(np.float32)
    if solid.shape is Shape.CYLINDER:
        return _hit_cylinder(start, directions, solid)
    if solid.yaw:
        start, directions = turned(start, -solid.yaw), turned(directions, -solid.yaw)
    near, far = _slab(start[0], directions[..., 0], solid.half[0])
    for axis in (1, 2):
        enter, leave = _slab(start[axis], directions[..., axis], solid.half[axis])
        near, far = np.maximum(near, enter), np.minimum(far, leave)
    return np.where((near < far) & (near > 0), near, NEVER)


def turned(vectors: F32, yaw: float | F32) -> F32:
    """`(..., 3)` vectors turned about z by one `yaw`, or each by its own `(...,)`."""
    c, s = np.cos(np.asarray(yaw, np.float32)), np.sin(np.asarray(yaw, np.float32))
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y, vectors[..., 2]], axis=-1)


def footprint_distance(solid: Solid, xy: F64) -> F64:
    """Distance of `(N, 2)` floor points from the solid's outline seen from above -> `(N,)`; 0 inside."""
    offset = np.atleast_2d(xy) - np.array(solid.center[:2])
    if solid.shape is Shape.CYLINDER:
        return np.asarray(np.maximum(np.hypot(offset[:, 0], offset[:, 1]) - solid.half[0], 0.0))
    c, s = np.cos(solid.yaw), np.sin(solid.yaw)
    own = np.abs(np.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]], axis=1))
    gap = np.maximum(own - np.array(solid.half[:2]), 0.0)
    return np.asarray(np.hypot(gap[:, 0], gap[:, 1]))


def _slab(start: np.float32, direction: F32, half: float) -> tuple[F32, F32]:
    """Where rays enter and leave the space between two parallel planes."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.float32(1) / direction
        a, b = (np.float32(-half) - start) * inverse, (np.float32(half) - start) * inverse
    return np.fmin(a, b), np.fmax(a, b)


def _hit_cylinder(start: F32, directions: F32, solid: Solid) -> F32:
    radius, half = np.float32(solid.half[0]), solid.half[2]
    dx, dy = directions[..., 0], directions[..., 1]
    a = np.maximum(dx * dx + dy * dy, np.float32(1e-12))
    b = start[0] * dx + start[1] * dy
    c = start[0] ** 2 + start[1] ** 2 - radius**2
    inside: Bools = b * b - a * c
    root = np.sqrt(np.maximum(inside, 0))
    enter, leave = _slab(start[2], directions[..., 2], half)
    near, far = np.maximum((-b - root) / a, enter), np.minimum((-b + root) / a, leave)
    return np.where((inside > 0) & (near < far) & (near > 0), near, NEVER)
