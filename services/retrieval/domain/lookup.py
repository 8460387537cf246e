"""Tier 1, map lookup: objects whose class name is what was asked for (CARA, SPEC 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.answers import TierResult
from ovip.scene.types import MapObject
from services.retrieval.domain.names import (
    NameKind,
    NameMatch,
    NameParams,
    TextFeatures,
    match_names,
    nearest_name,
)
from services.retrieval.domain.query import ANYTHING, Attribute, AttributeKind, Target

_SEEN_ENOUGH = 5.0  # frames after which being seen again adds little


@dataclass(frozen=True, slots=True)
class ObjectMatch:
    """An object that the noun may mean. score: 0..1, name times label purity times how often it was seen."""

    object: MapObject
    name: NameMatch
    score: float


@dataclass(frozen=True, slots=True)
class Lookup:
    """What Tier 1 found, best first; FOUND holds one match, AMBIGUOUS goes to Tier 2's judgement."""

    result: TierResult
    matches: tuple[ObjectMatch, ...]
    why: str


def look_up(
    target: Target,
    objects: Sequence[MapObject],
    texts: TextFeatures | None = None,
    params: NameParams | None = None,
) -> Lookup:
    """Objects by class name, without any VLM call. Ties: more frames, then greater view weight, then id."""
    params = params or NameParams()
    labels = {item.label for item in objects}
    names = {match.name: match for match in match_names(target.noun, tuple(labels), texts, params)}
    matches = tuple(
        sorted(
            (_object_match(item, names[item.label]) for item in objects if item.label in names),
            key=lambda m: (-m.score, -m.object.frames, -m.object.view_weight, m.object.object_id),
        )
    )
    if not matches:
        return Lookup(TierResult.MISSING, (), _nothing(target, tuple(labels), texts, params))
    leftover = {m.name.leftover for m in matches} - {""}
    if len(matches) == 1 and target.plain and not leftover:
        return Lookup(TierResult.FOUND, matches, _one(target, matches[0]))
    return Lookup(TierResult.AMBIGUOUS, matches, _several(target, matches, leftover))


def unsettled(target: Target, match: ObjectMatch) -> tuple[Attribute, ...]:
    """What the object's name leaves open: the target's attributes, and words that the name lacks."""
    if not match.name.leftover:
        return target.attributes
    return (*target.attributes, Attribute(AttributeKind.OTHER, match.name.leftover))


def _object_match(item: MapObject, name: NameMatch) -> ObjectMatch:
    counts = sum(item.label_counts.values())
    purity = item.label_counts.get(item.label, 0) / counts if counts else 1.0
    seen = 1.0 - float(np.exp(-max(item.frames, 1) / _SEEN_ENOUGH))
    return ObjectMatch(item, name, name.score * (0.5 + 0.5 * purity) * (0.5 + 0.5 * seen))


def _one(target: Target, match: ObjectMatch) -> str:
    if match.name.kind is NameKind.EXACT:
        return f"one object is called {match.object.label!r}"
    cosine = f" (cosine {match.name.score:.2f})" if match.name.kind is NameKind.SIMILAR else ""
    return f"one object is called {match.object.label!r}, {match.name.kind.value} for {target.noun!r}{cosine}"


def _several(target: Target, matches: Sequence[ObjectMatch], leftover: set[str]) -> str:
    names = " or ".join(repr(name) for name in dict.fromkeys(m.object.label for m in matches[:20]))
    called = f"{len(matches)} objects" if len(matches) > 1 else "one object"
    verb = "are" if len(matches) > 1 else "is"
    if target.noun == ANYTHING:
        return f"no class was named; all {len(matches)} objects are to be judged"
    open_words = [
        *leftover,
        *(a.word for a in target.attributes),
        *(f"{r.words} {r.anchor}" for r in target.relations),
    ]
    if open_words:
        return f"{called} {verb} called {names}; a name cannot settle {', '.join(map(repr, open_words))}"
    return f"{called} {verb} called {names} and nothing in the question tells them apart"


def _nothing(target: Target, labels: Sequence[str], texts: TextFeatures | None, params: NameParams) -> str:
    if not labels:
        return "the map holds no objects yet"
    near = nearest_name(target.noun, labels, texts)
    if near is None:
        return f"no object is called {target.noun!r} or a synonym of it"
    threshold = params.threshold(texts.space) if texts else None
    needed = "" if threshold is None else f", {threshold:.2f} needed"
    return (
        f"no object is called {target.noun!r}; the nearest name is {near[0]!r} (cosine {near[1]:.2f}{needed})"
    )
