"""Feeds a detection cache through the mapper, and scores the map against a place's truth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from lab.evaluation.mapping.places import Place
from lab.evaluation.scores import instance, semantic
from lab.evaluation.scores.instance import NOTHING
from ovip.scene.types import F32, F64, I64, Bools, DetectionBatch, MapObject
from services.mapper.domain.object_map import ObjectMap, map_of
from services.mapper.domain.params import MapParams

CUTOFF = 0.10
"""Metres from the nearest map point beyond which `strict` calls a surface unmapped."""

N_EXCLUDE = 6
CONFIRMED_BY = 3
"""Detections of a class that make it a detected one, as frames make an object."""


@dataclass(frozen=True, slots=True, eq=False)
class Mapped:
    """A map as the protocols read it. points: `(M, 3)` metres; owners: `(M,)` rows of `objects`."""

    objects: tuple[MapObject, ...]
    points: F32
    owners: I64


@dataclass(frozen=True, slots=True, eq=False)
class Transfer:
    """Which object `(P,)` each of a place's points takes: the nearest one's, and NOTHING beyond the cut-off."""

    compat: I64
    strict: I64


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """keep: `(C,)` the classes that are scored; truth: `(K,)` class of each point; seen: the objects they take."""

    keep: Bools
    truth: I64
    seen: Transfer


def mapped(batches: Iterable[DetectionBatch], params: MapParams) -> Mapped:
    """The map of all batches, settled, as readers see it."""
    return read_map(map_of(batches, params))


def read_map(object_map: ObjectMap) -> Mapped:
    """The confirmed objects of a map, with their clouds in one."""
    objects = object_map.objects()
    clouds = [cloud[0] for o in objects if (cloud := object_map.cloud_of(o.object_id)) is not None]
    owners = np.repeat(np.arange(len(clouds)), [len(cloud) for cloud in clouds])
    points = np.concatenate(clouds) if clouds else np.zeros((0, 3), np.float32)
    return Mapped(objects, points, owners.astype(np.int64))


def transfer(scene: Mapped, points: F32) -> Transfer:
    """The object of the nearest map point of each of `(P, 3)` points; NOTHING everywhere in an empty map."""
    if not len(scene.points):
        nothing = np.full(len(points), NOTHING, np.int64)
        return Transfer(nothing, nothing)
    distance, nearest = cKDTree(scene.points).query(points)
    owner = scene.owners[nearest]
    return Transfer(owner, np.where(distance <= CUTOFF, owner, NOTHING))


def judged(place: Place, scene: Mapped, n_exclude: int = N_EXCLUDE) -> Judged:
    """The points of the place's reconstruction that are scored, and the objects that they take."""
    keep = semantic.kept_classes(place.class_names, place.dense_class, place.excluded(n_exclude))
    counts = keep[place.dense_class]
    return Judged(keep, place.dense_class[counts], transfer(scene, place.dense[counts]))


def semantic_scores(
    place: Place, scene: Mapped, points: Judged, lam: float = 0.0
) -> tuple[semantic.SemanticScore, semantic.SemanticScore]:
    """compat and strict scores of a map on the points that are `judged`.

    lam: how much an object's own labels count against its feature.
    """
    classes = object_classes(place, scene, points.keep, lam)
    compat, strict = (
        semantic.semantic_score(points.truth, _value_at(owner, classes), points.keep)
        for owner in (points.seen.compat, points.seen.strict)
    )
    return compat, strict


def object_classes(place: Place, scene: Mapped, keep: Bools, lam: float = 0.0) -> I64:
    """The class of each object `(N,)`: of most s = (1 - lambda) s_clip + lambda s_label."""
    if not scene.objects:
        return np.zeros(0, np.int64)
    scores = semantic.clip_scores(np.stack([o.feature for o in scene.objects]), place.class_features)
    if lam:
        histories = [o.label_counts for o in scene.objects]
        features = {word: place.feature_of(word) for word in {w for h in histories for w in h}}
        scores = semantic.mixed_scores(
            scores, semantic.label_scores(histories, features, place.class_features), lam
        )
    return semantic.classify(scores, keep)


def instance_columns(place: Place, seen: I64) -> dict[str, float]:
    """PQ, SQ, RQ and recall by size of the objects `(P,)` that the place's instance points took."""
    found = instance.panoptic(place.instances, seen)
    areas = dict(zip(place.area_ids.tolist(), place.areas.tolist(), strict=True))
    recall = instance.recall_by_size(areas, found.matched)
    return {
        "PQ": found.pq,
        "SQ": found.sq,
        "RQ": found.rq,
        **{f"recall_{size}": value for size, value in recall.items()},
    }


def class_of_words(place: Place, words: Sequence[str]) -> dict[str, int]:
    """The class of the scene that each word means: the one of that name, else the nearest that is scored by feature.

    NOTHING for the name of a class that is not scored.
    """
    names = place.class_names
    keep = semantic.kept_classes(names, place.dense_class, place.excluded(N_EXCLUDE))
    means = {
        word: names.index(word) if keep[names.index(word)] else NOTHING for word in words if word in names
    }
    others = [word for word in words if word not in names]
    if not keep.any() or not others:
        return means
    features = np.stack([place.feature_of(word) for word in others])
    nearest = semantic.classify(semantic.clip_scores(features, place.class_features), keep)
    return means | dict(zip(others, nearest.tolist(), strict=True))


def label_recall(place: Place, scene: Mapped, seen: I64) -> F64:
    """Label-area recall of each class `(C,)`: share of its instances' surface whose object's label means the class."""
    means = class_of_words(place, sorted({o.label for o in scene.objects}))
    classes = np.array([means.get(o.label, NOTHING) for o in scene.objects], np.int64)
    return instance.label_area_recall(place.point_class, _value_at(seen, classes), place.classes)


def detected_classes(place: Place, batches: Iterable[DetectionBatch]) -> Bools:
    """Which classes `(C,)` the cache has enough detections of, by label, to confirm an object."""
    counts = Counter(d.label for batch in batches for d in batch.detections)
    means = class_of_words(place, sorted(counts))
    total = np.zeros(place.classes, np.int64)
    for word, class_index in means.items():
        if class_index != NOTHING:
            total[class_index] += counts[word]
    return np.asarray(total >= CONFIRMED_BY)


def _value_at(owner: I64, values: I64) -> I64:
    """`values` of each point's owner `(P,)`; NOTHING (which is UNMAPPED too) where it has none."""
    if not len(values):
        return np.full(len(owner), NOTHING, np.int64)
    return np.where(owner == NOTHING, NOTHING, values[owner])
