"""What judging a candidate says: a score, a verdict, the reason in words, and what could not be judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    ACCEPT = "accepted"
    REJECT = "rejected"
    UNSURE = "not settled"


@dataclass(frozen=True, slots=True)
class Judgement:
    """score: 0..1, higher is likelier. unjudged: the words that this judge has no way to judge."""

    verdict: Verdict
    score: float
    why: str
    unjudged: tuple[str, ...] = ()


AGREED = Judgement(Verdict.ACCEPT, 1.0, "")
"""Nothing was asked, so nothing speaks against it."""


def combine(judgements: Sequence[Judgement]) -> Judgement:
    """All of them together: one rejection rejects, all must accept to accept; the score is the least. Empty:
    AGREED.
    """
    if not judgements:
        return AGREED
    verdicts = {judgement.verdict for judgement in judgements}
    verdict = (
        Verdict.REJECT
        if Verdict.REJECT in verdicts
        else Verdict.ACCEPT
        if verdicts == {Verdict.ACCEPT}
        else Verdict.UNSURE
    )
    return Judgement(
        verdict,
        min(judgement.score for judgement in judgements),
        "; ".join(judgement.why for judgement in judgements if judgement.why),
        tuple(word for judgement in judgements for word in judgement.unjudged),
    )
