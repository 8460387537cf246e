"""Meshes put together from boxes, turned bodies, tubes and soft bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lab.simulation.catalogue.palette import material
from lab.simulation.home import Material, Mesh
from ovip.scene.types import F64, I32

Point = tuple[float, float, float]
MAIN = "main"
"""The finish that a model's attribute changes; always material 0."""


class Sculpt:
    """A model being put together in metres: x right, y back (its front faces -y), z up from its foot.

    finish: what "main" looks like; every other finish is a name that `palette.material` knows.
    """

    def __init__(self, finish: str) -> None:
        self._finishes = [MAIN]
        self._main = material(finish)
        self._grids: list[tuple[F64, F64, F64, int]] = []

    def box(self, center: Point, size: Point, finish: str = MAIN, whole: bool = False) -> None:
        """An upright box of full `size`. Pictures are half a metre wide, or fill each face if `whole`."""
        half = np.asarray(size) / 2
        for axis in range(3):
            a, b = ((1, 2), (0, 2), (0, 1))[axis]
            for sign in (-1.0, 1.0):
                self._face(np.asarray(center, np.float64), half, (axis, a, b), sign, finish, whole)

    def turned(
        self,
        profile: Sequence[tuple[float, float]],
        center: Point = (0.0, 0.0, 0.0),
        finish: str = MAIN,
        axis: str = "z",
        smooth: bool = False,
        sides: int = 20,
    ) -> None:
        """A body turned about an axis through `center`: `(radius, height)` pairs from its foot up, outside."""
        ring = np.linspace(0, 2 * np.pi, sides + 1)
        points = np.asarray(profile, np.float64)
        steps = np.diff(points, axis=0)
        slopes = np.stack([steps[:, 1], -steps[:, 0]], axis=1)
        slopes /= np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-12)
        ends = _shared(slopes) if smooth else None
        for i in range(len(steps)):
            rows = points[i : i + 2]
            slope = ends[i : i + 2] if ends is not None else np.repeat(slopes[i : i + 1], 2, axis=0)
            self._ring(rows, slope, ring, center, axis, finish)

    def cylinder(
        self, foot: Point, radius: float, height: float, finish: str = MAIN, axis: str = "z", sides: int = 20
    ) -> None:
        """A closed cylinder of `height` along an axis from `foot`."""
        profile = ((0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height))
        self.turned(profile, foot, finish, axis, sides=sides)

    def soft(self, center: Point, size: Point, finish: str = MAIN, power: float = 0.5) -> None:
        """A rounded body of full `size`: power 1 is an ellipsoid, toward 0 a box with round edges."""
        rows = 7 if max(size) < 0.12 else 11
        u = np.linspace(-np.pi / 2, np.pi / 2, rows)[:, None]
        v = np.linspace(-np.pi, np.pi, 2 * rows - 1)[None, :]
        axes = (
            np.cos(u) * np.cos(v),
            np.cos(u) * np.sin(v),
            np.broadcast_to(np.sin(u), (rows, 2 * rows - 1)),
        )
        cu, su, cv, sv = (_bent(f, power) for f in (np.cos(u), np.sin(u), np.cos(v), np.sin(v)))
        half = np.asarray(size) / 2
        points = np.stack([cu * cv * half[0], cu * sv * half[1], su * np.ones_like(v) * half[2]], axis=-1)
        bent = np.stack([_bent(axis, 2 - power) for axis in axes], axis=-1) / np.maximum(half, 1e-9)
        uv = np.stack(np.broadcast_arrays(v / np.pi, u / np.pi), axis=-1)
        self._add(points + np.asarray(center), _normalised(bent), uv, finish)

    def tube(self, path: Sequence[Point], radius: float, finish: str = MAIN, sides: int = 8) -> None:
        """A round bar along a path."""
        line = np.asarray(path, np.float64)
        ahead = _normalised(np.gradient(line, axis=0))
        up = np.where(np.abs(ahead[:, 2:]) > 0.9, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        side = _normalised(np.cross(ahead, up))
        over = np.cross(side, ahead)
        ring = np.linspace(0, 2 * np.pi, sides + 1)
        normals = np.cos(ring)[None, :, None] * side[:, None] + np.sin(ring)[None, :, None] * over[:, None]
        uv = np.stack(np.meshgrid(ring, np.arange(len(line), dtype=np.float64)), axis=-1) / 10
        self._add(line[:, None] + radius * normals, normals, uv, finish)

    def waves(self, center: Point, size: Point, count: int, finish: str = MAIN) -> None:
        """A hanging cloth of full `size` with `count` folds, seen from both sides."""
        x = np.linspace(-0.5, 0.5, count * 8 + 1)
        fold = np.sin(2 * np.pi * count * (x + 0.5)) * 0.5
        slope = np.cos(2 * np.pi * count * (x + 0.5)) * np.pi * count * size[1] / size[0]
        for side in (-1.0, 1.0):
            rows = [
                np.stack([x * size[0], fold * size[1], np.full_like(x, z)], 1)
                for z in (-size[2] / 2, size[2] / 2)
            ]
            normal = _normalised(np.stack([side * slope, np.full_like(x, -side), np.zeros_like(x)], 1))
            uv = np.stack([np.stack([x * size[0] * 2, np.full_like(x, z * 2)], 1) for z in (0.0, size[2])])
            self._add(np.stack(rows) + np.asarray(center), np.stack([normal, normal]), uv, finish)

    def mesh(self) -> Mesh:
        """Everything put together so far; material 0 is the main one."""
        vertices, triangles, normals, uv, ids, first = [], [], [], [], [], 0
        for points, normal, picture, finish in self._grids:
            faces = _grid_triangles(points, normal)
            vertices.append(points.reshape(-1, 3))
            triangles.append(faces + first)
            normals.append(normal.reshape(-1, 3)[faces])
            uv.append(picture.reshape(-1, 2)[faces])
            ids.append(np.full(len(faces), finish, np.int32))
            first += points.shape[0] * points.shape[1]
        return Mesh(
            vertices=np.concatenate(vertices).astype(np.float32),
            triangles=np.concatenate(triangles).astype(np.int32),
            normals=np.concatenate(normals).astype(np.float32),
            uv=np.concatenate(uv).astype(np.float32),
            material_ids=np.concatenate(ids),
            materials=self._materials(),
            object_ids=np.zeros(sum(len(i) for i in ids), np.uint16),
        )

    def _materials(self) -> tuple[Material, ...]:
        return (self._main, *(material(name) for name in self._finishes[1:]))

    def _face(
        self, center: F64, half: F64, axes: tuple[int, int, int], sign: float, finish: str, whole: bool
    ) -> None:
        axis, a, b = axes
        points = np.zeros((2, 2, 3))
        points[..., axis] = sign * half[axis]
        points[..., a] = np.array([[-1, 1], [-1, 1]]) * half[a]
        points[..., b] = np.array([[-1, -1], [1, 1]]) * half[b]
        normals = np.zeros((2, 2, 3))
        normals[..., axis] = sign
        square = np.array([[[0.0, 0.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 1.0]]])
        uv = square if whole else square * (half[[a, b]] * 4)
        self._add(points + center, normals, uv, finish)

    def _ring(self, rows: F64, slope: F64, ring: F64, center: Point, axis: str, finish: str) -> None:
        cos, sin = np.cos(ring), np.sin(ring)
        points = np.stack([_around(cos, sin, r, z) for r, z in rows])
        normals = np.stack([_around(cos, sin, r, z) for r, z in slope])
        reach = max(float(np.abs(rows[:, 0]).max()), 1e-6)
        across = ring / (2 * np.pi) * np.ceil(2 * np.pi * reach * 2)
        uv = np.stack([np.stack([across, np.full_like(ring, 2 * (z + r))], axis=1) for r, z in rows])
        order = {"z": (0, 1, 2), "y": (0, 2, 1), "x": (2, 1, 0)}[axis]
        self._add(points[..., order] + np.asarray(center), normals[..., order], uv, finish)

    def _add(self, points: F64, normals: F64, uv: F64, finish: str) -> None:
        if finish not in self._finishes:
            self._finishes.append(finish)
        self._grids.append((points, normals, uv, self._finishes.index(finish)))


def _grid_triangles(points: F64, normals: F64) -> I32:
    """Triangles of a grid `(M, N, 3)` without the ones that have shrunk to a line, wound as its normals look."""
    rows, columns = points.shape[:2]
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    corners = points.reshape(-1, 3)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces, cross = faces[(seen := np.linalg.norm(cross, axis=1) > 1e-12)], cross[seen]
    away = np.einsum("ij,ij->i", cross, normals.reshape(-1, 3)[faces].mean(axis=1)) < 0
    faces[away] = faces[away][:, ::-1]
    triangles: I32 = faces.astype(np.int32)
    return triangles


def _shared(slopes: F64) -> F64:
    """A slope per profile point: the mean of the pieces that meet there."""
    ends = np.concatenate([slopes[:1], slopes[:-1] + slopes[1:], slopes[-1:]])
    return _normalised(ends)


def _around(cos: F64, sin: F64, radius: float, height: float) -> F64:
    return np.stack([radius * cos, radius * sin, np.full_like(cos, height)], axis=1)


def _bent(values: F64, power: float) -> F64:
    bent: F64 = np.sign(values) * np.abs(values) ** power
    return bent


def _normalised(vectors: F64) -> F64:
    unit: F64 = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
    return unit
