"""What a detector calls a thing: its label, a near synonym, something that looks alike, or anything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lab.simulation.imperfect.kinship import kin_words, lookalikes, near_synonyms
from lab.simulation.imperfect.params import ImperfectParams
from lab.simulation.imperfect.streams import happens, stream
from ovip.scene.words import normalize_word

_AGAIN = 0.75  # of a thing's wrong words are its usual one


def called(
    label: str, object_id: int, smallness: float, params: ImperfectParams, seed: int, frame: int
) -> str:
    """The word for a thing in a frame. smallness: 0..1, 1 for a thing that can hardly be seen."""
    label = normalize_word(label)
    for mistake, level, words in (
        ("wrong", params.wrong, kin_words()),
        ("lookalike", params.lookalike, lookalikes(label)),
        ("synonym", params.synonym, near_synonyms(label)),
    ):
        if words and happens(seed, mistake, level * (1 + smallness), object_id, frame):
            return _chosen(words, seed, mistake, object_id, frame)
    return label


def any_word(rng: np.random.Generator) -> str:
    """Any word of the table of kin."""
    words = kin_words()
    return words[int(rng.integers(len(words)))]


def _chosen(words: Sequence[str], seed: int, mistake: str, object_id: int, frame: int) -> str:
    """A thing's usual wrong word, sometimes another; earlier words are likelier to be the usual one."""
    usual, now = stream(seed, mistake, "word", object_id), stream(seed, mistake, "word", object_id, frame)
    rng = usual if now.random() < _AGAIN else now
    return words[int(len(words) * rng.random() ** 2)]
