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
    graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    _, labels = connected_components(graph, directed=False)
    return np.asarray(labels, np.int64)
