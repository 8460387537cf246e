"""Instance-preserving association (IPSM + LAMP, Eq. 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.boxes import touching
from ovip.scene.types import F32, F64, I64
from services.mapper.domain.spatial import Spatial, spatial_scores

NEW = -1


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
    features: F32
    labels: Sequence[str]
    clouds: Sequence[F32] = ()

    def at(self, index: Sequence[int] | I64) -> Instances:
        """Only those at `index`."""
        return Instances(
            self.boxes[index],
            self.features[index],
            [self.labels[int(i)] for i in index],
            [self.clouds[int(i)] for i in index] if self.clouds else (),
        )


def association_scores(detections: Instances, objects: Instances, params: AssociationParams) -> F64:
    """phi_ij of M detections against N objects -> `(M, N)`.

    phi_ij = (1 + a) IoU(b_i, B_j) + (1 - a) cos(f_i, g_j) - w_L [label_i != mode(C_j)]
    """
    spatial = spatial_scores(
        params.spatial, detections.boxes, objects.boxes, detections.clouds, objects.clouds
    )
    cosine = _cosines(detections.features, objects.features)
    differs = np.array([[a != b for b in objects.labels] for a in detections.labels], dtype=np.float64)
    penalty = params.label_penalty * differs.reshape(spatial.shape)
    return (1 + params.alpha) * spatial + (1 - params.alpha) * cosine - penalty


def associate_dense(scores: F64, tau: float) -> I64:
    """For each detection the best object where its score exceeds tau, else NEW; ties go to the older object."""
    if scores.shape[1] == 0:
        return np.full(scores.shape[0], NEW, np.int64)
    best = scores.argmax(axis=1)
    return np.where(scores[np.arange(len(best)), best] > tau, best, NEW)


def associate(detections: Instances, objects: Instances, params: AssociationParams) -> I64:
    """The same assignment as `associate_dense(association_scores(...))`, scoring only objects that can win.

    An object whose box shares no volume with b_i has a spatial score of at most 0 and can score at most (1 - a).
    Where that is <= tau it never wins, so only touching boxes are scored (SPEC 2.2); where tau < (1 - a) every
    object is.
    """
    if 1 - params.alpha > params.tau:
        return associate_dense(association_scores(detections, objects, params), params.tau)
    assigned = np.full(len(detections.boxes), NEW, np.int64)
    for i in range(len(assigned)):
        near = np.flatnonzero(touching(detections.boxes[i], objects.boxes))
        scores = association_scores(detections.at([i]), objects.at(near), params)
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
