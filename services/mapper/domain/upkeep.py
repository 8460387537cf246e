"""Upkeep of what changed: cluttered voxels go, duplicates merge, noise is dropped (SPEC 2.6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.boxes import pairwise_intersection, volume
from ovip.scene.clusters import clusters
from ovip.scene.types import F32, F64, Bools
from services.mapper.domain.cloud import VoxelCloud


@dataclass(frozen=True, slots=True)
class UpkeepParams:
    """every: detection batches between upkeeps. merge_overlap: share of the smaller cloud that lies on the other.

    merge_inside: share of the smaller box's volume inside the other's, which decides where the clouds show opposite
    sides of a small thing and do not touch.
    merge_similarity: cosine that two objects to merge must have.
    merge_iou: volume IoU of boxes above which objects of different labels merge too: one thing under two names, while
    a cup on a table shares no such part of the table's box.
    eager: merge what a batch made one at once, not at the next upkeep only.
    same_label: by overlap, merge only objects of one majority label.
    reach: metres within which a point lies on another cloud.
    confirm_frames: frames that must see an object before readers get it.
    forget_after: batches without a view after which an unconfirmed object is dropped.
    cluster_radius: metres between voxels of one cluster; smaller clusters than `cluster_share` of the largest go.
    """

    every: int = 10
    merge_overlap: float = 0.35
    merge_inside: float = 0.7
    merge_similarity: float = 0.85
    merge_iou: float = 0.4
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
    return cloud.kept(_large_clusters(cloud.points, params))


def overlap(a: VoxelCloud, b: VoxelCloud, reach: float) -> float:
    """Share of the smaller cloud's voxels with a voxel of the other within `reach` metres."""
    small, large = (a, b) if len(a) <= len(b) else (b, a)
    distance, _ = cKDTree(large.points).query(small.points, distance_upper_bound=reach)
    return float(np.isfinite(distance).mean())


def inside(a: F64, b: F64, slack: float) -> float:
    """Share of the smaller box's volume inside the other's; boxes `(6,)` grown by `slack` metres on each side."""
    grown = np.stack([a, b]) + np.array([-slack] * 3 + [slack] * 3)
    shared = pairwise_intersection(grown[:1], grown[1:])[0, 0]
    return float(shared / volume(grown).min())


def _large_clusters(points: F32, params: UpkeepParams) -> Bools:
    labels = clusters(points, params.cluster_radius)
    sizes = np.bincount(labels)
    return np.asarray(sizes[labels] >= params.cluster_share * sizes.max())
