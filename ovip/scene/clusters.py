"""Density clusters at one point: what is connected by steps of at most a radius (DBSCAN with one neighbour enough)."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ovip.scene.types import F32, F64, I64


def clusters(points: F32 | F64, radius: float) -> I64:
    """Cluster number `(N,)` of each of `(N, K)` points, numbered in order of their first point; none for no points."""
    if len(points) == 0:
        return np.zeros(0, np.int64)
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    return _connected(len(points), pairs[:, 0], pairs[:, 1])


def cell_clusters(cells: I64, groups: I64) -> I64:
    """Cluster number `(N,)` of each of `(N, 3)` whole-number cells, connected where they touch, by corners too.

    Cells of different groups `(N,)` (whole numbers from 0) never touch; the same cell may come many times. Numbers
    rise with the group, and inside it with the cluster's first cell (by x, then y, then z).

    What is connected by steps of at most a cell's edge always is one cluster, as in `clusters`; across a gap of two
    edges along some axis, or more, nothing is. In between it depends on where the grid lies.
    """
    if len(cells) == 0:
        return np.zeros(0, np.int64)
    low = cells.min(axis=0) - 1  # a border of one cell, so that no neighbour wraps around
    nx, ny, nz = (cells.max(axis=0) - low + 2).tolist()
    x, y, z = (cells - low).T
    keys = ((groups * nx + x) * ny + y) * nz + z
    order = np.argsort(keys)
    new = np.diff(keys[order], prepend=-1) > 0
    taken, node = keys[order[new]], np.empty(len(keys), np.int64)
    node[order] = np.cumsum(new) - 1
    links = [_touching(taken, (dx * ny + dy) * nz) for dx, dy in ((0, 1), (1, -1), (1, 0), (1, 1))]
    above = np.flatnonzero(np.diff(taken) == 1)
    a = np.concatenate([above, *(pair[0] for pair in links)])
    b = np.concatenate([above + 1, *(pair[1] for pair in links)])
    return _connected(len(taken), a, b)[node]


def _touching(taken: I64, step: int) -> tuple[I64, I64]:
    """Pairs of indices into sorted keys `(C,)` where the one lies a step and at most one up or down from the other.

    Of three in a row only the lowest is named: they touch one another.
    """
    wanted = taken + step
    first = np.searchsorted(taken, wanted - 1)
    padded = np.append(taken, [np.iinfo(np.int64).max] * 2)
    near = np.flatnonzero(padded[first] <= wanted + 1)
    apart = np.flatnonzero((padded[first] == wanted - 1) & (padded[first + 1] == wanted + 1))
    return np.concatenate([near, apart]), np.concatenate([first[near], first[apart] + 1])


def _connected(count: int, a: I64, b: I64) -> I64:
    """Component `(count,)` of each node, numbered in order of their first node. a, b: `(E,)` ends of the edges."""
    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    return np.asarray(labels, np.int64)
