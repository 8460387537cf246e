"""Voxels: points binned on a world-aligned cubic grid."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32, F64, I32, I64, U8

_BITS = 21  # per axis: +-1,048,576 voxels, 20 km at 2 cm
_OFFSET = 1 << (_BITS - 1)


def voxel_keys(points: F32 | F64, size: float) -> I64:
    """One int64 key `(N,)` per point `(N, 3)`: the voxel of edge `size` metres that holds it."""
    return pack_cells(np.floor(np.asarray(points, np.float64) / size).astype(np.int64))


def pack_cells(cells: I64 | I32) -> I64:
    """One int64 key `(N,)` per integer cell `(N, 3)`; cells in order of x, then y, then z have ascending keys."""
    shifted = cells.astype(np.int64) + _OFFSET
    return (shifted[:, 0] << (2 * _BITS)) | (shifted[:, 1] << _BITS) | shifted[:, 2]


def voxel_cells(keys: I64) -> I32:
    """Integer cells `(N, 3)` of keys made by `voxel_keys`."""
    return np.stack(voxel_columns(keys), axis=1).astype(np.int32)


def voxel_columns(keys: I64) -> tuple[I64, I64, I64]:
    """x, y and z `(N,)` of the integer cells of keys made by `voxel_keys`."""
    low = (1 << _BITS) - 1
    return (keys >> (2 * _BITS)) - _OFFSET, ((keys >> _BITS) & low) - _OFFSET, (keys & low) - _OFFSET


def downsample(points: F32, size: float, colors: U8 | None = None) -> tuple[F32, U8 | None]:
    """Mean point (and mean colour) of each occupied voxel, ordered by voxel key: `(M, 3)`, `(M, 3)` or None."""
    if len(points) == 0:
        return points.astype(np.float32), colors
    _, inverse, counts = np.unique(voxel_keys(points, size), return_inverse=True, return_counts=True)
    means = group_sums(points.astype(np.float64), inverse, len(counts)) / counts[:, None]
    if colors is None:
        return means.astype(np.float32), None
    tints = group_sums(colors.astype(np.float64), inverse, len(counts)) / counts[:, None]
    return means.astype(np.float32), np.rint(tints).astype(np.uint8)


def group_sums(values: F64, group: I64, groups: int) -> F64:
    """Sum of `(N, K)` rows by group index `(N,)` -> `(groups, K)`."""
    return np.stack([np.bincount(group, weights=column, minlength=groups) for column in values.T], axis=1)
