"""Upright boxes turned about the vertical, and which of them meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, Bools

CONTACT = 0.01
"""Metres that two things may share in height without meeting: a leg on a rug."""
_TOUCH = 1e-4


@dataclass(frozen=True, slots=True)
class Footprint:
    """An upright box. x, y: its middle; width and depth along its own axes, turned by yaw. Metres, radians."""

    x: float
    y: float
    width: float
    depth: float
    yaw: float
    bottom: float
    top: float

    def row(self) -> F64:
        """`(8,)`: x, y, half width, half depth, cosine, sine, bottom, top."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([self.x, self.y, self.width / 2, self.depth / 2, c, s, self.bottom, self.top])

    def corners(self) -> F64:
        """`(4, 2)` metres, around."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        own = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [self.width / 2, self.depth / 2]
        corners: F64 = own @ np.array([[c, s], [-s, c]]) + [self.x, self.y]
        return corners


def meeting(one: Footprint, rows: F64) -> Bools:
    """Which boxes `(N, 8)` (see `Footprint.row`) meet this one -> `(N,)`; sides that only touch do not."""
    x, y, a, b, c, s, bottom, top = one.row()
    dx, dy = rows[:, 0] - x, rows[:, 1] - y
    other_a, other_b, oc, os = rows[:, 2], rows[:, 3], rows[:, 4], rows[:, 5]
    along = np.abs(c * oc + s * os)
    across = np.abs(c * os - s * oc)
    apart = np.abs(dx * c + dy * s) >= a + other_a * along + other_b * across - _TOUCH
    apart |= np.abs(-dx * s + dy * c) >= b + other_a * across + other_b * along - _TOUCH
    apart |= np.abs(dx * oc + dy * os) >= other_a + a * along + b * across - _TOUCH
    apart |= np.abs(-dx * os + dy * oc) >= other_b + a * across + b * along - _TOUCH
    apart |= (bottom >= rows[:, 7] - CONTACT) | (top <= rows[:, 6] + CONTACT)
    meets: Bools = ~apart
    return meets


def gap_between(one: Footprint, other: Footprint) -> float:
    """Metres between two footprints seen from above; 0 where they meet."""
    if meeting(_flat(one), _flat(other).row()[None])[0]:
        return 0.0
    return min(_corner_gap(one, other), _corner_gap(other, one))


def _flat(one: Footprint) -> Footprint:
    return Footprint(one.x, one.y, one.width, one.depth, one.yaw, 0.0, 1.0)


def _corner_gap(one: Footprint, other: Footprint) -> float:
    """From the corners of `one` to the sides of `other`."""
    c, s = np.cos(other.yaw), np.sin(other.yaw)
    offset = one.corners() - [other.x, other.y]
    own = np.stack([offset @ [c, s], offset @ [-s, c]], axis=1)
    beyond = np.maximum(np.abs(own) - [other.width / 2, other.depth / 2], 0)
    return float(np.linalg.norm(beyond, axis=1).min())
