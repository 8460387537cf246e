"""S(goal | region): how likely a thing is in a room of some function (CARA; SPEC 6 without a VLM)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32
from ovip.scene.words import normalize_word
from services.retrieval.domain.names import TextFeatures
from services.retrieval.domain.vocabulary import ROOM_FUNCTIONS, ROOMS_OF, rooms_of


@dataclass(frozen=True, slots=True)
class PriorParams:
    """often, sometimes, never: S for the table's 2, 1 and nothing; unknown: S where nothing is known.

    nearest: table words that stand in for an unknown word, by text features, each at least `least_cosine`
    alike.
    """

    often: float = 0.8
    sometimes: float = 0.4
    never: float = 0.05
    unknown: float = 0.3
    nearest: int = 3
    least_cosine: float = 0.35


@dataclass(frozen=True, slots=True)
class Priors:
    """S by region id, and in words what it rests on."""

    by_region: Mapping[str, float]
    why: str


_ALIASES = {
    "lounge": "living room",
    "sitting room": "living room",
    "family room": "living room",
    "living area": "living room",
    "dining area": "dining room",
    "dining": "dining room",
    "living": "living room",
    "kitchen area": "kitchen",
    "kitchenette": "kitchen",
    "pantry": "kitchen",
    "cooking area": "kitchen",
    "restroom": "bathroom",
    "washroom": "bathroom",
    "toilet": "bathroom",
    "sleeping area": "bedroom",
    "guest room": "bedroom",
    "study": "office",
    "work area": "office",
    "workspace": "office",
    "home office": "office",
    "meeting room": "office",
    "corridor": "hallway",
    "entryway": "hallway",
    "entrance": "hallway",
    "hall": "hallway",
    "laundry": "laundry room",
    "utility room": "laundry room",
    "playroom": "bedroom",
    "nursery": "bedroom",
    "storage": "garage",
    "storage room": "garage",
    "workshop": "garage",
    "exercise area": "gym",
    "fitness area": "gym",
    "terrace": "balcony",
    "patio": "balcony",
    "porch": "balcony",
}


def function_of(name: str) -> str:
    """The table's room function behind a region's function or a spoken room name; empty where unknown."""
    word = normalize_word(name.replace("/", " "))
    word = _ALIASES.get(word, word)
    return (
        word if word in ROOM_FUNCTIONS else next((f for f in ROOM_FUNCTIONS if f" {f} " in f" {word} "), "")
    )


def table_priors(
    noun: str,
    functions: Mapping[str, str],
    texts: TextFeatures | None = None,
    params: PriorParams | None = None,
) -> Priors:
    """S by region id from the table, regions given as {id: function}.

    A noun that the table lacks takes the mean of its nearest table words, weighted by cosine.
    """
    params = params or PriorParams()
    rows, why = _rows(noun, texts, params)
    return Priors(
        {region: _prior(rows, function_of(name), params) for region, name in functions.items()}, why
    )


def _rows(
    noun: str, texts: TextFeatures | None, params: PriorParams
) -> tuple[tuple[tuple[float, Mapping[str, float]], ...], str]:
    """The table rows that speak for the noun with their weights."""
    if rooms := rooms_of(noun):
        return ((1.0, rooms),), f"room table's row for {noun!r}"
    near = _nearest_words(noun, texts, params)
    if not near:
        return (), f"the room table has no row for {noun!r} or like it"
    return (
        tuple((cosine, ROOMS_OF[word]) for word, cosine in near),
        f"room table's rows nearest to {noun!r}: {', '.join(word for word, _ in near)}",
    )


def _nearest_words(noun: str, texts: TextFeatures | None, params: PriorParams) -> Sequence[tuple[str, float]]:
    if texts is None or noun not in texts.features:
        return ()
    words = [word for word in ROOMS_OF if word in texts.features]
    if not words:
        return ()
    table: F32 = np.stack([texts.features[word] for word in words])
    cosines = table @ texts.features[noun]
    order = np.argsort(-cosines, kind="stable")[: params.nearest]
    return [(words[k], float(cosines[k])) for k in order if cosines[k] >= params.least_cosine]


def _prior(rows: Sequence[tuple[float, Mapping[str, float]]], function: str, params: PriorParams) -> float:
    if not rows or not function:
        return params.unknown
    scale = {0.0: params.never, 1.0: params.sometimes, 2.0: params.often}
    weights = np.array([weight for weight, _ in rows])
    values = np.array([scale[rooms.get(function, 0.0)] for _, rooms in rows])
    return float((weights * values).sum() / weights.sum())
