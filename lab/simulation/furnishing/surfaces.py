"""Where things can stand on a model: its top, its seat, its boards; read off its own mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from lab.simulation.catalogue import Model
from lab.simulation.home import surface_points, triangle_areas
from ovip.scene.types import F32, F64, Bools

CELL = 0.02  # metres
_SPACING = 0.012  # of the sampled points
_SNAP = 0.05  # how far the true surface may be from what the catalogue says, metres
_NOTHING = -1e3


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """One height that carries things. floor: `(M, N)` float32, z of what is under each cell of the model's frame,
    very low for nothing. cover: `(M, N)`, z of the lowest thing above. origin: `(2,)` low corner of cell (0, 0).
    """

    level: float
    floor: F32
    cover: F32
    origin: F64

    def spots(self, width: float, depth: float, height: float, give: float) -> tuple[F64, F64]:
        """Where a box can stand: middles `(N, 2)` and the heights `(N,)` of its foot, in the model's frame.

        Under nine tenths of it there is the surface within `give` metres, and nothing is in its way.
        """
        kernel = np.ones((_cells(width), _cells(depth)), np.uint8)
        if kernel.shape[0] > self.floor.shape[0] or kernel.shape[1] > self.floor.shape[1]:
            return np.zeros((0, 2)), np.zeros(0)
        foot = cv2.dilate(self.floor, kernel, borderValue=_NOTHING)
        room = cv2.erode(self.cover, kernel, borderValue=0.0) - foot
        carried = (self.floor > self.level - give).astype(np.float32)
        share = cv2.boxFilter(carried, -1, kernel.shape[::-1], borderType=cv2.BORDER_CONSTANT)
        inside = cv2.erode(np.ones_like(carried), kernel, borderValue=0.0) > 0
        at = np.argwhere(inside & (share > 0.9) & (room >= height) & (foot < self.level + give))
        odd = np.array([kernel.shape[0] % 2, kernel.shape[1] % 2]) / 2
        return self.origin + (at + odd) * CELL, foot[at[:, 0], at[:, 1]].astype(np.float64)


def top_surface(model: Model, give: float) -> Surface | None:
    """The surface that the catalogue says things stand on; None for a model that carries nothing."""
    if model.top is None:
        return None
    points = surface_points(model.mesh, _SPACING)[0]
    heights = _highest(points, model)[0]
    near = heights[np.abs(heights - model.top) < _SNAP]
    level = model.top
    if len(near):
        counts, edges = np.histogram(
            near, bins=np.arange(model.top - _SNAP, model.top + _SNAP + 0.005, 0.005)
        )
        level = float(edges[counts.argmax() + 1])
    found = _at_level(points, model, level, give)
    # under what rises from it (a hutch, a shower's head) nothing is put: it may be closed
    return replace(found, cover=np.where(found.cover < -_NOTHING, found.floor, found.cover))


def boards(model: Model) -> tuple[Surface, ...]:
    """The boards inside an open shelf, lowest first, its top left out; and all that have no model.top."""
    points = surface_points(model.mesh, _SPACING)[0]
    flat = np.abs(model.mesh.normals[:, :, 2].mean(axis=1)) > 0.95
    heights = model.mesh.vertices[model.mesh.triangles[flat]][:, :, 2].mean(axis=1)
    counts, edges = np.histogram(
        heights,
        bins=np.arange(-0.005, model.size[2] + 0.02, 0.01),
        weights=triangle_areas(model.mesh)[flat],
    )
    wide = np.flatnonzero(counts > 0.3 * model.size[0] * model.size[1])
    levels = [heights[(heights >= edges[i]) & (heights <= edges[i + 1])].max() for i in wide]
    found = [
        _at_level(points, model, float(level), 0.006) for level in levels if level < model.size[2] - 0.12
    ]
    return tuple(surface for surface in found if _headroom(surface) > 0.15)


def hollow(model: Model) -> Surface:
    """The inside of a bowl, a basket or an open box: what is lowest seen from above."""
    points = surface_points(model.mesh, _SPACING)[0]
    heights, origin = _highest(points, model)
    cover = np.full_like(heights, -_NOTHING)
    middle = heights[
        heights.shape[0] // 4 : -heights.shape[0] // 4, heights.shape[1] // 4 : -heights.shape[1] // 4
    ]
    level = float(np.median(middle[middle > _NOTHING])) if (middle > _NOTHING).any() else 0.0
    return Surface(level, heights, cover, origin)


def _at_level(points: F32, model: Model, level: float, give: float) -> Surface:
    below = points[:, 2] <= level + give
    floor, origin = _highest(points[below], model)
    upside = points[~below] * np.array([1, 1, -1], np.float32)
    cover = -_highest(upside, model)[0]
    # a thing in the way is in the way of the cells beside it too
    return Surface(level, floor, cv2.erode(cover, np.ones((3, 3), np.uint8)), origin)


def _highest(points: F32, model: Model) -> tuple[F32, F64]:
    """z of the highest point over each cell of a model's footprint; small gaps of sampling are filled."""
    shape = (_cells(model.size[0]), _cells(model.size[1]))
    origin = -np.array(shape) * CELL / 2
    at = np.clip(((points[:, :2] - origin) / CELL).astype(np.int64), 0, np.array(shape) - 1)
    heights = np.full(shape, _NOTHING, np.float32)
    np.maximum.at(heights, (at[:, 0], at[:, 1]), points[:, 2])
    empty: Bools = heights == _NOTHING
    around = cv2.dilate(heights, np.ones((3, 3), np.uint8), borderValue=_NOTHING)
    return np.where(empty, around, heights).astype(np.float32), origin


def _headroom(surface: Surface) -> float:
    return float(np.median(surface.cover - surface.level))


def _cells(length: float) -> int:
    return max(1, int(np.ceil(length / CELL - 1e-6)))
