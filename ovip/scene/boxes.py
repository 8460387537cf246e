"""Axis-aligned 3D boxes as `(..., 6)` arrays: low corner, then high corner, metres.

`pair_*` take boxes pair by pair (and broadcast), `pairwise_*` every one of M with every one of N.
"""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32, F64, Bools


def box_of(points: F32 | F64) -> F64:
    """The box `(6,)` around `(N, 3)` points; N >= 1."""
    return np.asarray(np.concatenate([points.min(axis=0), points.max(axis=0)]), np.float64)


def volume(boxes: F64) -> F64:
    """Volume of `(..., 6)` boxes -> `(...)` cubic metres; 0 for a box with no extent along some axis."""
    return np.asarray(np.prod(np.maximum(boxes[..., 3:] - boxes[..., :3], 0.0), axis=-1), np.float64)


def pair_intersection(a: F64, b: F64) -> F64:
    """Shared volume of each pair of `(..., 6)` and `(..., 6)` boxes -> `(...)`."""
    low = np.maximum(a[..., :3], b[..., :3])
    high = np.minimum(a[..., 3:], b[..., 3:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=-1), np.float64)


def pair_iou(a: F64, b: F64) -> F64:
    """Volume IoU of each pair of `(..., 6)` and `(..., 6)` boxes -> `(...)`; 0 where both are empty."""
    shared = pair_intersection(a, b)
    union = volume(a) + volume(b) - shared
    return np.divide(shared, union, out=np.zeros_like(shared), where=union > 0)


def pair_giou(a: F64, b: F64) -> F64:
    """Generalised IoU of each pair of boxes -> `(...)` in (-1, 1] (Rezatofighi et al. 2019).

    IoU - (hull - union) / hull, hull the volume of the box around both; IoU where the hull is empty.
    """
    shared = pair_intersection(a, b)
    union = volume(a) + volume(b) - shared
    low = np.minimum(a[..., :3], b[..., :3])
    high = np.maximum(a[..., 3:], b[..., 3:])
    hull = np.asarray(np.prod(high - low, axis=-1), np.float64)
    missing = np.divide(hull - union, hull, out=np.zeros_like(hull), where=hull > 0)
    return pair_iou(a, b) - np.maximum(missing, 0.0)  # rounding must not make a pair better than its IoU


def pair_touching(a: F64, b: F64) -> Bools:
    """Which pairs of `(..., 6)` and `(..., 6)` boxes share a volume -> `(...)`."""
    return np.asarray(((a[..., :3] < b[..., 3:]) & (a[..., 3:] > b[..., :3])).all(axis=-1))


def pairwise_touching(a: F64, b: F64) -> Bools:
    """Which of `(M, 6)` boxes share a volume with which of `(N, 6)` -> `(M, N)`."""
    return pair_touching(a[:, None], b[None])


def pairwise_iou(a: F64, b: F64) -> F64:
    """Volume IoU of `(M, 6)` and `(N, 6)` boxes -> `(M, N)`; 0 where both are empty."""
    return pair_iou(a[:, None], b[None])


def hull(a: F64, b: F64) -> F64:
    """The box around each pair of `(..., 6)` and `(..., 6)` boxes."""
    return np.concatenate([np.minimum(a[..., :3], b[..., :3]), np.maximum(a[..., 3:], b[..., 3:])], axis=-1)


def transformed_bounds(box: F64, transform: F64) -> F64:
    """Axis-aligned bounds `(6,)` of a box whose eight corners went through a 4x4 rigid transform."""
    low, high = box[:3], box[3:]
    pick = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
    corners = np.where(pick, high, low) @ transform[:3, :3].T + transform[:3, 3]
    return box_of(corners)
