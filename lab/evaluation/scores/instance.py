"""Native instances: class-agnostic PQ, SQ, RQ, recall by size, and recall of the classes that a map swallowed."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, I32, I64, Bools

NOTHING = -1
"""The id of a point that no object was mapped at."""

SIZES = ("small", "medium", "large")
MATCH_IOU = 0.5
SWALLOWED_RECALL = 0.5
"""A class is swallowed where less of its area than this carries its label, though it was detected."""


@dataclass(frozen=True, slots=True)
class Panoptic:
    """pq = sq rq. matched: truth id -> map id of the one-to-one pairs; truth, predicted: how many there are."""

    pq: float
    sq: float
    rq: float
    matched: dict[int, int]
    truth: int
    predicted: int


def vertex_instances(
    triangles: I32, areas: F64, face_ids: I64, vertices: int, retained: Collection[int]
) -> I64:
    """An instance id for each vertex `(V,)` from ids of faces `(T,)`; NOTHING for a vertex of no face.

    Each vertex takes the id with the largest area of faces at it, the smaller id of equals. A `retained` id that wins
    no vertex is given all of its own faces' vertices, so that no instance is lost (ascending ids, the later one wins).
    triangles: `(T, 3)`; areas: `(T,)`, any unit.
    """
    known, index = np.unique(np.repeat(face_ids, 3), return_inverse=True)
    pairs, at = np.unique(triangles.ravel().astype(np.int64) * len(known) + index, return_inverse=True)
    corner, voted = np.divmod(pairs, max(len(known), 1))
    votes = np.bincount(at, weights=np.repeat(areas, 3), minlength=len(pairs))
    order = np.lexsort((-voted, votes, corner))  # the last of a vertex has most votes
    won = np.full(vertices, NOTHING, np.int64)
    won[corner[order]] = known[voted[order]]
    for lost in sorted(set(retained) & set(known.tolist()) - set(won.tolist())):
        won[triangles[face_ids == lost].ravel()] = lost
    return won


def panoptic(truth: I64, predicted: I64) -> Panoptic:
    """Class-agnostic panoptic quality of points `(P,)` with a true and a predicted id (NOTHING: not mapped).

    Pairs of most IoU first, each id used once, IoU > 0.5: SQ = mean IoU of the pairs, RQ = TP / (TP + FP/2 + FN/2).
    A map id with no point here is no false positive: it may map what the protocol leaves out.
    """
    ids, truth_index, truth_sizes = np.unique(truth, return_inverse=True, return_counts=True)
    mapped = predicted != NOTHING
    map_ids, map_index, map_sizes = np.unique(predicted[mapped], return_inverse=True, return_counts=True)
    pairs, shared = np.unique(truth_index[mapped] * max(len(map_ids), 1) + map_index, return_counts=True)
    rows, columns = np.divmod(pairs, max(len(map_ids), 1))
    iou = shared / (truth_sizes[rows] + map_sizes[columns] - shared)
    matched: dict[int, int] = {}
    total = 0.0
    for best in np.argsort(-iou, kind="stable"):
        g, p = int(ids[rows[best]]), int(map_ids[columns[best]])
        if iou[best] > MATCH_IOU and g not in matched and p not in matched.values():
            matched[g] = p
            total += float(iou[best])
    hits = len(matched)
    sq = total / hits if hits else 0.0
    rq = hits / (hits + (len(map_ids) - hits) / 2 + (len(ids) - hits) / 2) if len(ids) + len(map_ids) else 0.0
    return Panoptic(sq * rq, sq, rq, matched, len(ids), len(map_ids))


def size_of(areas: Mapping[int, float]) -> dict[int, str]:
    """Which tercile of a scene's surface areas (square metres) each id is in; equal areas go by id."""
    ranked = sorted(areas, key=lambda i: (areas[i], i))
    return {i: SIZES[rank * len(SIZES) // len(ranked)] for rank, i in enumerate(ranked)}


def recall_by_size(areas: Mapping[int, float], matched: Collection[int]) -> dict[str, float]:
    """Share of each tercile's ids that were matched; a tercile that is empty (under three ids) is left out."""
    sizes = size_of(areas)
    hits: dict[str, list[bool]] = {}
    for i, size in sizes.items():
        hits.setdefault(size, []).append(i in matched)
    return {size: sum(hit) / len(hit) for size, hit in hits.items()}


def label_area_recall(truth: I64, predicted: I64, classes: int) -> F64:
    """Share of each class's points whose map object carries the class as its label -> `(C,)`; nan for absent classes.

    Points `(P,)` are spread evenly over the surface, so counts are areas. predicted: class of the label of each
    point's object, negative for none.
    """
    area = np.bincount(truth, minlength=classes).astype(np.float64)
    hit = np.bincount(truth[truth == predicted], minlength=classes)
    return np.asarray(np.divide(hit, area, out=np.full(classes, np.nan), where=area > 0), np.float64)


def swallowed_classes(baseline: F64, detected: Bools) -> I64:
    """Classes that were detected, and yet carry their label on less than half of their area in the overlap map.

    baseline: its label-area recall `(C,)`. The appendix's targeted diagnostic takes classes "visibly or quantitatively
    swallowed by the pre-IPA map" and states no threshold.
    """
    with np.errstate(invalid="ignore"):
        return np.flatnonzero(detected & (baseline < SWALLOWED_RECALL))
