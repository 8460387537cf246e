"""The spatial term of association: symmetric IoU (IPSM), and what it is compared with (SPEC 2.5)."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.boxes import pair_giou, pair_iou, pair_touching
from ovip.scene.types import F32, F64, I64

REACH = 0.025
"""Metres within which a detection's point lies on an object (ConceptGraphs: one voxel)."""


class Spatial(StrEnum):
    """iou: volume IoU of boxes, the paper's. giou: generalised IoU. overlap: ConceptGraphs' one-sided containment."""

    IOU = "iou"
    GIOU = "giou"
    OVERLAP = "overlap"


def spatial_scores(
    kind: Spatial,
    boxes: F64,
    object_boxes: F64,
    i: I64,
    j: I64,
    clouds: Sequence[F32] = (),
    object_clouds: Sequence[F32] = (),
) -> F64:
    """Scores `(P,)` of pairs of boxes `(P, 6)` and `(P, 6)`; at most 0 where two boxes share no volume.

    clouds[i[p]], object_clouds[j[p]]: `(N, 3)` points of pair p's owners, used by `overlap` only.
    """
    if kind is Spatial.IOU:
        return pair_iou(boxes, object_boxes)
    if kind is Spatial.GIOU:
        together = pair_touching(boxes, object_boxes)
        return np.minimum(pair_giou(boxes, object_boxes), np.where(together, np.inf, 0.0))
    scores = np.zeros(len(boxes))
    for p in np.flatnonzero(pair_touching(boxes, object_boxes)):
        scores[p] = containment(clouds[int(i[p])], object_clouds[int(j[p])])
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
