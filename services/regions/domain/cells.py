"""Cells: points of the world on a storey's grid, and the nearest cell or region to each."""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from ovip.scene.types import F64, I32, I64, Bools


def cells_of(points: F64, origin: tuple[float, float], resolution: float) -> F64:
    """World points `(N, 2 or 3)` as (row, column) with cell centres at integers -> `(N, 2)`."""
    cells: F64 = (points[:, 1::-1] - np.asarray(origin)[::-1]) / resolution - 0.5
    return cells


def nearest_cells(cells: F64, target: Bools) -> I64:
    """The nearest cell of `target` `(R, C)` to each of `(N, 2)` cells -> `(N, 2)`; -1 where `target` is empty.

    Ties go to the first such cell in row-major order. What lies in the target is found at once; else the nearest is on
    the target's rim, which is all that is searched.
    """
    cells = np.asarray(cells, dtype=np.float64).reshape(-1, 2)
    if not len(cells) or not target.any():
        return np.full(cells.shape, -1, dtype=np.int64)
    nearest: I64 = np.ceil(cells - 0.5).astype(np.int64)
    within = ((nearest >= 0) & (nearest < target.shape)).all(axis=1)
    held = np.zeros(len(cells), dtype=bool)
    held[within] = target[tuple(nearest[within].T)]
    if not held.all():
        nearest[~held] = _on_rim(cells[~held], target)
    return nearest


def labels_at(labels: I32, cells: F64) -> I64:
    """The label at, or nearest to, each of `(N, 2)` (row, column) cells, from 0 -> `(N,)`; -1 for none at all."""
    places = nearest_cells(cells, labels > 0)
    if not len(places) or places[0, 0] < 0:
        return np.full(len(places), -1, dtype=np.int64)
    found: I64 = labels[tuple(places.T)].astype(np.int64) - 1
    return found


def _on_rim(cells: F64, target: Bools) -> I64:
    inner = ndimage.binary_erosion(target, np.ones((3, 3)))
    rim = np.argwhere(target & ~inner)
    tree = cKDTree(rim)
    distance, _ = tree.query(cells)
    first = [min(near) for near in tree.query_ball_point(cells, distance + 1e-6)]
    found: I64 = rim[first].astype(np.int64)
    return found
