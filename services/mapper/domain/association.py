"""Instance-preserving association (IPSM + LAMP, Eq. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.boxes import pairwise_iou, touching
from ovip.scene.types import F32, F64, I64

NEW = -1


@dataclass(frozen=True, slots=True)
class AssociationParams:
    """alpha, label_penalty (w_L): the paper's "Models and hyperparameters" table.

    tau: a detection joins an object whose score exceeds it. The paper gives no number; 1.05 lets a detection of
    the same label and like feature (cosine near 1) join from a small overlap on, and lets no other-label pair join.
    """

    alpha: float = 0.0
    label_penalty: float = 0.5
    tau: float = 1.05


def association_scores(
    boxes: F64,
    features: F32,
    labels: Sequence[str],
    object_boxes: F64,
    object_features: F32,
    object_labels: Sequence[str],
    params: AssociationParams,
) -> F64:
    """phi_ij of M detections against N objects -> `(M, N)`.

    phi_ij = (1 + a) IoU(b_i, B_j) + (1 - a) cos(f_i, g_j) - w_L [label_i != mode(C_j)]

    boxes `(M, 6)`, features `(M, D)` unit; object_boxes `(N, 6)`, object_features `(N, D)` unit.
    """
    iou = pairwise_iou(boxes, object_boxes)
    cosine = _cosines(features, object_features)
    differs = np.array([[a != b for b in object_labels] for a in labels], dtype=np.float64).reshape(iou.shape)
    return (1 + params.alpha) * iou + (1 - params.alpha) * cosine - params.label_penalty * differs


def associate_dense(scores: F64, tau: float) -> I64:
    """For each detection the best object where its score exceeds tau, else NEW; ties go to the older object."""
    if scores.shape[1] == 0:
        return np.full(scores.shape[0], NEW, np.int64)
    best = scores.argmax(axis=1)
    return np.where(scores[np.arange(len(best)), best] > tau, best, NEW)


def associate(
    boxes: F64,
    features: F32,
    labels: Sequence[str],
    object_boxes: F64,
    object_features: F32,
    object_labels: Sequence[str],
    params: AssociationParams,
) -> I64:
    """The same assignment as `associate_dense(association_scores(...))`, scoring only objects that can win.

    An object whose box shares no volume with b_i has IoU 0 and can score at most (1 - a). Where that is <= tau it
    never wins, so only touching boxes are scored (SPEC 2.2); where tau < (1 - a) every object is.
    """
    if 1 - params.alpha > params.tau:
        return associate_dense(
            association_scores(boxes, features, labels, object_boxes, object_features, object_labels, params),
            params.tau,
        )
    assigned = np.full(len(boxes), NEW, np.int64)
    for i in range(len(boxes)):
        near = np.flatnonzero(touching(boxes[i], object_boxes))
        scores = association_scores(
            boxes[i : i + 1],
            features[i : i + 1],
            labels[i : i + 1],
            object_boxes[near],
            object_features[near],
            [object_labels[int(j)] for j in near],
            params,
        )
        best = associate_dense(scores, params.tau)[0]
        assigned[i] = near[best] if best != NEW else NEW
    return assigned


def _cosines(a: F32, b: F32) -> F64:
    """cos of unit features `(M, D)` and `(N, D)` -> `(M, N)`, each pair's the same to the bit in any company.

    A matrix product rounds a pair differently by where it stands; equal objects would tie by chance. Rounding
    above 1 would let an object win that the bound of SPEC 2.2 rules out.
    """
    product = np.einsum("id,jd->ij", a.astype(np.float64), b.astype(np.float64))
    return np.asarray(np.clip(product, -1.0, 1.0), np.float64)
