"""How the noun of a question meets a class name: equal, synonym, kind of it, or alike in text features (CARA,
Tier 1).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ovip.scene.features import cosine
from ovip.scene.types import F32
from ovip.scene.words import normalize_word
from services.retrieval.domain.query import ANYTHING
from services.retrieval.domain.vocabulary import is_kind_of_head, is_known, kind_of, same_thing, synonyms


class NameKind(StrEnum):
    EXACT = "the same name"
    SYNONYM = "a synonym"
    KIND = "a kind of it"
    BROADER = "its broader name"
    SIMILAR = "alike in text features"
    ANY = "anything asked for"


@dataclass(frozen=True, slots=True)
class NameParams:
    """Scores of a match by name, and the least cosine of a match by text features.

    similarity: by text space (a piece of its name), because no threshold fits two spaces; a space not listed
    here matches by name only. minilm: measured with all-MiniLM-L6-v2 over the 80 COCO names, 45 synonyms and
    110 other household words: words of our vocabulary match by name only ("piano" is .59 from "keyboard",
    "hairbrush" .82 from "toothbrush"), so this decides for other words alone. vit-b-32: LVIS names, of which
    different things lie as close as .94.
    """

    exact: float = 1.0
    synonym: float = 0.95
    kind: float = 0.9
    broader: float = 0.85
    similarity: Mapping[str, float] = field(default_factory=lambda: {"minilm": 0.75, "vit-b-32": 0.95})

    def threshold(self, text_space: str) -> float | None:
        """The least cosine in a text space; None where it was never measured."""
        space = text_space.lower().replace("/", "-")
        return next((value for piece, value in self.similarity.items() if piece in space), None)


@dataclass(frozen=True, slots=True)
class NameMatch:
    """A class name that the noun may mean. leftover: words of the noun that the name does not cover."""

    name: str
    kind: NameKind
    score: float
    leftover: str = ""


@dataclass(frozen=True, slots=True)
class TextFeatures:
    """Unit text features `(D,)` by word, in one text space. Words not in it are matched by name only."""

    space: str
    features: Mapping[str, F32]

    def similarity(self, noun: str, name: str) -> float | None:
        """Greatest cosine of the noun with the name or a synonym of it; None where a feature is missing."""
        held = [self.features[word] for word in synonyms(name) if word in self.features]
        if noun not in self.features or not held:
            return None
        return float(cosine(self.features[noun][None], np.stack(held)).max())


def match_names(
    noun: str, names: Sequence[str], texts: TextFeatures | None, params: NameParams
) -> tuple[NameMatch, ...]:
    """Every distinct name that the noun may mean, best first; ties in alphabetical order.

    Where some name is the noun's own or a synonym or kind of it, names that are only alike are left out.
    """
    found = [match for name in sorted(set(names)) if (match := match_name(noun, name, texts, params))]
    named = [match for match in found if match.kind is not NameKind.SIMILAR]
    return tuple(sorted(named or found, key=lambda match: (-match.score, match.name)))


def match_name(noun: str, name: str, texts: TextFeatures | None, params: NameParams) -> NameMatch | None:
    """How a class name meets the noun, or None."""
    label = normalize_word(name)
    if noun == ANYTHING:
        return NameMatch(name, NameKind.ANY, params.kind)
    if noun == label:
        return NameMatch(name, NameKind.EXACT, params.exact)
    if same_thing(noun, label):
        return NameMatch(name, NameKind.SYNONYM, params.synonym)
    if _ends_with(label, noun):
        return NameMatch(name, NameKind.KIND, params.kind)
    alike = _alike(noun, name, texts, params)
    if (leftover := _broader(noun, label)) is not None:
        return NameMatch(name, NameKind.BROADER, params.broader, "" if alike is not None else leftover)
    if alike is None or is_known(noun):
        return None
    return NameMatch(name, NameKind.SIMILAR, alike)


def nearest_name(noun: str, names: Sequence[str], texts: TextFeatures | None) -> tuple[str, float] | None:
    """The name most alike in text features, matching or not: what a report says of a miss."""
    near = [
        (name, value)
        for name in sorted(set(names))
        if texts and (value := texts.similarity(noun, name)) is not None
    ]
    return max(near, key=lambda pair: pair[1], default=None)


def _ends_with(compound: str, head: str) -> bool:
    """Whether the compound is a kind of `head` or a synonym: `wine glass` and `glass`, `armchair` and
    `chair`.
    """
    if kind_of(compound) and same_thing(kind_of(compound), head):
        return True
    if not is_kind_of_head(compound):
        return False
    return any(compound.endswith(f" {word}") for word in synonyms(head))


def _broader(noun: str, label: str) -> str | None:
    """What the noun says beyond the label: `office` of `office chair` and `chair`, all of `armchair` and
    `chair`.
    """
    if kind_of(noun) and same_thing(kind_of(noun), label):
        return noun
    if not is_kind_of_head(noun):
        return None
    return next((noun[: -len(word) - 1] for word in synonyms(label) if noun.endswith(f" {word}")), None)


def _alike(noun: str, name: str, texts: TextFeatures | None, params: NameParams) -> float | None:
    """The cosine where it reaches the text space's threshold."""
    threshold = params.threshold(texts.space) if texts else None
    similarity = texts.similarity(noun, normalize_word(name)) if texts else None
    if threshold is None or similarity is None or similarity < threshold:
        return None
    return similarity
