"""An object's geometry as voxel sums: merging costs the new points only (SPEC 2.4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.boxes import box_of
from ovip.scene.types import F32, F64, I64, U8, Bools
from ovip.scene.voxels import group_sums, voxel_keys


@dataclass(frozen=True, slots=True)
class VoxelCloud:
    """Per occupied voxel, sorted by key: keys `(V,)`, counts `(V,)`, sums `(V, 6)` of x y z r g b.

    Sums add, so the order of merges does not change a voxel's mean beyond rounding.
    """

    keys: I64
    counts: I64
    sums: F64

    @classmethod
    def of(cls, points: F32, colors: U8, size: float) -> VoxelCloud:
        """Points `(N, 3)` metres with colours `(N, 3)`, binned in voxels of edge `size`."""
        keys, inverse, counts = np.unique(voxel_keys(points, size), return_inverse=True, return_counts=True)
        rows = np.concatenate([points.astype(np.float64), colors.astype(np.float64)], axis=1)
        return cls(keys, counts.astype(np.int64), group_sums(rows, inverse, len(keys)))

    def __len__(self) -> int:
        return len(self.keys)

    @property
    def points(self) -> F32:
        """Mean point of each voxel `(V, 3)`."""
        return np.asarray(self.sums[:, :3] / self.counts[:, None], np.float32)

    @property
    def colors(self) -> U8:
        """Mean colour of each voxel `(V, 3)`."""
        return np.asarray(np.rint(self.sums[:, 3:] / self.counts[:, None]), np.uint8)

    @property
    def mean(self) -> F64:
        """Mean of the voxels' points and colours `(6,)`: every voxel counts once, however often it was seen."""
        means: F64 = (self.sums / self.counts[:, None]).mean(axis=0)
        return means

    @property
    def box(self) -> F64:
        """`(6,)` around the voxels' mean points."""
        return box_of(self.points)

    def merged(self, other: VoxelCloud) -> VoxelCloud:
        """Both clouds' sums added."""
        keys, inverse = np.unique(np.concatenate([self.keys, other.keys]), return_inverse=True)
        counts = np.zeros(len(keys), np.int64)
        sums = np.zeros((len(keys), 6))
        for part, at in ((self, inverse[: len(self)]), (other, inverse[len(self) :])):
            counts[at] += part.counts
            sums[at] += part.sums
        return VoxelCloud(keys, counts, sums)

    def kept(self, keep: Bools) -> VoxelCloud:
        """Only the voxels `keep` `(V,)` marks."""
        return VoxelCloud(self.keys[keep], self.counts[keep], self.sums[keep])
