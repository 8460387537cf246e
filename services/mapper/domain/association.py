"""Instance-preserving association (IPSM + LAMP, Eq. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.boxes import pairwise_touching
from ovip.scene.types import F32, F64, I64
from services.mapper.domain.spatial import Spatial, spatial_scores

NEW = -1
_PAIRS_AT_ONCE = 4096  # of features in memory


@dataclass(frozen=True, slots=True)
class AssociationParams:
    """alpha, label_penalty (w_L): the paper's "Models and hyperparameters" table; a penalty of 0 is label-agnostic.

    tau: a detection joins an object whose score exceeds it. The paper gives no number. 1.0 was chosen by `ovip eval
    calibrate` on simulated homes (docs/results.md has the curve), among values of at least 1 - alpha: below that, looks
    alone could join two like things a room apart, and pruning would not be exact.
    spatial: the paper's is IoU; the others are ablations.
    """

    alpha: float = 0.0
    label_penalty: float = 0.5
    tau: float = 1.0
    spatial: Spatial = Spatial.IOU


@dataclass(frozen=True, slots=True, eq=False)
class Instances:
    """N detections of a frame, or N objects of the map, as association compares them.

    boxes `(N, 6)`; features `(N, D)` unit; labels: a detection's, or an object's majority label mode(C_j).
    clouds: `(P, 3)` points of each; may be left out unless the spatial term is `overlap`.
    """

    boxes: F64
    features: F32 | F64
    labels: Sequence[str]
    clouds: Sequence[F32] = ()

    def __len__(self) -> int:
        return len(self.boxes)


def association_scores(detections: Instances, objects: Instances, params: AssociationParams) -> F64:
    """phi_ij of M detections against N objects -> `(M, N)`: every pair, as the equation stands.

    phi_ij = (1 + a) IoU(b_i, B_j) + (1 - a) cos(f_i, g_j) - w_L [label_i != mode(C_j)]
    """
    i, j = (index.ravel() for index in np.indices((len(detections), len(objects))))
    return _pair_scores(detections, objects, i, j, params).reshape(len(detections), len(objects))


def associate_dense(scores: F64, tau: float) -> I64:
    """For each detection the best object where its score exceeds tau, else NEW; ties go to the older object."""
    if scores.shape[1] == 0:
        return np.full(scores.shape[0], NEW, np.int64)
    best = scores.argmax(axis=1)
    return np.where(scores[np.arange(len(best)), best] > tau, best, NEW)


def associate(detections: Instances, objects: Instances, params: AssociationParams) -> I64:
    """The same assignment as `associate_dense(association_scores(...))`, scoring only pairs that can win.

    An object whose box shares no volume with b_i has a spatial score of at most 0 and can score at most (1 - a).
    Where that is <= tau it never wins, so only touching boxes are scored (SPEC 2.2), and objects that touch no
    detection may be left out beforehand. Where `needs_all`, every pair is scored.
    """
    if needs_all(params):
        return associate_dense(association_scores(detections, objects, params), params.tau)
    i, j = np.nonzero(pairwise_touching(detections.boxes, objects.boxes))
    scores = np.full((len(detections), len(objects)), -np.inf)
    scores[i, j] = _pair_scores(detections, objects, i, j, params)
    return associate_dense(scores, params.tau)


def needs_all(params: AssociationParams) -> bool:
    """Whether features alone can reach tau, so that an object anywhere may win."""
    return 1 - params.alpha > params.tau


def _pair_scores(detections: Instances, objects: Instances, i: I64, j: I64, params: AssociationParams) -> F64:
    spatial = spatial_scores(
        params.spatial, detections.boxes[i], objects.boxes[j], i, j, detections.clouds, objects.clouds
    )
    cosine = _cosines(detections.features, objects.features, i, j)
    differs = np.array(detections.labels, object)[i] != np.array(objects.labels, object)[j]
    score: F64 = (1 + params.alpha) * spatial + (1 - params.alpha) * cosine - params.label_penalty * differs
    return score


def _cosines(a: F32 | F64, b: F32 | F64, i: I64, j: I64) -> F64:
    """cos of unit features `a[i]` and `b[j]` `(P,)`, each pair's the same to the bit in any company.

    A matrix product rounds a pair differently by where it stands; equal objects would tie by chance. Rounding
    above 1 would let an object win that the bound of SPEC 2.2 rules out.
    """
    a, b = a.astype(np.float64, copy=False), b.astype(np.float64, copy=False)
    cosines = np.empty(len(i))
    for at in range(0, len(i), _PAIRS_AT_ONCE):
        part = slice(at, at + _PAIRS_AT_ONCE)
        cosines[part] = np.einsum("pd,pd->p", a[i[part]], b[j[part]])
    return np.clip(cosines, -1.0, 1.0)
