"""Upkeep of what changed: cluttered voxels go, duplicates merge, noise is dropped (SPEC 2.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.boxes import pair_intersection, volume
from ovip.scene.clusters import cell_clusters
from ovip.scene.types import F64, I64
from ovip.scene.voxels import pack_cells, voxel_cells
from services.mapper.domain.cloud import VoxelCloud

_BLOCK = 2  # bits of a cell: voxels are beside one another in blocks of four a side
_TAIL = 100


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
    merge_mutual: float = 0.25
    merge_veto: float = 0.3
    reach: float = 0.04
    confirm_frames: int = 3
    forget_after: int = 60
    cluster_radius: float = 0.08
    cluster_share: float = 0.25
    eager: bool = True
    same_label: bool = True


def denoised(clouds: Sequence[VoxelCloud], params: UpkeepParams) -> list[VoxelCloud]:
    """Each cloud's clusters of at least `cluster_share` of its largest; voxels seen once go where most were not.

    A single view's stray points at an edge are seen once; a surface that stays is seen again. Of one cluster is what is
    less than half a `cluster_radius` apart, and some up to it (`cell_clusters`).
    """
    kept = [_seen_again(cloud) for cloud in clouds]
    if not kept:
        return []
    owners = np.repeat(np.arange(len(kept)), [len(cloud) for cloud in kept])
    labels = cell_clusters(np.concatenate([_cells(cloud, params) for cloud in kept]), owners)
    sizes = np.bincount(labels)
    largest = np.zeros(len(kept), np.int64)
    np.maximum.at(largest, owners, sizes[labels])
    stay = sizes[labels] >= params.cluster_share * largest[owners]
    parts = np.split(stay, np.cumsum([len(cloud) for cloud in kept])[:-1])
    return [cloud.kept(part) for cloud, part in zip(kept, parts, strict=True)]


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


def _seen_again(cloud: VoxelCloud) -> VoxelCloud:
    """Without voxels seen once, where most were not; nor what was seen a hundredth as often as what is beside it.

    The tails of noise and drift would thicken a surface for as long as it is looked at.
    """
    counts = cloud.counts
    often = counts > 1
    keep = often if often.mean() > 0.5 else np.ones(len(counts), bool)
    if counts.max() > _TAIL:
        blocks, block = np.unique(pack_cells(voxel_cells(cloud.keys) >> _BLOCK), return_inverse=True)
        most = np.zeros(len(blocks), np.int32)
        np.maximum.at(most, block, counts)
        keep = keep & (counts * _TAIL >= most[block])
    return cloud if keep.all() else cloud.kept(keep)


def _cells(cloud: VoxelCloud, params: UpkeepParams) -> I64:
    """Cells of half a cluster's radius, or the cloud's own where they are larger."""
    return voxel_cells(cloud.keys).astype(np.int64) // max(1, round(params.cluster_radius / (2 * cloud.edge)))
