"""Integer counts by sorted key, and the keys of a lattice's boxes."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import I64

SPAN = 1 << 20
"""Indices of boxes lie in -SPAN .. SPAN - 1 along each axis."""


class Counts:
    """Integer counts by sorted int64 key; additions are merged late, which changes no count."""

    def __init__(self, keys: I64 | None = None, counts: I64 | None = None) -> None:
        self._keys: I64 = np.zeros(0, np.int64) if keys is None else keys
        self._counts: I64 = np.zeros(0, np.int64) if counts is None else counts
        self._pending: list[tuple[I64, I64]] = []
        self._waiting = 0

    def add(self, keys: I64, counts: I64 | None = None) -> None:
        """Adds `counts` (default 1 each) at `keys`; keys may repeat."""
        self._pending.append((keys, np.ones(len(keys), np.int64) if counts is None else counts))
        self._waiting += len(keys)
        if self._waiting > max(100_000, len(self._keys)):
            self._merge()

    def items(self) -> tuple[I64, I64]:
        """Sorted distinct keys `(K,)` and their counts `(K,)`."""
        self._merge()
        return self._keys, self._counts

    def _merge(self) -> None:
        if not self._pending:
            return
        keys = np.concatenate([self._keys, *(keys for keys, _ in self._pending)])
        counts = np.concatenate([self._counts, *(counts for _, counts in self._pending)])
        order = np.argsort(keys, kind="stable")
        keys, counts = keys[order], counts[order]
        first = np.flatnonzero(np.diff(keys, prepend=keys[:1] - 1)) if len(keys) else np.zeros(0, np.int64)
        self._keys = keys[first]
        self._counts = np.add.reduceat(counts, first) if len(first) else np.zeros(0, np.int64)
        self._pending, self._waiting = [], 0


def pack_voxel(index: I64) -> I64:
    """Integer voxel indices `(N, 3)` -> sortable keys `(N,)`, ordered by x, then y, then z."""
    shifted = index.astype(np.int64) + SPAN
    packed: I64 = (shifted[:, 0] << 42) | (shifted[:, 1] << 21) | shifted[:, 2]
    return packed


def unpack_voxel(keys: I64) -> I64:
    """The inverse of `pack_voxel`: keys `(N,)` -> indices `(N, 3)`."""
    low = (1 << 21) - 1
    return np.stack([keys >> 42, (keys >> 21) & low, keys & low], axis=1) - SPAN
