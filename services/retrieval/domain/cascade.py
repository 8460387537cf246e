"""Which tier runs when: each only when cheaper evidence is missing or rejected (CARA, trigger legitimacy)."""

from __future__ import annotations

from collections.abc import Sequence

from ovip.errors import InvalidInput
from ovip.scene.answers import Query, TierReport, TierResult

LAST_TIER = 4


def bounds(query: Query) -> tuple[int, int]:
    """Lowest and highest tier to run; InvalidInput where the query's do not make sense."""
    lowest, highest = query.min_tier or 1, query.max_tier or LAST_TIER
    for name, value in (("min_tier", query.min_tier), ("max_tier", query.max_tier)):
        if not 0 <= value <= LAST_TIER:
            raise InvalidInput(f"{name}: expected 0 (default) or a tier 1 to {LAST_TIER}, got {value}")
    if lowest > highest:
        raise InvalidInput(
            f"min_tier: expected at most max_tier, got min_tier {lowest} and max_tier {highest}"
        )
    return lowest, highest


def next_tier(lowest: int, highest: int, reports: Sequence[TierReport]) -> int | None:
    """The tier to run after those reported; None where the cascade ends.

    A tier that found ends it. So does one whose candidates only a person or a VLM could settle (AMBIGUOUS),
    except Tier 1, whose ambiguity is Tier 2's to judge. MISSING, REJECTED, SKIPPED and EXHAUSTED go on.
    """
    if not reports:
        return lowest
    last = reports[-1]
    if last.result in (TierResult.FOUND, TierResult.WAITING):
        return None
    if last.result is TierResult.AMBIGUOUS and last.tier > 1:
        return None
    return last.tier + 1 if last.tier < highest else None


def skipped(lowest: int) -> tuple[TierReport, ...]:
    """Reports of the tiers below the lowest one allowed."""
    return tuple(
        TierReport(tier, TierResult.SKIPPED, f"the query asks for tier {lowest} and above", 0, 0.0)
        for tier in range(1, lowest)
    )
