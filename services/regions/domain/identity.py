"""Identity: regions keep their ids to the next partition by how much floor they share (Hungarian)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from ovip.scene.grid import FloorGrid
from ovip.scene.types import I32, I64


@dataclass(frozen=True, slots=True)
class Named:
    """Ids of a storey's regions in the order of their labels, and the number of the next new id."""

    ids: tuple[str, ...]
    next_number: int


def keep_ids(
    labels: I32,
    count: int,
    origin: tuple[float, float],
    before: FloorGrid | None,
    next_number: int,
    min_share: float = 0.1,
) -> Named:
    """Ids `r1`, `r2`, .. for the `count` regions of R `(R, C)`: old ones kept, new ones counted on, none used
    twice.

    Old and new regions are matched so that the floor they share is largest in sum; a match counts where they
    share at least `min_share` of the smaller one. Both grids lie on the world's own lattice of cells.
    """
    kept = _matches(labels, count, origin, before, min_share) if before is not None and count else {}
    ids = []
    for number in range(count):
        if number not in kept:
            kept[number] = f"r{next_number}"
            next_number += 1
        ids.append(kept[number])
    return Named(tuple(ids), next_number)


def _matches(
    labels: I32, count: int, origin: tuple[float, float], before: FloorGrid, min_share: float
) -> dict[int, str]:
    shared = _shared_cells(labels, count, origin, before)
    size = np.bincount(labels.ravel(), minlength=count + 1)[1 : count + 1]
    size_before = np.bincount(before.regions.ravel(), minlength=len(before.region_ids) + 1)[1:]
    smaller = np.minimum(size[:, None], size_before[None])
    rows, columns = linear_sum_assignment(shared, maximize=True)
    return {
        int(row): before.region_ids[column]
        for row, column in zip(rows, columns, strict=True)
        if shared[row, column] > 0 and shared[row, column] >= min_share * smaller[row, column]
    }


def _shared_cells(labels: I32, count: int, origin: tuple[float, float], before: FloorGrid) -> I64:
    """Cells in common of each new and each old region -> `(count, K)`."""
    size = len(before.region_ids)
    shared = np.zeros((count, size), np.int64)
    offset = np.round((np.asarray(origin) - np.asarray(before.origin)) / before.resolution).astype(int)[::-1]
    at = np.argwhere(labels > 0)
    there = at + offset
    inside = ((there >= 0) & (there < before.regions.shape)).all(axis=1)
    new = labels[tuple(at[inside].T)].astype(np.int64) - 1
    old = before.regions[tuple(there[inside].T)].astype(np.int64) - 1
    np.add.at(shared, (new[old >= 0], old[old >= 0]), 1)
    return shared
