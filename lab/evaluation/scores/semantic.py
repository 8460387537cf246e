"""Semantic mapping as ConceptGraphs' Replica routine scores it: mAcc, F-mIoU and mIoU of classified objects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, I64, Bools

REPLICA_CLASSES = (
    *("other", "basket", "bed", "bench", "bin", "blanket", "blinds", "book", "bottle", "box", "bowl"),
    *("camera", "cabinet", "candle", "chair", "clock", "cloth", "comforter", "cushion", "ceiling", "desk"),
    *("desk-organizer", "door", "floor", "indoor-plant", "lamp", "monitor", "nightstand", "panel", "picture"),
    *("pillar", "pillow", "pipe", "plant-stand", "plate", "pot", "sculpture", "shelf", "sofa", "stool"),
    *("switch", "table", "tablet", "tissue-paper", "tv-screen", "tv-stand", "vase", "vent", "wall"),
    *("wall-plug", "window", "rug"),
)
"""The 52 classes of the paper's Replica tables, in the evaluator's order."""

TEMPLATE = "A photo of a {}."
"""What every class name is put into before it is embedded (the paper's, in place of "an image of {}")."""

EXCLUDED: dict[int, frozenset[str]] = {
    1: frozenset({"other"}),
    4: frozenset({"other", "floor", "wall", "ceiling"}),
    6: frozenset({"other", "floor", "wall", "ceiling", "door", "window"}),
}
"""The classes left out, by the evaluator's `n_exclude`; the paper's tables use 6."""

UNMAPPED = -1


@dataclass(frozen=True, slots=True)
class SemanticScore:
    """Percent: mAcc, F-mIoU and mIoU. points: how many points of the reconstruction were judged."""

    accuracy: float
    frequency_iou: float
    iou: float
    points: int

    @property
    def columns(self) -> dict[str, float]:
        """As a result's row names them."""
        return {"mAcc": self.accuracy, "F-mIoU": self.frequency_iou, "mIoU": self.iou}


def kept_classes(classes: Sequence[str], present: Iterable[int], excluded: frozenset[str]) -> Bools:
    """Which classes `(C,)` are scored: those of a scene's truth, `present`, but for the `excluded`.

    The classifier is told them: logits of all others are -inf.
    """
    here = np.zeros(len(classes), np.bool_)
    here[np.unique(np.fromiter(present, np.int64))] = True
    return np.asarray(here & np.array([name not in excluded for name in classes]))


def clip_scores(features: F32, class_features: F32) -> F64:
    """Cosine of unit object features `(N, D)` with unit class features `(C, D)` -> `(N, C)`."""
    return features.astype(np.float64) @ class_features.astype(np.float64).T


def label_scores(
    histories: Sequence[Mapping[str, float]], label_features: Mapping[str, F32], class_features: F32
) -> F64:
    """s_label `(N, C)`: what each object's own labels say of the classes.

    The mean, by the weight of a label in the object's history, of the label's cosine `label_features[label]` `(D,)`
    with each class `(C, D)`.
    """
    scores = np.zeros((len(histories), len(class_features)))
    for row, history in zip(scores, histories, strict=True):
        total = sum(history.values())
        for label, weight in history.items():
            row += weight / total * clip_scores(label_features[label][None], class_features)[0]
    return scores


def mixed_scores(clip: F64, label: F64, lam: float) -> F64:
    """s = (1 - lambda) s_clip + lambda s_label, both `(N, C)`."""
    return (1 - lam) * clip + lam * label


def classify(scores: F64, keep: Bools) -> I64:
    """The kept class `(N,)` of most score `(N, C)`; the first of equals. At least one class must be kept."""
    return np.asarray(np.where(keep, scores, -np.inf).argmax(axis=1), np.int64)


def confusion(truth: I64, predicted: I64, classes: int) -> I64:
    """Counts `(C, C + 1)` of points by true class and predicted class `(P,)`; the last column holds UNMAPPED."""
    column = np.where(predicted == UNMAPPED, classes, predicted)
    flat = np.bincount(truth * (classes + 1) + column, minlength=classes * (classes + 1))
    return np.asarray(flat.reshape(classes, classes + 1), np.int64)


def semantic_score(truth: I64, predicted: I64, keep: Bools) -> SemanticScore:
    """The score of points `(P,)` of true and predicted class; points whose true class is not kept are dropped.

    r_c row sum, k_c column sum, t = C[c, c]: recall_c = t / max(1, r_c), IoU_c = t / max(1, r_c + k_c - t);
    mAcc = mean recall, mIoU = mean IoU, F-mIoU = sum IoU_c r_c / sum C, over the kept classes. All 0 without points.
    """
    judged = keep[truth]
    counts = confusion(truth[judged], predicted[judged], len(keep))[keep]
    hit = np.diagonal(counts[:, np.flatnonzero(keep)]).astype(np.float64)
    rows, columns = counts.sum(axis=1), counts[:, np.flatnonzero(keep)].sum(axis=0)
    iou = hit / np.maximum(1, rows + columns - hit)
    if not judged.any():
        return SemanticScore(0.0, 0.0, 0.0, 0)
    return SemanticScore(
        accuracy=100 * float((hit / np.maximum(1, rows)).mean()),
        frequency_iou=100 * float((iou * rows).sum() / counts.sum()),
        iou=100 * float(iou.mean()),
        points=int(judged.sum()),
    )
