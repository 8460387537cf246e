"""Attributes judged without a VLM: colours from the mapped mean colour, sizes from the box (SPEC 6).

What neither shows (floral, wooden, of tea) is not judged: those instances come back unsettled, ranked by how
alike their features are to the words where there are text features, and the judgement names the words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ovip.scene.types import F64
from services.retrieval.domain.colours import ColourParams, judge_colour
from services.retrieval.domain.judgement import AGREED, Judgement, Verdict, combine
from services.retrieval.domain.query import LONG, SHORT, SMALL, TALL, Attribute, AttributeKind

_UNSEEN = 0.5  # score of what was not judged: neither for nor against


@dataclass(frozen=True, slots=True)
class AttributeParams:
    """size_margin: how many times larger (smaller) than the next an instance is for its size to settle it."""

    colour: ColourParams = field(default_factory=ColourParams)
    size_margin: float = 1.2


@dataclass(frozen=True, slots=True)
class Subject:
    """An instance as it is judged. mean_color: `(3,)` RGB 0..255; box: `(6,)` metres; likeness: cosine of its
    feature with the asked phrase, 0 where unknown.
    """

    mean_color: F64
    box: F64
    likeness: float = 0.0


def judge_attributes(
    attributes: Sequence[Attribute], subjects: Sequence[Subject], params: AttributeParams | None = None
) -> tuple[Judgement, ...]:
    """Each of the alike instances against all attributes, in the order given."""
    params = params or AttributeParams()
    if not subjects:
        return ()
    columns = [_judge_one(attribute, subjects, params) for attribute in attributes]
    return tuple(
        combine([column[k] for column in columns]) if columns else AGREED for k in range(len(subjects))
    )


def can_judge(attributes: Sequence[Attribute]) -> bool:
    """Whether colour and box settle every one of them."""
    return all(attribute.kind is not AttributeKind.OTHER for attribute in attributes)


def _judge_one(
    attribute: Attribute, subjects: Sequence[Subject], params: AttributeParams
) -> tuple[Judgement, ...]:
    if attribute.kind is AttributeKind.COLOUR:
        return judge_colour(
            attribute.word, np.array([subject.mean_color for subject in subjects]), params.colour
        )
    if attribute.kind is AttributeKind.SIZE:
        return _judge_size(attribute.word, np.array([subject.box for subject in subjects]), params)
    return tuple(
        Judgement(
            Verdict.UNSURE,
            _likeness_score(s.likeness),
            f"{attribute.word!r} was not judged",
            (attribute.word,),
        )
        for s in subjects
    )


def _likeness_score(likeness: float) -> float:
    return _UNSEEN + 0.25 * float(np.clip(likeness, -1.0, 1.0))


def _judge_size(word: str, boxes: F64, params: AttributeParams) -> tuple[Judgement, ...]:
    """Against the alike instances: the largest (smallest) by the margin is it, one outdone by the margin is
    not.
    """
    if len(boxes) < 2:
        return (Judgement(Verdict.UNSURE, _UNSEEN, f"{word!r} needs a second instance to compare", (word,)),)
    extent = _extent(word, boxes)
    wants_little = word in SMALL | SHORT
    key = 1.0 / extent if wants_little else extent
    return tuple(_size_judgement(word, key, k, params) for k in range(len(key)))


def _extent(word: str, boxes: F64) -> F64:
    """What the word measures: height, longest side, or the cube root of the volume, metres `(N,)`."""
    sides = np.maximum(boxes[:, 3:] - boxes[:, :3], 1e-3)
    if word in TALL | SHORT:
        return sides[:, 2]
    if word in LONG:
        return np.asarray(sides.max(axis=1))
    return np.asarray(np.cbrt(sides.prod(axis=1)))


def _size_judgement(word: str, key: F64, index: int, params: AttributeParams) -> Judgement:
    ratio = float(key[index] / np.delete(key, index).max())
    score = float(np.clip(0.5 + 0.5 * (ratio - 1.0) / (params.size_margin - 1.0), 0.0, 1.0))
    if ratio >= params.size_margin:
        return Judgement(Verdict.ACCEPT, score, f"the {word} one, {ratio:.1f} times beyond the next")
    if ratio <= 1.0 / params.size_margin:
        return Judgement(Verdict.REJECT, score, f"not the {word} one")
    return Judgement(Verdict.UNSURE, score, f"too close in size to the others to be called {word!r}")
