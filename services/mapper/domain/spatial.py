"""The spatial term of association: symmetric IoU (IPSM), and what it is compared with (SPEC 2.5)."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.boxes import pairwise_giou, pairwise_iou, touching
from ovip.scene.types import F32, F64

REACH = 0.025
"""Metres within which a detection's point lies on an object (ConceptGraphs: one voxel)."""


class Spatial(StrEnum):
    """iou: volume IoU of boxes, the paper's. giou: generalised IoU. overlap: ConceptGraphs' one-sided containment."""

    IOU = "iou"
    GIOU = "giou"
    OVERLAP = "overlap"


def spatial_scores(
    kind: Spatial, boxes: F64, object_boxes: F64, clouds: Sequence[F32], object_clouds: Sequence[F32]
) -> F64:
    """Scores `(M, N)` of boxes `(M, 6)` against `(N, 6)`; at most 0 where two boxes share no volume.

    clouds: `(P, 3)` points of each box's owner, used by `overlap` only.
    """
    if kind is Spatial.IOU:
        return pairwise_iou(boxes, object_boxes)
    if kind is Spatial.GIOU:
        return np.minimum(pairwise_giou(boxes, object_boxes), _zero_apart(boxes, object_boxes))
    scores = np.zeros((len(boxes), len(object_boxes)))
    for i, box in enumerate(boxes):
        for j in np.flatnonzero(touching(box, object_boxes)):
            scores[i, j] = containment(clouds[i], object_clouds[int(j)])
    return scores


def containment(points: F32, others: F32) -> float:
    """Share of `(P, 3)` points with one of `(Q, 3)` others within REACH: 1 for a cup inside a table's cloud.

    One-sided: a small thing lies wholly on a large one that does not lie on it.
    """
    low, high = points.min(axis=0) - REACH, points.max(axis=0) + REACH
    near = others[((others >= low) & (others <= high)).all(axis=1)]
    if not len(near):
        return 0.0
    distance, _ = cKDTree(near).query(points, distance_upper_bound=REACH)
    return float(np.isfinite(distance).mean())


def _zero_apart(boxes: F64, object_boxes: F64) -> F64:
    """Infinite where boxes share a volume, else 0: the bound that pruning relies on."""
    together = np.array([touching(box, object_boxes) for box in boxes]).reshape(len(boxes), len(object_boxes))
    return np.where(together, np.inf, 0.0)
