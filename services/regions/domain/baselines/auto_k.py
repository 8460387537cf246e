"""auto-K: as many regions as k-means clusters of the objects' centres, their number chosen by silhouette.

The paper's naive selector ("AD auto-K"): K in 2..12, then each cluster's objects are the markers of a watershed of the
free space, as KGSW's seed groups are, so that the two differ in their seeds alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.cluster.vq import ClusterError, kmeans2
from scipy.spatial.distance import cdist

from ovip.scene.types import F64, I32, I64, Bools
from services.regions.domain.cells import nearest_cells
from services.regions.domain.flooding import clearance_of
from services.regions.domain.partition import (
    UNKNOWN_FUNCTION,
    PartitionParams,
    SeedGroup,
    grow,
    place_markers,
)


@dataclass(frozen=True, slots=True)
class AutoKParams:
    """fewest, most: the K that are tried. starts: seedings of k-means, of which the tightest counts."""

    fewest: int = 2
    most: int = 12
    starts: int = 8
    iterations: int = 50


@dataclass(frozen=True, slots=True)
class Clustering:
    """cluster: `(N,)`, each point's, from 0. silhouettes: of every K that could be tried."""

    cluster: I64
    silhouettes: dict[int, float]


def auto_k_rooms(
    free: Bools, cells: F64, seed: int, params: PartitionParams | None = None, k: AutoKParams | None = None
) -> tuple[I32, Clustering]:
    """Regions of free space F `(R, C)` about clusters of object centres `(N, 2)`, (row, column) -> `(R, C)`, 0 = none.

    params: the marker's radius, the growth and the grid. No regions where there are no objects or no free space.
    """
    params = params or PartitionParams()
    clustering = choose_k(np.asarray(cells, np.float64).reshape(-1, 2) * params.resolution, seed, k)
    if not free.any() or not len(clustering.cluster):
        return np.zeros(free.shape, np.int32), clustering
    whole = free.astype(np.int32)
    groups = tuple(
        SeedGroup(UNKNOWN_FUNCTION, 1, tuple(np.flatnonzero(clustering.cluster == number).tolist()))
        for number in range(int(clustering.cluster.max()) + 1)
    )
    markers = place_markers(whole, nearest_cells(cells, free), groups, params)
    return grow(clearance_of(free, params.resolution), whole, markers, groups, params), clustering


def choose_k(points: F64, seed: int, params: AutoKParams | None = None) -> Clustering:
    """k-means of `(N, 2)` points with the K of highest silhouette; ties go to the smaller K.

    One cluster where fewer than three points differ; none of no points. Equal seeds give equal clusters.
    """
    params = params or AutoKParams()
    distinct = len(np.unique(points, axis=0)) if len(points) else 0
    distance = cdist(points, points)
    best, silhouettes = np.zeros(len(points), np.int64), dict[int, float]()
    for k in range(params.fewest, min(params.most, distinct - 1) + 1):
        cluster = _kmeans(points, k, np.random.default_rng([seed, k]), params)
        if cluster is None:
            continue
        score = silhouette(distance, cluster)
        best = best if score <= max(silhouettes.values(), default=-np.inf) else cluster
        silhouettes[k] = score
    return Clustering(best, silhouettes)


def silhouette(distance: F64, cluster: I64) -> float:
    """Mean over points of (b - a) / max(a, b) from distances `(N, N)` and clusters `(N,)` of at least two values.

    a: mean distance to the others of its cluster; b: to the nearest other cluster's. A point alone counts 0.
    """
    members = (cluster[:, None] == np.arange(int(cluster.max()) + 1)[None]).astype(np.float64)
    size, total = members.sum(axis=0), distance @ members
    own = members.astype(bool)
    a = total[own] / np.maximum(size[cluster] - 1, 1)
    b = np.where(own | (size == 0), np.inf, total / np.maximum(size, 1)).min(axis=1)
    values = np.where(size[cluster] > 1, (b - a) / np.maximum(np.maximum(a, b), 1e-12), 0.0)
    return float(values.mean())


def _kmeans(points: F64, k: int, rng: np.random.Generator, params: AutoKParams) -> I64 | None:
    """The tightest of several runs; None where every one lost a cluster."""
    best, least = None, np.inf
    for _ in range(params.starts):
        try:
            centres, cluster = kmeans2(
                points, _spread(points, k, rng), iter=params.iterations, minit="matrix", missing="raise"
            )
        except ClusterError:
            continue
        spread = float(((points - centres[cluster]) ** 2).sum())
        if spread < least - 1e-9:
            best, least = np.asarray(cluster, np.int64), spread
    return best


def _spread(points: F64, k: int, rng: np.random.Generator) -> F64:
    """k-means++: each next centre a point drawn by its squared distance to the nearest one so far -> `(k, 2)`."""
    chosen = [int(rng.integers(len(points)))]
    while len(chosen) < k:
        squared = cdist(points, points[chosen]).min(axis=1) ** 2
        chosen.append(int(rng.choice(len(points), p=squared / squared.sum())))
    return points[chosen]
