"""Tiers 1 to 3 in turn, each only where cheaper evidence is missing or rejected, with a report of each."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable, Mapping

from ovip.scene.answers import Answer, SearchEvent, TierReport, TierResult, TierStarted
from services.retrieval import answering, metrics
from services.retrieval.case import Case, Ruling
from services.retrieval.domain import cascade
from services.retrieval.tiers import look_in_history, look_in_map, look_in_tags

_TIERS: Mapping[int, Callable[[Case], Awaitable[Ruling]]] = {
    1: look_in_map,
    2: look_in_tags,
    3: look_in_history,
}


class FirstTiers:
    """One question's way through tiers 1 to 3. reports: of the tiers so far, skipped ones too."""

    def __init__(self, case: Case, clock: Callable[[], float]) -> None:
        self._case = case
        self._clock = clock
        self._lowest, self._highest = cascade.bounds(case.query)
        self._ruling = Ruling(TierResult.SKIPPED, "")
        self._ran: list[TierReport] = []
        self.reports: list[TierReport] = []

    async def run(self) -> AsyncIterator[SearchEvent]:
        """Runs them, telling of each as it starts and ends."""
        for report in cascade.skipped(self._lowest):
            self.reports.append(report)
            yield report
        while (tier := self._next()) in _TIERS:
            yield TierStarted(tier)
            yield await self._run_one(tier)

    async def answer(self) -> Answer | None:
        """What they came to; None where tier 4 is to go on."""
        if self._next() == cascade.LAST_TIER:
            return None
        return await answering.settle(self._case, self.reports, self._ruling, self._highest)

    def _next(self) -> int:
        """The tier to run now; 0 where the cascade has ended."""
        return cascade.next_tier(self._lowest, self._highest, self._ran) or 0

    async def _run_one(self, tier: int) -> TierReport:
        began, calls = self._clock(), self._case.judge.vlm.calls
        self._ruling = await _TIERS[tier](self._case)
        seconds = self._clock() - began
        metrics.TIER_SECONDS.labels(tier=str(tier)).observe(seconds)
        spent = self._case.judge.vlm.calls - calls
        report = TierReport(tier, self._ruling.result, self._ruling.why, spent, seconds * 1e3)
        self._ran.append(report)
        self.reports.append(report)
        return report
