"""Smooth camera walks through given places, and whether a straight way is clear."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lab.simulation.camera import pose_looking
from ovip.scene.types import F64

LONGEST_STEP = 0.22  # metres
LARGEST_TURN = 0.21  # radians
_SAMPLES = 60
_CHECKED = 0.05  # metres between places where a way is checked


def smooth_walk(places: F64, targets: F64, height: float, pitch: float) -> list[F64]:
    """Poses `(4, 4)` on a smooth curve through `(N, 2)` places, looking at each to its `(N, 2)` target.

    A step is at most 0.22 m and 0.21 rad of heading, and as near to those as the curve allows.
    """
    toward = targets - places
    yaw = np.unwrap(np.arctan2(toward[:, 1], toward[:, 0]))
    curve = _curve(np.column_stack([places, yaw]))
    change = np.abs(np.diff(curve, axis=0))
    effort = np.maximum(np.hypot(change[:, 0], change[:, 1]) / LONGEST_STEP, change[:, 2] / LARGEST_TURN)
    done = np.concatenate([[0.0], np.cumsum(effort)])
    at = np.linspace(0, done[-1], int(np.ceil(done[-1])) + 1)
    x, y, heading = (np.interp(at, done, column) for column in curve.T)
    return [pose_looking((x[i], y[i], height), float(heading[i]), pitch) for i in range(len(at))]


def is_clear(is_free: Callable[[F64], bool], a: F64, b: F64) -> bool:
    """Whether every place on the straight way from `a` to `b`, floor points `(2,)` or more, is free."""
    count = int(np.ceil(np.hypot(*(b - a)[:2]) / _CHECKED)) + 1
    return all(is_free(place) for place in np.linspace(a, b, count))


def _curve(knots: F64) -> F64:
    """A Catmull-Rom curve through `(N, D)` knots as `(M, D)` close points; ends are mirrored."""
    padded = np.vstack([2 * knots[0] - knots[1], knots, 2 * knots[-1] - knots[-2]])
    t = np.linspace(0, 1, _SAMPLES, endpoint=False)[:, None]
    pieces = [_piece(padded[i : i + 4], t) for i in range(len(knots) - 1)]
    return np.vstack([*pieces, knots[-1:]])


def _piece(p: F64, t: F64) -> F64:
    along = (p[2] - p[0]) * t
    square = (2 * p[0] - 5 * p[1] + 4 * p[2] - p[3]) * t**2
    cube = (3 * p[1] - p[0] - 3 * p[2] + p[3]) * t**3
    return np.asarray(p[1] + 0.5 * (along + square + cube))
