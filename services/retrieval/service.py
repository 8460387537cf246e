"""The use cases of retrieval: find with a plan for tier 4, search with a robot, read a search again."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import replace

from ovip.errors import InvalidInput
from ovip.scene.answers import Answer, Outcome, Query, SearchEvent, TierReport, TierStarted
from ovip.telemetry import get_logger
from services.retrieval import active, answering, metrics
from services.retrieval.case import Case
from services.retrieval.domain.goals import NO_PATH
from services.retrieval.domain.search import Phase, Search
from services.retrieval.first_tiers import FirstTiers
from services.retrieval.opening import Desk
from services.retrieval.ports import Searches, StoredSearch
from services.retrieval.robot_search import Logbook, Resume, RobotSearch, SearchMessage

Event = tuple[str, SearchEvent]
log = get_logger("retrieval")


class Retrieval:
    """Answers questions; keeps nothing between them but text features."""

    def __init__(
        self, desk: Desk, searches: Searches, clock: Callable[[], float], new_id: Callable[[], str]
    ) -> None:
        self._desk = desk
        self._searches = searches
        self._logbook = Logbook(searches, desk.scenes)
        self._clock = clock
        self._new_id = new_id

    async def find(self, query: Query) -> AsyncIterator[Event]:
        """Tiers 1 to 3 and the plan of tier 4: events as they happen, the answer last."""
        search_id = self._new_id()
        case = await self._desk.open(query)
        tiers = FirstTiers(case, self._clock)
        async for event in tiers.run():
            yield search_id, event
        answer = await tiers.answer()
        if answer is None:
            yield search_id, TierStarted(4)
            answer = await self._plan(case, search_id, tiers.reports)
            yield search_id, answer.tiers[-1]
        await self._searches.remember(query.scene, search_id, query.text, answer)
        _announce(query, answer)
        yield search_id, answer

    async def search(self, messages: AsyncIterator[SearchMessage]) -> AsyncIterator[Event]:
        """A search with a robot: viewpoints one at a time, each answered by an observation; the answer last.

        What was seen is stored before the next viewpoint goes out, so a robot that lost the connection goes
        on with `Resume`, at any replica. A viewpoint answered twice changes nothing: the one that is due is
        given out again.
        """
        stored, case = await self._begin(messages)
        search_id = stored.search.search_id
        if stored.search.phase is Phase.CASCADE:
            tiers = FirstTiers(case, self._clock)
            async for event in tiers.run():
                yield search_id, event
            stored = await self._keep(stored, case, tiers.reports, await tiers.answer())
        if stored.search.phase is Phase.DONE:
            yield search_id, stored.search.account
            return
        robot = RobotSearch(case, await active.survey(case), self._logbook, self._clock)
        async for event in robot.run(stored, messages):
            if isinstance(event, Answer):
                _announce(case.query, event)
            yield search_id, event

    async def get_search(self, scene: str, search_id: str) -> tuple[str, Answer | None]:
        """A question's text, and its answer or None while it is searching; NotFound where there is none."""
        await self._desk.check_scene(scene)
        name = search_id.rpartition("/")[2]
        kept = await self._searches.recall(scene, name)
        if kept is not None:
            return kept
        search = (await self._searches.load(scene, name)).search
        return search.query.text, search.account if search.phase is Phase.DONE else None

    async def _begin(self, messages: AsyncIterator[SearchMessage]) -> tuple[StoredSearch, Case]:
        """A new search, stored before anything is done for it, or the stored one that is to go on."""
        first = await anext(messages, None)
        if isinstance(first, Resume):
            stored = await self._logbook.load(first.search_id)
            return stored, await self._desk.reopen(stored.search)
        if not isinstance(first, Query):
            raise InvalidInput("search: expected start or resume_search_id as the first message")
        case = await self._desk.open(first)
        nothing_yet = Answer(Outcome.UNRESOLVED, 0, None, None, NO_PATH, ())
        return await self._logbook.create(Search(self._new_id(), first, Phase.CASCADE, nothing_yet)), case

    async def _keep(
        self, stored: StoredSearch, case: Case, reports: Sequence[TierReport], answer: Answer | None
    ) -> StoredSearch:
        """What tiers 1 to 3 came to, stored; the search is done where that is an answer."""
        spent = case.judge.vlm.calls
        if answer is None:
            so_far = answering.account(case, reports, Outcome.UNRESOLVED, 4)
            return await self._logbook.change(stored, lambda s: replace(s, account=so_far, vlm_calls=spent))
        _announce(case.query, answer)
        return await self._logbook.change(
            stored, lambda s: replace(s, phase=Phase.DONE, account=answer, vlm_calls=spent)
        )

    async def _plan(self, case: Case, search_id: str, reports: Sequence[TierReport]) -> Answer:
        """Tier 4 without a robot: what it would do, and what it would need."""
        began, calls = self._clock(), case.judge.vlm.calls
        ground = await active.survey(case)
        so_far = answering.account(case, reports, Outcome.UNRESOLVED, 4)
        search = await active.lay_out(case, ground, Search(search_id, case.query, Phase.CASCADE, so_far))
        ruling = active.planned(case, search)
        spent = (self._clock() - began) * 1e3
        report = TierReport(4, ruling.result, ruling.why, case.judge.vlm.calls - calls, spent)
        coverage = await active.account(case, ground, search) if case.regions() else None
        answer = answering.account(case, [*reports, report], Outcome.UNRESOLVED, 4)
        return replace(answer, coverage=coverage, needs=active.needs(case, search))


def _announce(query: Query, answer: Answer) -> None:
    metrics.ANSWERS.labels(outcome=answer.outcome.value, tier=str(answer.tier)).inc()
    log.info(
        "answered",
        scene=query.scene,
        text=query.text,
        outcome=answer.outcome.value,
        tier=answer.tier,
        ms=round(sum(report.ms for report in answer.tiers), 1),
    )
