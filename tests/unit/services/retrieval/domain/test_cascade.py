from __future__ import annotations

import pytest

from ovip.errors import InvalidInput
from ovip.scene.answers import Query, TierReport, TierResult
from services.retrieval.domain.cascade import bounds, next_tier, skipped


def report(tier: int, result: TierResult) -> TierReport:
    return TierReport(tier, result, "", 0, 0.0)


@pytest.mark.parametrize(
    ("tier", "result", "following"),
    [
        (1, TierResult.FOUND, None),
        (1, TierResult.MISSING, 2),
        (1, TierResult.AMBIGUOUS, 2),
        (2, TierResult.AMBIGUOUS, None),
        (2, TierResult.REJECTED, 3),
        (3, TierResult.MISSING, 4),
        (3, TierResult.SKIPPED, 4),
        (3, TierResult.FOUND, None),
        (4, TierResult.WAITING, None),
        (4, TierResult.MISSING, None),
    ],
)
def test_a_tier_runs_only_when_cheaper_evidence_is_missing_or_rejected(
    tier: int, result: TierResult, following: int | None
) -> None:
    assert next_tier(1, 4, [report(tier, result)]) == following


def test_the_cascade_starts_at_the_lowest_tier_and_ends_at_the_highest() -> None:
    assert next_tier(4, 4, []) == 4
    assert next_tier(1, 2, [report(2, TierResult.MISSING)]) is None


def test_skipped_tiers_say_why() -> None:
    assert [(r.tier, r.result) for r in skipped(3)] == [(1, TierResult.SKIPPED), (2, TierResult.SKIPPED)]
    assert "tier 3" in skipped(3)[0].why
    assert skipped(1) == ()


def test_zeros_mean_all_tiers() -> None:
    assert bounds(Query("s", "mug")) == (1, 4)
    assert bounds(Query("s", "mug", min_tier=4)) == (4, 4)


@pytest.mark.parametrize(
    "wrong", [{"max_tier": 5}, {"min_tier": 9}, {"min_tier": 3, "max_tier": 2}, {"max_tier": -1}]
)
def test_impossible_tiers_are_refused_saying_what_was_expected(wrong: dict[str, int]) -> None:
    with pytest.raises(InvalidInput, match="expected"):
        bounds(Query("s", "mug", **wrong))
