"""Makes surfaces of rooms, as depth cameras see them: one point about every few centimetres."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32, F64

STEP = 0.04

Corners = tuple[float, float, float, float, float, float]


def room(width: float, depth: float, *things: Corners, height: float = 2.4) -> F32:
    """Floor and walls `width` x `depth` metres with boxes in it, each low and high corner; no ceiling."""
    walls = _faces(0, 0, 0, width, depth, height, top=False)
    return np.concatenate([walls, *(_faces(*thing, top=True) for thing in things)]).astype(np.float32)


def moved(points: F32, pose: F64) -> F32:
    """Points moved by a rigid `(4, 4)`."""
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3], np.float32)


def resampled(points: F32, seed: int, noise: float = 0.003, share: float = 0.7) -> F32:
    """Another look at the same surface: other points of it, each a little off."""
    rng = np.random.default_rng(seed)
    some = points[rng.random(len(points)) < share]
    return np.asarray(some + rng.normal(0, noise, some.shape), np.float32)


def _faces(x0: float, y0: float, z0: float, x1: float, y1: float, z1: float, top: bool) -> F64:
    """The four sides of a box, and its top, or its bottom."""
    x, y, z = (np.arange(a, b + STEP / 2, STEP) for a, b in ((x0, x1), (y0, y1), (z0, z1)))
    plan = np.stack(np.meshgrid(x, y, [z1 if top else z0], indexing="ij"), axis=-1).reshape(-1, 3)
    along_x = np.stack(np.meshgrid(x, [y0, y1], z, indexing="ij"), axis=-1).reshape(-1, 3)
    along_y = np.stack(np.meshgrid([x0, x1], y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.concatenate([plan, along_x, along_y])
