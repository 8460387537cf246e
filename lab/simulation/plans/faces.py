"""Flat faces as meshes: boxes, and grids of cells with a thickness (walls with holes, floors with a stair's)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Material, Mesh
from ovip.scene.types import F64, I32, Bools


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """Quadrilaterals. corners: `(Q, 4, 3)` metres, around. outward: `(Q, 3)` unit normals."""

    corners: F64
    outward: F64


def box_faces(low: Sequence[float], high: Sequence[float]) -> Faces:
    """The six sides of an upright box."""
    return extruded(
        np.array([low[0], high[0]]), np.array([low[1], high[1]]), np.ones((1, 1), bool), (low[2], high[2])
    )


def extruded(
    us: F64, vs: F64, filled: Bools, across: tuple[float, float], axes: tuple[int, int, int] = (0, 1, 2)
) -> Faces:
    """The filled cells of a grid `(M, N)` made thick: both broad sides, and the sides of what is left open.

    us: `(M + 1,)`, vs: `(N + 1,)` metres along the world axes axes[0] and axes[1]; across: from where to where
    along axes[2].
    """
    i, j = np.nonzero(filled)
    u0, u1, v0, v1 = us[i], us[i + 1], vs[j], vs[j + 1]
    parts = [_broad(u0, u1, v0, v1, across[0], -1.0), _broad(u0, u1, v0, v1, across[1], 1.0)]
    wide = np.pad(filled, 1)
    for di, dj in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        bare = ~wide[i + 1 + di, j + 1 + dj]
        parts.append(_narrow(u0[bare], u1[bare], v0[bare], v1[bare], across, (di, dj)))
    corners = np.concatenate([corner for corner, _ in parts])
    outward = np.concatenate([normal for _, normal in parts])
    order = np.argsort(axes)
    return Faces(corners[:, :, order], outward[:, order])


def faces_mesh(
    faces: Sequence[Faces],
    materials: Sequence[Material],
    material_ids: I32,
    object_id: int,
    grain: float = 1.0,
) -> Mesh:
    """One object's faces as triangles.

    material_ids: `(Q,)` of all faces in turn. grain: metres that a texture spans; it goes on over seams between
    faces of one plane.
    """
    corners = np.concatenate([part.corners for part in faces])
    outward = np.concatenate([part.outward for part in faces])
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    backward = (turned * outward).sum(axis=1) < 0
    corners[backward] = corners[backward][:, ::-1]
    count = len(corners)
    split = np.array([[0, 1, 2], [0, 2, 3]])
    triangles = (4 * np.arange(count)[:, None, None] + split[None]).reshape(-1, 3)
    flat = corners.reshape(-1, 3)
    plane = np.abs(outward).argmax(axis=1)
    shown = np.array([[1, 2], [0, 2], [0, 1]])[plane]
    uv = np.take_along_axis(corners, shown[:, None, :].repeat(4, axis=1), axis=2).reshape(-1, 2) / grain
    return Mesh(
        vertices=flat.astype(np.float32),
        triangles=triangles.astype(np.int32),
        normals=np.repeat(outward, 2, axis=0)[:, None, :].repeat(3, axis=1).astype(np.float32),
        uv=uv[triangles].astype(np.float32),
        material_ids=np.repeat(material_ids, 2).astype(np.int32),
        materials=tuple(materials),
        object_ids=np.full(2 * count, object_id, dtype=np.uint16),
    )


def _broad(u0: F64, u1: F64, v0: F64, v1: F64, at: float, sign: float) -> tuple[F64, F64]:
    w = np.full_like(u0, at)
    corners = np.stack(
        [np.stack(p, axis=1) for p in ((u0, v0, w), (u1, v0, w), (u1, v1, w), (u0, v1, w))], axis=1
    )
    return corners, np.tile([0.0, 0.0, sign], (len(u0), 1))


def _narrow(
    u0: F64, u1: F64, v0: F64, v1: F64, across: tuple[float, float], way: tuple[int, int]
) -> tuple[F64, F64]:
    """The side of each cell that looks `way`."""
    ua, ub = (u0, u1) if way[0] == 0 else ((u0, u0) if way[0] < 0 else (u1, u1))
    va, vb = (v0, v1) if way[1] == 0 else ((v0, v0) if way[1] < 0 else (v1, v1))
    low, high = np.full_like(u0, across[0]), np.full_like(u0, across[1])
    corners = np.stack(
        [np.stack(p, axis=1) for p in ((ua, va, low), (ub, vb, low), (ub, vb, high), (ua, va, high))], axis=1
    )
    return corners, np.tile([float(way[0]), float(way[1]), 0.0], (len(u0), 1))
