"""Where a camera stands, where it looks, and its way between: pure geometry on the floor."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from ovip.scene.types import F64

SAMPLE = 0.02  # metres between points of a way
_SMOOTH = 0.15  # metres over which corners are rounded
_AHEAD = 1.0  # metres after and before a stop in which the camera turns to and from the way ahead


def best_places(places: F64, targets: F64, weights: F64, count: int) -> F64:
    """`count` of `(P, 2)` places from which `(T, 2)` targets of some weight `(T,)` are seen best -> `(count, 2)`.

    Greedy: each next place gains most. A target counts less the more often it is seen, least from a like direction;
    best at 0.8 to 2.5 m. Ties go to the first.
    """
    away = targets[None] - places[:, None]
    distance = np.linalg.norm(away, axis=2)
    value = np.clip(distance / 0.8, 0, 1) ** 2 * np.clip(2.5 / np.maximum(distance, 1e-6), 0, 1) ** 2
    direction = away / np.maximum(distance, 1e-6)[..., None]
    wanted = np.broadcast_to(weights, value.shape).copy()
    chosen: list[int] = []
    while len(chosen) < min(count, len(places)):
        gain = (value * wanted).sum(axis=1)
        gain[chosen] = -1
        chosen.append(int(np.argmax(gain)))
        alike = (direction * direction[chosen[-1]]).sum(axis=2)
        wanted *= 1 - value[chosen[-1]] * (0.5 + 0.5 * np.clip(alike, 0, 1))
    return places[chosen]


def arc_over(angles: F64, margin: float, widest: float) -> tuple[float, float]:
    """The shortest turn that sweeps all of `(N,)` directions, less `margin` at either end, at most `widest` radians."""
    angles = np.sort(angles)
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    largest = int(np.argmax(gaps))
    start, width = angles[(largest + 1) % len(angles)], 2 * np.pi - gaps[largest]
    sweep = min(max(width - 2 * margin, 0.0), widest)
    middle = start + width / 2
    return float(middle - sweep / 2), float(middle + sweep / 2)


def sampled(way: F64) -> F64:
    """Points `(M, 2)` along a polyline `(N, 2)`, `SAMPLE` apart."""
    length = np.append(0, np.cumsum(np.hypot(*np.diff(way, axis=0).T)))
    at = np.linspace(0, length[-1], int(length[-1] / SAMPLE) + 1)
    return np.stack([np.interp(at, length, column) for column in way.T], axis=1)


def rounded(points: F64) -> F64:
    """The way with its corners rounded; its ends stay."""
    if len(points) < 8:
        return points
    mirrored = np.vstack([2 * points[0] - points[:0:-1], points, 2 * points[-1] - points[-2::-1]])
    smooth = ndimage.gaussian_filter1d(mirrored, _SMOOTH / SAMPLE, axis=0)
    return np.asarray(smooth[len(points) - 1 : 2 * len(points) - 1])


def headings(points: F64) -> F64:
    """Direction of the way at each of its points `(N,)`, unwrapped."""
    if len(points) < 2:
        return np.zeros(len(points))
    step = np.gradient(points, axis=0)
    return np.unwrap(np.arctan2(step[:, 1], step[:, 0]))


def gaze(points: F64, along: F64, start: float, end: float) -> F64:
    """Yaw at each point: from `start` to looking ahead and on to `end`; straight over where the way is short."""
    count = len(points)
    length = (count - 1) * SAMPLE
    if length < 2 * _AHEAD:
        return start + turn_to(start, end) * np.linspace(0, 1, count)
    ahead = start + turn_to(start, along[0]) + (along - along[0])
    target = ahead[-1] + turn_to(ahead[-1], end)
    done = np.arange(count) * SAMPLE
    leaving = _eased(done / _AHEAD)
    arriving = _eased((done - (length - _AHEAD)) / _AHEAD)
    looking = start + leaving * (ahead - start)
    return np.asarray(looking + arriving * (target - looking))


def _eased(t: npt.ArrayLike) -> F64:
    t = np.clip(np.asarray(t, np.float64), 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def turn_to(a: float, b: float) -> float:
    """The shorter way from angle a to angle b."""
    return float((b - a + np.pi) % (2 * np.pi) - np.pi)
