"""A scene with truth for the mapping protocols: its points, and one detection cache that every configuration reads."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lab.evaluation.scores.semantic import EXCLUDED
from ovip.scene.types import F32, F64, I64

_ARRAYS = (
    *("word_features", "dense", "dense_class", "points", "instances", "point_class"),
    *("area_ids", "areas", "sizes"),
)
_TEXTS = ("name", "words", "classes", "structural", "frames", "detections", "features", "storeys")


@dataclass(frozen=True, slots=True)
class Storey:
    """Where a storey lies, for pictures: metres of its floor and ceiling; areas: names and rings of (x, y)."""

    name: str
    low: float
    high: float
    areas: tuple[tuple[str, tuple[tuple[float, float], ...]], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """What is known of a scene, and where its detections lie.

    words: everything that a detection or a class may be called, `word_features` `(W, D)` their unit text features;
    the first `classes` of them are the scene's class table. structural: labels that the instance protocol leaves out.
    dense: `(Q, 3)` reconstruction of the same depth, metres; dense_class: `(Q,)` class of the nearest truth point.
    points: `(P, 3)` truth points of the instances that count, spread evenly over their surface; instances,
    point_class: `(P,)` their instance and class. area_ids, areas: `(I,)` those instances and their square metres.
    sizes: `(I,)` metres of the longest side. frames, detections: in the cache. features: which space they lie in.
    """

    name: str
    words: tuple[str, ...]
    word_features: F32
    classes: int
    structural: frozenset[str]
    dense: F32
    dense_class: I64
    points: F32
    instances: I64
    point_class: I64
    area_ids: I64
    areas: F64
    sizes: F64
    frames: int
    detections: int
    features: str
    storeys: tuple[Storey, ...]
    cache: Path

    @property
    def class_names(self) -> tuple[str, ...]:
        """The scene's class table."""
        return self.words[: self.classes]

    @property
    def class_features(self) -> F32:
        """`(C, D)` of the class table."""
        return self.word_features[: self.classes]

    def excluded(self, n_exclude: int) -> frozenset[str]:
        """The classes that `n_exclude` leaves out: the evaluator's, and at 6 all structure."""
        return EXCLUDED[n_exclude] | (self.structural if n_exclude == max(EXCLUDED) else frozenset())

    def feature_of(self, word: str) -> F32:
        """Text feature `(D,)` of one of the words."""
        return np.asarray(self.word_features[self.words.index(word)], np.float32)


def save_place(folder: Path, place: Place) -> None:
    """Writes all but the cache, which lies in `folder` already; place.json last, as the sign that all is there."""
    np.savez(folder / "place.npz", **{name: getattr(place, name) for name in _ARRAYS})
    plain = {
        **{name: getattr(place, name) for name in _TEXTS},
        "structural": sorted(place.structural),
        "storeys": [asdict(storey) for storey in place.storeys],
        "cache": place.cache.name,
    }
    (folder / "place.json").write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")


def load_place(folder: Path) -> Place | None:
    """The place that was saved in `folder`, None where there is none, or one that was not finished."""
    if not (folder / "place.json").is_file():
        return None
    texts = json.loads((folder / "place.json").read_text(encoding="utf-8"))
    with np.load(folder / "place.npz") as stored:
        arrays = {name: stored[name] for name in _ARRAYS}
    texts |= {
        "words": tuple(texts["words"]),
        "structural": frozenset(texts["structural"]),
        "storeys": tuple(_storey(plain) for plain in texts["storeys"]),
        "cache": folder / texts["cache"],
    }
    return Place(**texts, **arrays)


def _storey(plain: dict[str, Any]) -> Storey:
    areas = tuple((name, tuple((x, y) for x, y in ring)) for name, ring in plain["areas"])
    return Storey(plain["name"], plain["low"], plain["high"], areas)
