"""From a mask to points in the world: back-project, downsample, keep the largest cluster (SPEC 1.6)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ovip.scene.boxes import box_of
from ovip.scene.camera import lift_pixels
from ovip.scene.clusters import clusters
from ovip.scene.types import F32, F64, U8, Bools, Frame
from ovip.scene.voxels import downsample

_MOST_PIXELS = 20_000  # a mask's pixels beyond are thinned evenly before lifting


@dataclass(frozen=True, slots=True)
class LiftParams:
    """voxel: metres (paper: 0.02). cluster_radius: metres between points of one cluster. Thresholds drop a detection.

    max_depth: metres; farther depth of a consumer sensor is noise. edge: pixels shaved off a mask's border,
    where colour and depth disagree.
    """

    voxel: float = 0.02
    cluster_radius: float = 0.06
    min_points: int = 12
    min_mask_area: int = 80
    min_confidence: float = 0.35
    max_depth: float = 6.0
    edge: int = 2
    surface_voxel: float = 0.05


@dataclass(frozen=True, slots=True)
class Lifted:
    """points: `(N, 3)` float32 world metres; colors: `(N, 3)` uint8; box: `(6,)`."""

    points: F32
    colors: U8
    box: F64


def lift(frame: Frame, mask: Bools, params: LiftParams) -> Lifted | None:
    """A mask `(H, W)` as a clean cloud in the world; None where too little is left of it.

    Steps in the order of SPEC 1.6: mask and depth to points, one point a voxel, largest cluster, box.
    """
    if int(mask.sum()) < params.min_mask_area:
        return None
    keep = _shaved(mask, params.edge) & (frame.depth > 0) & (frame.depth <= params.max_depth)
    index = np.flatnonzero(keep)
    if len(index) < params.min_points:
        return None
    index = index[:: 1 + len(index) // _MOST_PIXELS]
    points = lift_pixels(index, frame.depth.ravel()[index], frame.intrinsics, frame.world_from_camera)
    thin, colors = downsample(points, params.voxel, frame.rgb.reshape(-1, 3)[index])
    assert colors is not None
    cluster = largest_cluster(thin, params.cluster_radius)
    thin, colors = thin[cluster], colors[cluster]
    if len(thin) < params.min_points:
        return None
    return Lifted(thin, colors, box_of(thin))


def largest_cluster(points: F32, radius: float) -> Bools:
    """Which of `(N, 3)` points belong to the largest set connected by steps of at most `radius` metres.

    Ties go to the cluster that holds the first point.
    """
    if len(points) == 0:
        return np.zeros(0, dtype=bool)
    labels = clusters(points, radius)
    return np.asarray(labels == np.bincount(labels).argmax())


def surface_cloud(frame: Frame, params: LiftParams) -> F32:
    """All of a frame's depth as a coarse cloud `(N, 3)`, one point a voxel of `surface_voxel` metres."""
    keep = (frame.depth > 0) & (frame.depth <= params.max_depth)
    keep[::2] = False  # every other row: the voxels are much larger than a pixel
    index = np.flatnonzero(keep)
    points = lift_pixels(index, frame.depth.ravel()[index], frame.intrinsics, frame.world_from_camera)
    return downsample(points, params.surface_voxel)[0]


def _shaved(mask: Bools, edge: int) -> Bools:
    """The mask without its border, unless that leaves less than a third of it."""
    if edge == 0:
        return mask
    inner = cv2.erode(mask.astype(np.uint8), np.ones((2 * edge + 1,) * 2, np.uint8), borderValue=0).astype(
        bool
    )
    return inner if 3 * inner.sum() >= mask.sum() else mask
