"""Identity: regions keep their ids to the next partition by how much floor they share (Hungarian).

An id that vanishes is gone for good: no other region gets it, and neither does its own place should it become
a region again. Whoever held it goes by the event that says what its floor became part of.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from ovip.scene.grid import FloorGrid
from ovip.scene.types import I32, I64, U16


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
    share at least `min_share` of the smaller one. So of a region that splits, the part with most of its floor
    keeps the id; of regions that merge, the one that gives most floor. Both grids lie on the world's own
    lattice of cells.
    """
    kept = _matches(labels, count, origin, before, min_share) if before is not None and count else {}
    ids = []
    for number in range(count):
        if number not in kept:
            kept[number] = f"r{next_number}"
            next_number += 1
        ids.append(kept[number])
    return Named(tuple(ids), next_number)


def shared_cells(labels: I32 | U16, count: int, origin: tuple[float, float], before: FloorGrid | None) -> I64:
    """Cells in common of each label of R `(R, C)` and each of an older grid -> `(1 + count, 1 + K)`.

    Row 0: no region now. Column 0: none before, where the older grid does not reach or there is none included.
    Every cell of R counts once, so a row's sum is the region's size; a column's is what of it R still covers.
    """
    known = len(before.region_ids) if before is not None else 0
    old = np.zeros(labels.shape, np.int32)
    if before is not None:
        here, there = _overlap(labels.shape, origin, before)
        old[here] = before.regions[there]
    pairs = labels.astype(np.int32) * np.int32(known + 1) + old
    counts: I64 = np.bincount(pairs.ravel(), minlength=(count + 1) * (known + 1))
    return counts.reshape(count + 1, known + 1)


def _matches(
    labels: I32, count: int, origin: tuple[float, float], before: FloorGrid, min_share: float
) -> dict[int, str]:
    together = shared_cells(labels, count, origin, before)
    shared, size = together[1:, 1:], together[1:].sum(axis=1)
    size_before = np.bincount(before.regions.ravel(), minlength=len(before.region_ids) + 1)[1:]
    smaller = np.minimum(size[:, None], size_before[None])
    rows, columns = linear_sum_assignment(shared, maximize=True)
    return {
        int(row): before.region_ids[column]
        for row, column in zip(rows, columns, strict=True)
        if shared[row, column] > 0 and shared[row, column] >= min_share * smaller[row, column]
    }


def _overlap(
    shape: tuple[int, ...], origin: tuple[float, float], before: FloorGrid
) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """The cells that both grids have, as slices of the new one and of the old one."""
    offset = np.round((np.asarray(origin) - np.asarray(before.origin)) / before.resolution).astype(int)[::-1]
    low = np.maximum(0, -offset)
    high = np.maximum(low, np.minimum(shape, np.asarray(before.regions.shape) - offset))
    here = slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1]))
    low, high = low + offset, high + offset
    return here, (slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1])))
