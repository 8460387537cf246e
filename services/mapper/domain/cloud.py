"""An object's geometry as integer voxel sums: a merge costs the new points only, its order is all one (SPEC 2.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from ovip.scene.types import F32, F64, I32, I64, U8, Bools
from ovip.scene.voxels import pack_cells, voxel_cells, voxel_columns

MOST_VOXELS = 30_000
"""Voxels a cloud may have before it doubles their edge: a floor or wall need not be known as finely as a cup."""
_STEPS = 256  # a point's place in its voxel counts in 1/256 of the edge at level 0: 78 micrometres at 2 cm
_MOST_SEEN = 1 << 16  # points a voxel remembers; beyond, new ones count as in a running mean
_ROW = np.dtype((np.void, 28))
_COARSEST = 5  # so that two voxels that remember all they can still add in 32 bits


@dataclass(frozen=True, slots=True, eq=False)
class VoxelCloud:
    """Per occupied voxel, by key: keys `(V,)`; tally `(V, 7)` int32: points, sums of their place in it and of r g b.

    size: metres of an edge at level 0; level: edges are `size * 2**level`. Integers add exactly, so the same points
    give the same cloud in any order (up to 65,536 points a voxel, and while nothing is taken out).
    """

    keys: I64
    tally: I32
    size: float
    level: int = 0

    @classmethod
    def of(cls, points: F32, colors: U8, size: float) -> VoxelCloud:
        """Points `(N, 3)` metres with colours `(N, 3)`, binned in voxels of edge `size`; N >= 1."""
        return clouds_of([points], [colors], size)[0]

    def __len__(self) -> int:
        return len(self.keys)

    @property
    def edge(self) -> float:
        """Metres of a voxel's edge."""
        return self.size * (1 << self.level)

    @property
    def counts(self) -> I32:
        """Points in each voxel `(V,)`."""
        return self.tally[:, 0]

    @property
    def nbytes(self) -> int:
        """Bytes of its arrays."""
        return self.keys.nbytes + self.tally.nbytes

    @property
    def means(self) -> F64:
        """Mean point of each voxel `(V, 3)`."""
        inside = (self.tally[:, 1:4] / self.tally[:, :1] + 0.5) * (self.size / _STEPS)
        return np.asarray(voxel_cells(self.keys) * self.edge + inside, np.float64)

    @property
    def points(self) -> F32:
        """Mean point of each voxel `(V, 3)`."""
        return self.means.astype(np.float32)

    @property
    def colors(self) -> U8:
        """Mean colour of each voxel `(V, 3)`."""
        return np.rint(self.tally[:, 4:] / self.tally[:, :1]).astype(np.uint8)

    @property
    def mean(self) -> F64:
        """Mean of the voxels' points and colours `(6,)`: every voxel counts once, however often it was seen."""
        colors = (self.tally[:, 4:] / self.tally[:, :1]).mean(axis=0)
        return np.concatenate([self.means.mean(axis=0), colors])

    @property
    def box(self) -> F64:
        """`(6,)` around the voxels' mean points: those of the outermost voxels."""
        x, y, z = voxel_columns(self.keys)
        box = np.empty(6)
        for axis, column, ascending in ((0, x, True), (1, y, False), (2, z, False)):
            low, high = (column[0], column[-1]) if ascending else (column.min(), column.max())
            for side, outermost, most in ((0, low, np.min), (3, high, np.max)):
                rim = self.tally.take(np.flatnonzero(column == outermost), axis=0)
                inside = most(rim[:, 1 + axis] / rim[:, 0] + 0.5) * (self.size / _STEPS)
                box[side + axis] = outermost * self.edge + inside
        return box

    def merged(self, other: VoxelCloud) -> VoxelCloud:
        """Both clouds' sums added, at the coarser level of the two or coarser."""
        level = max(self.level, other.level)
        return _united(self.at_level(level), other.at_level(level)).bounded()

    def kept(self, keep: Bools) -> VoxelCloud:
        """Only the voxels `keep` `(V,)` marks."""
        tally = _rows(self.tally)[keep].view(np.int32).reshape(-1, 7)
        return VoxelCloud(self.keys[keep], tally, self.size, self.level)

    def bounded(self) -> VoxelCloud:
        """Itself, coarsened until it has at most MOST_VOXELS voxels."""
        cloud = self
        while len(cloud) > MOST_VOXELS and cloud.level < _COARSEST:
            cloud = cloud.coarser()
        return cloud

    def at_level(self, level: int) -> VoxelCloud:
        """Itself in voxels of a level at or above its own."""
        cloud = self
        while cloud.level < level:
            cloud = cloud.coarser()
        return cloud

    def coarser(self) -> VoxelCloud:
        """The same sums in voxels of twice the edge."""
        cells = voxel_cells(self.keys)
        tally = self.tally.copy()
        tally[:, 1:4] += (cells & 1) * (_STEPS << self.level) * tally[:, :1]
        keys, tally = _grouped(pack_cells(cells >> 1), tally)
        return VoxelCloud(keys, tally, self.size, self.level + 1)


def clouds_of(points: Sequence[F32], colors: Sequence[U8], size: float) -> list[VoxelCloud]:
    """A cloud of each `(N, 3)` points with their `(N, 3)` colours; all of them binned in one pass."""
    scaled = np.concatenate(points).astype(np.float64)
    scaled /= size
    cells = np.floor(scaled)
    scaled -= cells
    scaled *= _STEPS
    tally = np.empty((len(scaled), 7), np.int32)
    tally[:, 0] = 1
    tally[:, 1:4] = scaled
    tally[:, 4:] = np.concatenate(colors)
    keys = pack_cells(cells.astype(np.int64))
    ends = np.cumsum([0, *(len(p) for p in points)])
    return [
        VoxelCloud(*_grouped(keys[low:high], tally[low:high]), size).bounded() for low, high in pairwise(ends)
    ]


def _grouped(keys: I64, tally: I32) -> tuple[I64, I32]:
    """Rows of one key added up, by ascending key. What comes in order, a key once, passes as it is."""
    if (keys[1:] > keys[:-1]).all():
        return keys, tally
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    starts = np.flatnonzero(np.concatenate([[True], keys[1:] != keys[:-1]]))
    return keys[starts], _capped(np.add.reduceat(tally[order], starts, axis=0, dtype=np.int64))


def _united(a: VoxelCloud, b: VoxelCloud) -> VoxelCloud:
    """The sums of two clouds of one level; the smaller is looked up in the larger."""
    large, small = (a, b) if len(a) >= len(b) else (b, a)
    at = np.searchsorted(large.keys, small.keys)
    same = large.keys.take(at, mode="clip") == small.keys
    known, fresh = np.flatnonzero(same), np.flatnonzero(~same)
    new, old = at[fresh] + np.arange(len(fresh)), np.ones(len(large) + len(fresh), bool)
    old[new] = False
    keys, tally = np.empty(len(old), np.int64), np.empty((len(old), 7), np.int32)
    keys[old], keys[new] = large.keys, small.keys[fresh]
    rows = _rows(tally)
    rows[old], rows[new] = _rows(large.tally), _rows(small.tally)[fresh]
    both = np.flatnonzero(old)[at[known]]
    sums = tally.take(both, axis=0) + small.tally.take(known, axis=0)
    if (sums[:, 0] > _MOST_SEEN).any():
        sums = _capped(sums.astype(np.int64))
    rows[both] = _rows(sums)
    return VoxelCloud(keys, tally, a.size, a.level)


def _rows(tally: I32) -> npt.NDArray[np.void]:
    """A tally's rows `(V,)` each as one value: moved about at the speed of memory, which numbers by sevens are not."""
    return tally.view(_ROW)[:, 0]


def _capped(tally: I64) -> I32:
    """Voxels that saw more than they remember keep their means at the most they remember."""
    over = tally[:, 0] > _MOST_SEEN
    if over.any():
        tally[over] = tally[over] * _MOST_SEEN // tally[over, :1]
    return tally.astype(np.int32)
