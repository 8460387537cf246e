"""Ray casting of solids into colour, z-depth and instance ids.

Each solid is tested only against the pixels its bounds can cover, which keeps a frame at a few hundredths of
a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from lab.simulation.solids import NEVER, Finish, Shape, Solid, hit, turned
from ovip.scene.camera import project
from ovip.scene.types import F32, F64, I64, U8, U16, Intrinsics

_LIGHT = np.array([-0.35, -0.45, 0.82], dtype=np.float32) / np.float32(np.linalg.norm([-0.35, -0.45, 0.82]))
_AMBIENT, _DIFFUSE = np.float32(0.72), np.float32(0.26)
_BOOK_TINTS = np.array(
    [
        [0.75, 0.2, 0.2],
        [0.2, 0.35, 0.7],
        [0.85, 0.8, 0.6],
        [0.25, 0.55, 0.3],
        [0.45, 0.3, 0.5],
        [0.9, 0.6, 0.2],
    ],
    dtype=np.float32,
)
_NEAR = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Rendering:
    """rgb: `(H, W, 3)` uint8. depth: `(H, W)` float32 metres. ids: `(H, W)` uint16. 0 = nothing."""

    rgb: U8
    depth: F32
    ids: U16


def render(solids: Sequence[Solid], k: Intrinsics, world_from_camera: F64, seed: int) -> Rendering:
    """What a camera at the pose sees; `seed` picks the grain of the surfaces."""
    origin = np.asarray(world_from_camera[:3, 3], dtype=np.float64)
    directions = _rays(k) @ world_from_camera[:3, :3].T.astype(np.float32)
    depth = np.full((k.height, k.width), NEVER, dtype=np.float32)
    nearest = np.full((k.height, k.width), -1, dtype=np.int64)
    for number, solid in enumerate(solids):
        part = _covered(solid, k, world_from_camera)
        if part is None:
            continue
        distance = hit(solid, origin, directions[part])
        closer = distance < depth[part]
        depth[part][closer] = distance[closer]
        nearest[part][closer] = number
    ids = np.array([*(solid.object_id for solid in solids), 0], dtype=np.uint16)[nearest]
    seen = nearest >= 0
    rgb = np.zeros((k.height, k.width, 3), dtype=np.uint8)
    points = origin.astype(np.float32) + directions[seen] * depth[seen][:, None]
    rgb[seen] = _shaded(solids, nearest[seen], points, seed)
    return Rendering(rgb, np.where(seen, depth, np.float32(0)), ids)


@lru_cache(maxsize=4)
def _rays(k: Intrinsics) -> F32:
    """Directions `(H, W, 3)` in camera axes with z = 1, so that distance along them is z-depth."""
    v, u = np.mgrid[: k.height, : k.width]
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=2).astype(np.float32)
    rays.flags.writeable = False
    return rays


def _covered(solid: Solid, k: Intrinsics, pose: F64) -> tuple[slice, slice] | None:
    """Rows and columns that the solid's bounds can cover; None where it is behind the camera or outside."""
    box = solid.bounds()
    corners = np.array([[box[x], box[y], box[z]] for x in (0, 3) for y in (1, 4) for z in (2, 5)])
    uv, z = project(corners, k, pose)
    if (z < _NEAR).all():
        return None
    if (z < _NEAR).any():
        return slice(0, k.height), slice(0, k.width)
    left, top = np.maximum(np.floor(uv.min(axis=0)), 0).astype(int)
    right, bottom = np.minimum(np.ceil(uv.max(axis=0)) + 1, (k.width, k.height)).astype(int)
    return (slice(top, bottom), slice(left, right)) if left < right and top < bottom else None


def _shaded(solids: Sequence[Solid], nearest: I64, points: F32, seed: int) -> U8:
    """Colours `(N, 3)` of points `(N, 3)` on the solids `nearest` `(N,)`: Lambert's law, grained surfaces."""
    centers = np.array([solid.center for solid in solids], dtype=np.float32)[nearest]
    halves = np.array([solid.half for solid in solids], dtype=np.float32)[nearest]
    yaws = np.array([solid.yaw for solid in solids], dtype=np.float32)[nearest]
    round_ = np.array([solid.shape is Shape.CYLINDER for solid in solids])[nearest]
    colors = np.array([solid.color for solid in solids], dtype=np.float32)[nearest]
    finish = np.array([solid.finish for solid in solids])[nearest]
    own = turned(points - centers, -yaws)
    normals = turned(np.where(round_[:, None], _round_normals(own, halves), _flat_normals(own, halves)), yaws)
    light = _AMBIENT + _DIFFUSE * np.maximum(normals @ _LIGHT, 0) + np.float32(0.03) * normals[:, 0]
    texture = _texture(own, finish, nearest, seed)
    return np.asarray(np.clip(colors * texture * light[:, None], 0, 255), dtype=np.uint8)


def _flat_normals(own: F32, halves: F32) -> F32:
    """Normals of a box `(N, 3)`: the axis along which the point is farthest out."""
    axis = np.abs(own / halves).argmax(axis=1)
    rows = np.arange(len(own))
    normals = np.zeros_like(own)
    normals[rows, axis] = np.sign(own[rows, axis])
    return normals


def _round_normals(own: F32, halves: F32) -> F32:
    """Normals of an upright cylinder `(N, 3)`: radial on its side, vertical on its ends."""
    radial = np.hypot(own[:, 0], own[:, 1]) / halves[:, 0]
    end = np.abs(own[:, 2]) / halves[:, 2] > radial
    side = (
        own
        * np.array([1, 1, 0], dtype=np.float32)
        / np.maximum(radial * halves[:, 0], np.float32(1e-6))[:, None]
    )
    cap = np.sign(own) * np.array([0, 0, 1], dtype=np.float32)
    return np.where(end[:, None], cap, side)


def _texture(own: F32, finish: I64, nearest: I64, seed: int) -> F32:
    """Brightness `(N, 3)` of surface points `(N, 3)` in their solid's axes: its finish and a fine grain."""
    grain = _noise(_cells(own, 0.03), nearest, seed)
    x, y, z = own.T
    wood = np.sin(60 * y + 4 * np.sin(5 * x) + 25 * z)
    scale = np.ones(len(own), dtype=np.float32)
    scale = np.where(finish == Finish.TILES, 0.86 + 0.14 * (_cells(own, 0.5).sum(axis=1) % 2), scale)
    scale = np.where(finish == Finish.WOOD, 0.94 + 0.06 * wood, scale)
    scale = np.where(finish == Finish.FABRIC, 0.92 + 0.08 * (_cells(own, 0.06).sum(axis=1) % 2), scale)
    out = np.repeat((scale * (0.96 + 0.06 * grain)).astype(np.float32)[:, None], 3, axis=1)
    books = finish == Finish.BOOKS
    spine = np.floor((x[books] + y[books]) / 0.045).astype(np.int64)
    out[books] *= _BOOK_TINTS[(spine * 7 + spine // 3 + nearest[books]) % len(_BOOK_TINTS)]
    return out


def _cells(own: F32, size: float) -> I64:
    """The cube `(N, 3)` that each point lies in; a surface between two cubes belongs to one of them."""
    return np.asarray(np.floor(own / np.float32(size) + np.float32(1e-3)), dtype=np.int64)


def _noise(cell: I64, salt: I64, seed: int) -> F32:
    """A number in 0..1 `(N,)` for each cell `(N, 3)`, always the same one."""
    mixed = (cell * np.array([73856093, 19349663, 83492791])).sum(axis=1) ^ (salt * 2654435761 + seed * 40503)
    mixed = (mixed ^ (mixed >> 13)) * 1274126177 & 0xFFFFFFFF
    return np.asarray(((mixed ^ (mixed >> 16)) & 0xFFFF) / 65535, dtype=np.float32)
