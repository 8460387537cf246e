"""Predicted against true rooms: Hydra precision and recall, accuracy, AP, as HOV-SG's HM3D evaluator counts them.

`compat_score` keeps the released evaluator's quirks, because published numbers carry them: an overlap ratio (not
an IoU) decides matches, "acc@IoU=0.5" is read at entry 6 of the thresholds 0, 0.1 .. 1 (that is 0.6), and the
average precision pairs precisions in the order of the thresholds with recalls sorted upwards. `strict_score` is
the honest one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from ovip.scene.types import F64, I64

NEAR = 0.05
"""Metres: a point counts as shared where one of the other room is nearer; also the cloud's and the cells' grid."""

THRESHOLDS = np.linspace(0.0, 1.0, 11)
REPORTED = 6
"""The entry of `THRESHOLDS` that the evaluator reports as "acc@IoU=0.5"."""

STRICT_IOU = 0.5

_TIE = 1e-6  # metres: cells of one lattice are exactly NEAR apart, and that is not nearer


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """A room as it is seen from above. floor: its storey. points: `(N, 2)` world x, y, one a cell of 0.05 m."""

    floor: int
    points: F64


@dataclass(frozen=True, slots=True)
class RoomScore:
    """Shares 0..1 of one scene."""

    hydra_precision: float
    hydra_recall: float
    accuracy: float
    average_precision: float

    @property
    def columns(self) -> dict[str, float]:
        """As a result's row names them."""
        return {
            "HydP": self.hydra_precision,
            "HydR": self.hydra_recall,
            "acc": self.accuracy,
            "AP": self.average_precision,
        }


def compat_score(predicted: Sequence[Room], truth: Sequence[Room]) -> RoomScore:
    """The released evaluator's figures; all 0 where either side has no room."""
    if not predicted or not truth:
        return RoomScore(0.0, 0.0, 0.0, 0.0)
    near_p, near_g = shared_points(predicted, truth)
    size_p, size_g = _sizes(predicted)[:, None], _sizes(truth)[None]
    matched = matched_overlaps(np.maximum(near_p / size_p, near_g / size_g))
    return RoomScore(
        hydra_precision=float(np.minimum(near_g / size_p, 1.0).max(axis=1).mean()),
        hydra_recall=float(np.minimum(near_p / size_g, 1.0).max(axis=0).mean()),
        accuracy=compat_accuracy(matched, len(predicted), len(truth)),
        average_precision=compat_average_precision(matched, len(predicted), len(truth)),
    )


def strict_score(predicted: Sequence[Room], truth: Sequence[Room]) -> RoomScore:
    """Shares of equal cells, true IoU above 0.5, and precision times recall there; all 0 where either is empty.

    Without confidences the precision-recall curve at one IoU is one point (P, R): the area under it is P R.
    """
    if not predicted or not truth:
        return RoomScore(0.0, 0.0, 0.0, 0.0)
    shared = shared_cells(predicted, truth)
    size_p, size_g = _sizes(predicted)[:, None], _sizes(truth)[None]
    matched = matched_overlaps(shared / (size_p + size_g - shared))
    hits = int((matched > STRICT_IOU).sum())
    return RoomScore(
        hydra_precision=float((shared / size_p).max(axis=1).mean()),
        hydra_recall=float((shared / size_g).max(axis=0).mean()),
        accuracy=_accuracy(hits, len(predicted), len(truth)),
        average_precision=hits / len(predicted) * hits / len(truth),
    )


def matched_overlaps(overlap: F64) -> F64:
    """The overlaps of the pairs that a Hungarian matching of `(P, G)` picks to maximise their sum."""
    chosen: F64 = overlap[linear_sum_assignment(overlap, maximize=True)]
    return chosen


def compat_accuracy(matched: F64, predicted: int, truth: int) -> float:
    """TP / (TP + FP + FN) of matched overlaps above the threshold of entry 6, which is 0.6."""
    return _accuracy(int((matched > THRESHOLDS[REPORTED]).sum()), predicted, truth)


def compat_average_precision(matched: F64, predicted: int, truth: int) -> float:
    """Trapezoid of the precisions, by rising threshold, over the recalls, sorted upwards: not each one's own.

    Nothing is above 1, so the last TP is 0; where all others are one number t, this is (t / predicted)(t / truth).
    """
    hits = np.array([(matched > threshold).sum() for threshold in THRESHOLDS])
    return float(np.trapezoid(hits / predicted, np.sort(hits / truth)))


def shared_points(predicted: Sequence[Room], truth: Sequence[Room]) -> tuple[I64, I64]:
    """Points of each p nearer than 0.05 m to g, and of each g nearer to p -> two `(P, G)`; other floors share none."""
    near_p = np.zeros((len(predicted), len(truth)), np.int64)
    near_g = np.zeros_like(near_p)
    trees_p, trees_g = ([cKDTree(room.points) for room in rooms] for rooms in (predicted, truth))
    for i, j in _touching(predicted, truth):
        near_p[i, j] = _near(predicted[i].points, trees_g[j])
        near_g[i, j] = _near(truth[j].points, trees_p[i])
    return near_p, near_g


def shared_cells(predicted: Sequence[Room], truth: Sequence[Room]) -> I64:
    """Cells of 0.05 m that both rooms have -> `(P, G)`."""
    shared = np.zeros((len(predicted), len(truth)), np.int64)
    cells_p, cells_g = ([_cells(room.points) for room in rooms] for rooms in (predicted, truth))
    for i, j in _touching(predicted, truth):
        shared[i, j] = len(np.intersect1d(cells_p[i], cells_g[j], assume_unique=True))
    return shared


def _accuracy(hits: int, predicted: int, truth: int) -> float:
    return hits / (predicted + truth - hits)


def _sizes(rooms: Sequence[Room]) -> I64:
    return np.array([len(room.points) for room in rooms], np.int64)


def _touching(predicted: Sequence[Room], truth: Sequence[Room]) -> list[tuple[int, int]]:
    """Pairs of one floor whose extents overlap or nearly so."""
    return [
        (i, j)
        for i, p in enumerate(predicted)
        for j, g in enumerate(truth)
        if p.floor == g.floor
        and (p.points.min(axis=0) - NEAR <= g.points.max(axis=0)).all()
        and (g.points.min(axis=0) - NEAR <= p.points.max(axis=0)).all()
    ]


def _near(points: F64, tree: cKDTree) -> int:
    distance, _ = tree.query(points, distance_upper_bound=NEAR - _TIE)
    return int(np.isfinite(distance).sum())


def _cells(points: F64) -> I64:
    """Sorted keys of the distinct cells of `(N, 2)` points."""
    x, y = np.floor(points / NEAR).astype(np.int64).T
    return np.unique((x << 32) + y)
