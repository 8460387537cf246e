"""Vocabulary: how much of what is named is there, how much of what is there is named, and which objects are false."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from lab.simulation.imperfect.kinship import near_synonyms
from ovip.scene.boxes import pair_touching
from ovip.scene.types import F64

Means = Callable[[str, str], bool]
"""Whether a word may be said of a thing with a label."""


@dataclass(frozen=True, slots=True)
class VocabularyScore:
    """precision: share of the words that mean some label; recall: share of the labels that some word means."""

    precision: float
    recall: float


def means_exactly(word: str, label: str) -> bool:
    """The very word."""
    return word == label


def means_loosely(word: str, label: str) -> bool:
    """The very word or a near synonym."""
    return word == label or label in near_synonyms(word)


def vocabulary_score(words: Collection[str], labels: Collection[str], means: Means) -> VocabularyScore:
    """Words against the labels of what is there; 0 for none of either."""
    right = sum(any(means(word, label) for label in labels) for word in words)
    named = sum(any(means(word, label) for word in words) for label in labels)
    return VocabularyScore(right / len(words) if words else 0.0, named / len(labels) if labels else 0.0)


def is_false(word: str, box: F64, things: Sequence[tuple[str, F64]], means: Means) -> bool:
    """Whether no thing (label and box `(6,)`) that the word means shares space with an object's box `(6,)`."""
    return not any(means(word, label) and pair_touching(box, held) for label, held in things)
