"""How much a word speaks for each function, looked up in the table: whole, by its room, or by its last word."""

from __future__ import annotations

import re
from functools import cache, lru_cache

import numpy as np

from ovip.scene.types import F64
from ovip.scene.words import normalize_word
from services.regions.domain.function_table import FUNCTION_WORDS, NEUTRAL_WORDS

FUNCTIONS: tuple[str, ...] = tuple(FUNCTION_WORDS)
_POSSIBLE = 0.4
"""Weight of a `possible` word beside 1 for a `typical` one."""
_ASIDE = re.compile(r"\s*\([^)]*\)?")
_TOYS = ("toy", "stuffed", "plush")
_ROOMS = {
    "kitchen": "kitchen",
    "dining": "dining area",
    "dining room": "dining area",
    "living room": "living room",
    "bedroom": "bedroom",
    "nursery": "bedroom",
    "bathroom": "bathroom",
    "bath": "bathroom",
    "toilet": "bathroom",
    "shower": "bathroom",
    "office": "office",
    "meeting room": "meeting room",
    "conference": "meeting room",
    "laundry": "laundry",
    "hallway": "hallway",
    "entryway": "hallway",
    "gym": "gym",
    "exercise": "gym",
    "fitness": "gym",
    "playroom": "playroom",
    "garage": "garage",
    "balcony": "balcony",
    "patio": "balcony",
    "garden": "balcony",
    "outdoor": "balcony",
}
"""A word that begins with one of these names a thing of that room."""


def prior_of(word: str) -> F64 | None:
    """How much a word speaks for each function -> `(T,)`, in sum at most 1; None for one that is not listed or
    says nothing."""
    found = _found(word)
    return found if found is not None and found.any() else None


def is_listed(word: str) -> bool:
    """Whether the table knows a word, be it as one that says nothing."""
    return _found(word) is not None


def table_words() -> tuple[str, ...]:
    """Every word of the table, sorted, with those that say nothing."""
    return tuple(sorted(_table()))


@lru_cache(maxsize=16_384)
def _found(text: str) -> F64 | None:
    """The row of a word as it is, else of the room it begins with ("kitchen scale"), else of the thing that its last
    words name ("hardback book"); what stands in brackets ("bat (animal)") is left out."""
    word = normalize_word(text)
    if word in _table():
        return _table()[word]
    parts = normalize_word(_ASIDE.sub("", text)).split(" ")
    rows = [_table().get(" ".join(parts)), _by_room(parts)]
    rows += [_table().get(" ".join(parts[k:])) for k in range(1, len(parts))]
    return next((row for row in rows if row is not None), None)


def _by_room(parts: list[str]) -> F64 | None:
    if len(parts) > 1 and parts[0] in _TOYS:
        return _table()["toy"]
    beginnings = (" ".join(parts[:length]) for length in (2, 1) if length < len(parts))
    room = next((_ROOMS[beginning] for beginning in beginnings if beginning in _ROOMS), None)
    return None if room is None else np.eye(len(FUNCTIONS))[FUNCTIONS.index(room)]


@cache
def _table() -> dict[str, F64]:
    weights: dict[str, F64] = {word: np.zeros(len(FUNCTIONS)) for word in _split(NEUTRAL_WORDS)}
    for k, words in enumerate(FUNCTION_WORDS.values()):
        for weight, listed in ((_POSSIBLE, words.possible), (1.0, words.typical)):
            for word in _split(listed):
                weights.setdefault(word, np.zeros(len(FUNCTIONS)))[k] = weight
    return {word: weight / max(1.0, weight.sum()) for word, weight in weights.items()}


def _split(words: str) -> list[str]:
    return [word for word in (normalize_word(part) for part in words.split(",")) if word]
