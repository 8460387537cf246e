"""Upkeep of what changed: cluttered voxels go, duplicates merge, noise is dropped (SPEC 2.6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ovip.scene.boxes import pair_intersection, volume
from ovip.scene.types import F64, I32, I64, Bools
from ovip.scene.voxels import pack_cells, voxel_cells
from services.mapper.domain.cloud import VoxelCloud

_HALF_THE_NEIGHBOURS = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)], np.int64
)


@dataclass(frozen=True, slots=True)
class UpkeepParams:
    """every: detection batches between upkeeps. merge_overlap: share of the smaller cloud that lies on the other.

    merge_inside: share of the smaller box's volume inside the other's, which decides where the clouds show opposite
    sides of a small thing and do not touch; merge_ratio: least volume of the smaller box in the larger one's, for that:
    opposite sides are of a size, a book on a larger book is not.
    merge_similarity: cosine that two objects to merge must have.
    merge_mutual: share of each of the two clouds that lies on the other, above which objects of different labels merge
    too: one thing under two names, while a cup that lies wholly on a table has no such share of the table on it.
    merge_veto: cosine of second features (DINO family) below which nothing merges.
    eager: merge what a batch made one at once, not at the next upkeep only.
    same_label: otherwise merge only objects of one majority label.
    reach: metres within which a point lies on another cloud.
    confirm_frames: frames that must see an object before readers get it.
    forget_after: batches without a view after which an unconfirmed object is dropped.
    cluster_radius: metres between voxels of one cluster; smaller clusters than `cluster_share` of the largest go.
    """

    every: int = 10
    merge_overlap: float = 0.35
    merge_inside: float = 0.7
    merge_ratio: float = 0.1
    merge_similarity: float = 0.85
    merge_mutual: float = 0.5
    merge_veto: float = 0.3
    reach: float = 0.04
    confirm_frames: int = 3
    forget_after: int = 60
    cluster_radius: float = 0.08
    cluster_share: float = 0.25
    eager: bool = True
    same_label: bool = True


def denoised(cloud: VoxelCloud, params: UpkeepParams) -> VoxelCloud:
    """The cloud's clusters of at least `cluster_share` of the largest, voxels seen once dropped where most were not.

    A single view's stray points at an edge are seen once; a surface that stays is seen again.
    """
    often = cloud.counts > 1
    if often.mean() > 0.5:
        cloud = cloud.kept(often)
    return cloud.kept(_large_clusters(cloud, params))


def overlap(a: VoxelCloud, b: VoxelCloud, reach: float) -> float:
    """Share of the smaller cloud's voxels with a voxel of the other within `reach` metres."""
    small, large = (a, b) if len(a) <= len(b) else (b, a)
    return _share_on(small.means, large.means, reach)


def mutual_overlap(a: VoxelCloud, b: VoxelCloud, reach: float) -> float:
    """The lesser of the shares of each cloud's voxels with one of the other within `reach` metres."""
    means = a.means, b.means
    return min(_share_on(*means, reach), _share_on(*means[::-1], reach))


def nesting(a: F64, b: F64, slack: float) -> tuple[F64, F64]:
    """Share of the smaller box's volume inside the other's, and its volume in the larger one's, pair by pair.

    Boxes `(..., 6)`, grown by `slack` metres a side.
    """
    grown = np.array([-slack] * 3 + [slack] * 3)
    volumes = np.broadcast_arrays(volume(a + grown), volume(b + grown))
    small, large = np.minimum(*volumes), np.maximum(*volumes)
    return pair_intersection(a + grown, b + grown) / small, small / large


def _share_on(points: F64, others: F64, reach: float) -> float:
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    near = others[((others >= low) & (others <= high)).all(axis=1)]
    if not len(near):
        return 0.0
    distance, _ = cKDTree(near).query(points, distance_upper_bound=reach)
    return float(np.isfinite(distance).mean())


def _large_clusters(cloud: VoxelCloud, params: UpkeepParams) -> Bools:
    """Voxels of clusters large enough; one cluster holds what is less than half a radius apart, and some up to it."""
    shift = max(0, round(params.cluster_radius / (2 * cloud.edge)).bit_length() - 1)
    keys, inverse = np.unique(pack_cells(voxel_cells(cloud.keys) >> shift), return_inverse=True)
    labels = _components(keys)[inverse]
    sizes = np.bincount(labels)
    return np.asarray(sizes[labels] >= params.cluster_share * sizes.max())


def _components(keys: I64) -> I32:
    """Component `(N,)` of each of N cells, by sorted key, joined where they touch, corners included."""
    cells = voxel_cells(keys)
    pairs = []
    for step in _HALF_THE_NEIGHBOURS:
        beside = pack_cells(cells + step)
        at = np.minimum(np.searchsorted(keys, beside), len(keys) - 1)
        there = np.flatnonzero(keys[at] == beside)
        pairs.append(np.stack([there, at[there]]))
    i, j = np.concatenate(pairs, axis=1)
    graph = coo_array((np.ones(len(i), np.int8), (i, j)), shape=(len(keys),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], np.int32)
