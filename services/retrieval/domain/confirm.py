"""Confirming a candidate without a VLM: its feature against the target's word and distractors (SPEC 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.features import cosine, normalize
from ovip.scene.types import F32
from services.retrieval.domain.judgement import Judgement, Verdict
from services.retrieval.domain.vocabulary import ROOMS_OF, same_thing, synonyms


@dataclass(frozen=True, slots=True)
class ConfirmParams:
    """Shares of the distractors that may be more alike than the target: up to `accept` confirms, over
    `reject` refuses.

    Measured with the embedded encoder (ImageNet posterior in MiniLM space) on detections of a real kitchen,
    mean feature of several views, 121 words: true ones ranked 0 (chair), 0 (laptop), 1 (cup), 1 (television),
    2 (table), 3 (phone), 20 (book); false ones 65 (refrigerator), 95 (umbrella), 120 (stop sign). One view
    alone is much weaker.
    """

    accept: float = 0.2
    reject: float = 0.4


def distractors(noun: str) -> tuple[str, ...]:
    """Household words that are not the target."""
    return tuple(word for word in ROOMS_OF if not same_thing(noun, word))


def confirm_by_features(
    noun: str, views: Sequence[F32], target: F32, others: F32, params: ConfirmParams | None = None
) -> Judgement:
    """The mean of the views' unit features against the target's text features `(K, D)` and the distractors'
    `(N, D)`.

    The score is 1 minus the share of distractors that are more alike than the target's best word. Views
    without a feature (zero or of another length) are left out; none left: unsettled.
    """
    params = params or ConfirmParams()
    usable = [view for view in views if view.shape == target.shape[1:] and float(np.linalg.norm(view)) > 0.5]
    if not usable or not len(others):
        return Judgement(Verdict.UNSURE, 0.5, "no image feature to confirm it by", (noun,))
    seen = normalize(np.mean(usable, axis=0, dtype=np.float32))[None]
    share = float((cosine(seen, others)[0] > cosine(seen, target)[0].max()).mean())
    why = (
        f"more like {noun!r} than {100 * (1 - share):.0f}% of {len(others)} other words, {len(usable)} views"
    )
    if share <= params.accept:
        return Judgement(Verdict.ACCEPT, 1.0 - share, why)
    return Judgement(Verdict.REJECT if share > params.reject else Verdict.UNSURE, 1.0 - share, why)


def target_words(noun: str) -> tuple[str, ...]:
    """The words that stand for the target in text features, and that a grounder is asked for."""
    return synonyms(noun)
