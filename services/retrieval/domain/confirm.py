"""Confirming a candidate without a VLM: its feature against the target's word and distractors (SPEC 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

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

    label_share: the weight of the detector's own label in the features of a space (by a piece of its name). It
    is taken out first, else every label would confirm itself.
    """

    accept: float = 0.2
    reject: float = 0.4
    label_share: Mapping[str, float] = field(default_factory=lambda: {"conse": 0.75})

    def share_in(self, text_space: str) -> float:
        """The label's weight in a space; 0 where its features are of the image alone."""
        return next((share for piece, share in self.label_share.items() if piece in text_space.lower()), 0.0)


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


def without_label(feature: F32, label: F32, share: float) -> F32:
    """The image's own part l of a feature f, where

        f = (share t + (1 - share) l) / |share t + (1 - share) l|,   t = t(label), |t| = |l| = 1

    With x = l.t and c = f.t, the norm n of the sum is n^2 = share^2 + (1 - share)^2 + 2 share (1 - share) x, and
    n c = share + (1 - share) x; both hold for the greater root of n^2 - 2 share c n + 2 share - 1 = 0.
    """
    if share <= 0.0:
        return feature
    c = float(feature @ label)
    n = share * c + float(np.sqrt(max((share * c) ** 2 - (2.0 * share - 1.0), 0.0)))
    return normalize(np.asarray((n * feature - share * label) / (1.0 - share), np.float32))


def target_words(noun: str) -> tuple[str, ...]:
    """The words that stand for the target in text features, and that a grounder is asked for."""
    return synonyms(noun)
