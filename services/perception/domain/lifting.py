"""From masks to points in the world: back-project, downsample, keep the largest cluster (SPEC 1.6)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.clusters import cell_clusters
from ovip.scene.types import F32, F64, I64, U8, Bools, Frame
from services.perception.domain.masks import (
    ContainedParams,
    Patch,
    patch_of,
    shaved,
    thinned,
    without_contained,
)
from services.perception.domain.supports import SupportParams, standing, support_heights
from services.perception.domain.voxel_clouds import Clouds, voxel_clouds

_MOST_PIXELS = 20_000  # a mask's pixels beyond are thinned, however far away it is
_MOST_STEP = 4  # of what is near, one pixel of so many is lifted at least
_SURFACE_SAMPLES = 4.0  # as LiftParams.samples, for the frame's surface
_FAR_SHARE = 0.9  # of a mask's pixels are nearer than what its thinning goes by


@dataclass(frozen=True, slots=True)
class LiftParams:
    """voxel: metres (paper: 0.02). cluster_cell: metres; see `main_clusters`. Thresholds drop a detection.

    max_depth: metres; farther depth of a consumer sensor is noise. edge: pixels shaved off a mask's border,
    where colour and depth disagree. samples: pixels of a voxel seen face on that are enough; more are thinned.
    """

    voxel: float = 0.02
    cluster_cell: float = 0.04
    min_points: int = 12
    min_mask_area: int = 80
    min_confidence: float = 0.35
    max_depth: float = 6.0
    edge: int = 2
    samples: float = 8.0
    surface_voxel: float = 0.05
    contained: ContainedParams = ContainedParams()
    support: SupportParams = SupportParams()

    @property
    def farthest_seen(self) -> float:
        """Metres up to which depth says that nothing was before it: twice `max_depth`.

        Noise blurs where a far thing lies, not that the ray came as far as the map reaches. Beyond, a return is
        likelier an error than a wall.
        """
        return 2 * self.max_depth


@dataclass(frozen=True, slots=True)
class Lifted:
    """points: `(N, 3)` float32 world metres, ordered by voxel key, one a voxel; colors: `(N, 3)` uint8; box: `(6,)`."""

    points: F32
    colors: U8
    box: F64


def lift(frame: Frame, mask: Bools, params: LiftParams) -> Lifted | None:
    """A mask `(H, W)` as a clean cloud in the world; None where too little is left of it."""
    return lift_all(frame, [mask], params)[0]


def lift_all(frame: Frame, masks: Sequence[Bools], params: LiftParams) -> list[Lifted | None]:
    """Each mask `(H, W)` of a frame as a clean cloud in the world; None where too little is left of it.

    Steps in the order of SPEC 1.6: masks and depth to points, one point a voxel, largest cluster, box.
    """
    clouds = clouds_of_masks(frame, masks, params)
    kept = np.flatnonzero(main_clusters(clouds, params))
    ends = np.searchsorted(clouds.owners[kept], np.arange(len(masks) + 1))
    axes = [axis[kept] for axis in clouds.points.T]
    points, boxes = np.stack(axes, axis=1), _boxes(axes, ends)
    colors = np.stack([channel[kept] for channel in clouds.colors.T], axis=1)
    return [
        Lifted(points[a:b], colors[a:b], box) if b - a >= params.min_points else None
        for (a, b), box in zip(itertools.pairwise(ends.tolist()), boxes, strict=True)
    ]


def clouds_of_masks(frame: Frame, masks: Sequence[Bools], params: LiftParams) -> Clouds:
    """One point a voxel of each mask that is large enough; the owner of a point is its mask's number.

    What another mask or the level below holds is left out, see `without_contained` and `standing`.
    """
    patches = without_contained([patch_of(mask) for mask in masks], params.contained)
    pixels = [_pixels(frame, patch, params) for patch in patches]
    owners = np.repeat(np.arange(len(masks)), [len(index) for index in pixels])
    clouds = voxel_clouds(frame, np.concatenate([np.zeros(0, np.int64), *pixels]), owners, params.voxel)
    supports = support_heights(frame, patches, params.support)
    return clouds.kept(standing(clouds, supports, params.min_points, params.support))


def main_clusters(clouds: Clouds, params: LiftParams) -> Bools:
    """Which points `(V,)` are of their owner's largest cluster, by voxels.

    Clusters are made of cells of `cluster_cell` metres that touch: the largest set connected by small steps, as
    DBSCAN finds it, at the price of one sort. Ties go to the cluster of the first point.
    """
    if len(clouds.owners) == 0:
        return np.zeros(0, np.bool_)
    labels = cell_clusters(clouds.cells // max(1, round(params.cluster_cell / params.voxel)), clouds.owners)
    sizes = np.bincount(labels)
    owner = np.zeros(len(sizes), np.int64)
    owner[labels] = clouds.owners
    order = np.lexsort((-sizes, owner))  # stable: the first of equals
    largest = np.zeros(len(sizes), np.bool_)
    largest[order[np.diff(owner[order], prepend=-1) > 0]] = True
    return largest[labels]


def surface_cloud(frame: Frame, params: LiftParams) -> F32:
    """All of a frame's depth as a coarse cloud `(N, 3)`, one point a voxel of `surface_voxel` metres."""
    known = (frame.depth > 0) & (frame.depth <= params.max_depth)
    across = params.surface_voxel * frame.intrinsics.fx / params.max_depth  # pixels of a voxel far away
    step = min(_MOST_STEP, int(across**2 / _SURFACE_SAMPLES))
    index = thinned(Patch(0, 0, known), step).pixels(frame.intrinsics.width)
    points = voxel_clouds(frame, index, np.zeros(len(index), np.int64), params.surface_voxel).points
    return np.ascontiguousarray(points)


def _pixels(frame: Frame, patch: Patch, params: LiftParams) -> I64:
    """Flat indices of the pixels of a mask that are lifted."""
    if patch.area < params.min_mask_area:
        return np.zeros(0, np.int64)
    patch = shaved(patch, params.edge)
    depth = frame.depth[patch.window]
    patch = patch.where(patch.inside & (depth > 0) & (depth <= params.max_depth))
    if patch.area < params.min_points:
        return np.zeros(0, np.int64)
    return thinned(patch, _step(patch, depth, frame.intrinsics.fx, params)).pixels(frame.intrinsics.width)


def _step(patch: Patch, depth: F32, focal: float, params: LiftParams) -> int:
    """Of how many pixels one is lifted, so that a voxel keeps `samples` of them where the mask is far away."""
    some = depth[::4, ::4][patch.inside[::4, ::4]]
    enough = 1 + patch.area // _MOST_PIXELS
    if len(some) == 0:
        return enough
    far = float(np.partition(some, int(_FAR_SHARE * len(some)))[int(_FAR_SHARE * len(some))])
    return max(enough, min(_MOST_STEP, int((params.voxel * focal / far) ** 2 / params.samples)))


def _boxes(axes: Sequence[F32], ends: I64) -> F64:
    """The boxes `(M, 6)` around runs of points, whose coordinates `(N,)` are given axis by axis.

    ends: `(M + 1,)` where each run starts, and where the last ends. The box of an empty run means nothing.
    """
    boxes = np.zeros((len(ends) - 1, 6))
    full = np.flatnonzero(np.diff(ends))
    if len(full):
        for i, axis in enumerate(axes):
            boxes[full, i] = np.minimum.reduceat(axis, ends[full])
            boxes[full, 3 + i] = np.maximum.reduceat(axis, ends[full])
    return boxes
