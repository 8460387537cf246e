"""Which mapped object a question means, by policies that do without the cascade: what it is compared with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.scene.features import cosine
from ovip.scene.types import F32, F64, MapObject
from ovip.scene.words import normalize_word


def lexical(text: str, objects: Sequence[MapObject]) -> tuple[MapObject, ...]:
    """Objects whose label shares a word with the question, most shared words first; none is no answer.

    Ties go to the label with fewer other words, then to the object seen in more frames, then by id.
    """
    asked = _words(text)
    shared = [(len(asked & _words(o.label)), len(_words(o.label) - asked), o) for o in objects]
    named = [entry for entry in shared if entry[0]]
    return tuple(o for *_, o in sorted(named, key=lambda e: (-e[0], e[1], -e[2].frames, e[2].object_id)))


def most_alike(feature: F32, objects: Sequence[MapObject]) -> tuple[MapObject, ...]:
    """All objects by the cosine of their feature with the question's text feature `(D,)`; ties by id."""
    if not objects:
        return ()
    likeness = cosine(feature[None], np.stack([o.feature for o in objects]))[0]
    order = sorted(range(len(objects)), key=lambda k: (-float(likeness[k]), objects[k].object_id))
    return tuple(objects[k] for k in order)


def nearest(place: F64, objects: Sequence[MapObject]) -> tuple[MapObject, ...]:
    """All objects by their distance on the floor from `place` `(2,)`, whatever was asked; ties by id."""
    return tuple(sorted(objects, key=lambda o: (float(np.hypot(*(o.centroid[:2] - place))), o.object_id)))


def random(rng: np.random.Generator, objects: Sequence[MapObject]) -> tuple[MapObject, ...]:
    """All objects in any order."""
    return tuple(objects[k] for k in rng.permutation(len(objects)))


def _words(text: str) -> frozenset[str]:
    return frozenset(normalize_word(text).split())
