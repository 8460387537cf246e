"""A search with a robot in the loop: viewpoints out, observations in, every step stored before the next."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, replace
from functools import partial

from ovip.errors import Conflict, InvalidInput, NotFound
from ovip.scene.answers import (
    Answer,
    Observation,
    Outcome,
    Query,
    SearchEvent,
    TierReport,
    TierResult,
    TierStarted,
)
from services.retrieval import active, answering, unseen
from services.retrieval.active import Ground
from services.retrieval.case import MOST_CANDIDATES, Case, Ruling, ranked
from services.retrieval.domain.query import ANYTHING
from services.retrieval.domain.search import (
    Phase,
    Search,
    find_step,
    gave_up,
    give_up_rest,
    is_done,
    looked,
)
from services.retrieval.ports import Scenes, Searches, StoredSearch
from services.retrieval.tiers import confirm_votes, ground, is_unseeable

_TRIES = 8


@dataclass(frozen=True, slots=True)
class Resume:
    """Goes on with a stored search. search_id: `SCENE/SEARCH_ID`, or the bare id if some scene holds it."""

    search_id: str


@dataclass(frozen=True, slots=True)
class Cancel:
    """Ends a search without a decision."""


SearchMessage = Query | Resume | Observation | Cancel


class Logbook:
    """Stored searches, changed by compare-and-set against whoever else works on the same one."""

    def __init__(self, searches: Searches, scenes: Scenes) -> None:
        self._searches = searches
        self._scenes = scenes

    async def create(self, search: Search) -> StoredSearch:
        """A new search, stored before anything is done for it."""
        return await self._searches.save(StoredSearch(search.query.scene, search, 0))

    async def load(self, search_id: str) -> StoredSearch:
        """By `SCENE/SEARCH_ID` or bare id; NotFound where there is none."""
        scene, _, name = search_id.rpartition("/")
        for place in [scene] if scene else await self._scenes.scenes():
            try:
                return await self._searches.load(place, name)
            except NotFound:
                continue
        raise NotFound(f"search {search_id!r}: there is no such search; expected SCENE/SEARCH_ID")

    async def change(self, stored: StoredSearch, change: Callable[[Search], Search]) -> StoredSearch:
        """Applies a change that holds on any newer state too; a search that is done stays as it is."""
        for _ in range(_TRIES):
            if stored.search.phase is Phase.DONE:
                return stored
            changed = change(stored.search)
            if changed is stored.search:
                return stored
            try:
                return await self._searches.save(replace(stored, search=changed))
            except Conflict:
                stored = await self._searches.load(stored.scene, stored.search.search_id)
        raise Conflict(f"search {stored.search.search_id}: too many robots answer at once; resume it")


class RobotSearch:
    """Tier 4 of one question with a robot."""

    def __init__(self, case: Case, ground_: Ground, logbook: Logbook, clock: Callable[[], float]) -> None:
        self._case = case
        self._ground = ground_
        self._logbook = logbook
        self._clock = clock
        self._began = clock()
        self._calls = case.judge.vlm.calls

    async def run(
        self, stored: StoredSearch, messages: AsyncIterator[SearchMessage]
    ) -> AsyncIterator[SearchEvent]:
        """Viewpoints and, once it is decided, tier 4's report and the answer; ends early where the robot
        hangs up.
        """
        yield TierStarted(4)
        stored = await self._lay_out(stored)
        while stored.search.phase is not Phase.DONE:
            ruling, outcome = await self._conclude(stored.search)
            due = None if ruling else await active.next_viewpoint(self._case, self._ground, stored.search)
            if due is not None:
                yield due
                message = await anext(messages, None)
                if message is None:
                    return
                if not isinstance(message, Cancel):
                    stored = await self._observe(stored, message)
                    continue
                ruling = Ruling(TierResult.SKIPPED, f"cancelled after {stored.search.visited} viewpoints")
            if ruling is None:
                lost = await unseen.out_of_reach(self._case, self._ground.building, stored.search)
                stored = await self._logbook.change(stored, give_up_rest)
                ruling, outcome = self._exhausted(stored.search, lost)
                ruling = await self._with_unexplored(stored.search, ruling, outcome)
            report = self._report(ruling)
            yield report
            answer = await self._answer(stored.search, report, ruling, outcome)
            stored = await self._logbook.change(stored, partial(_done, answer))
        yield stored.search.account

    async def _lay_out(self, stored: StoredSearch) -> StoredSearch:
        if stored.search.phase is not Phase.CASCADE:
            return stored
        laid = await active.lay_out(self._case, self._ground, stored.search)
        return await self._logbook.change(stored, partial(_laid_out, laid))

    async def _observe(self, stored: StoredSearch, message: SearchMessage) -> StoredSearch:
        """What the robot says of a viewpoint, stored; the same search where that one is already done."""
        if not isinstance(message, Observation):
            raise InvalidInput("search: expected an observation or cancel after the first message")
        step = find_step(stored.search, message.viewpoint_id)
        if is_done(stored.search, message.viewpoint_id):
            return stored
        if message.unreachable:
            return await self._logbook.change(stored, lambda s: self._kept(gave_up(s, step)))
        if not message.frame_id:
            raise InvalidInput("observation: expected a frame_id that perception holds, or unreachable")
        evidence = self._case.evidence
        record = await evidence.sources.frames.get_frame_record(evidence.scene, message.frame_id)
        view = active.view_from(record, step.waypoint.floor)
        seen = await ground(self._case, [message.frame_id])
        return await self._logbook.change(
            stored, lambda s: self._kept(looked(s, step, message.frame_id, view, seen.sightings, seen.blind))
        )

    async def _conclude(self, search: Search) -> tuple[Ruling | None, Outcome]:
        """A ruling where the search is over before its plan is carried out."""
        if not search.waypoints or self._case.target.noun == ANYTHING:
            return active.planned(self._case, search), Outcome.UNRESOLVED
        if await is_unseeable(self._case):
            why = f"the grounder has no way to see {self._case.target.noun!r}: looking proves nothing"
            return Ruling(TierResult.SKIPPED, why), Outcome.UNRESOLVED
        found, doubtful = await confirm_votes(self._case, search.sightings)
        if found:
            why = f"{found[0].why}; at viewpoint {search.visited} of {search.planned}"
            return Ruling(TierResult.FOUND, why, found, doubtful), Outcome.FOUND
        if search.visited >= search.budget and search.remaining:
            why = f"the budget of {search.budget} viewpoints is used up; {search.planned} are planned"
            return Ruling(TierResult.EXHAUSTED, why, (), doubtful), Outcome.UNRESOLVED
        return None, Outcome.UNRESOLVED

    def _exhausted(self, search: Search, lost: str) -> tuple[Ruling, Outcome]:
        """Every viewpoint is visited or unreachable and nothing was confirmed: absent, unless nothing was
        looked at. lost: why what was left could not be reached, if any was.
        """
        doubtful = ranked([doubt.candidate for doubt in self._case.doubts.values()])
        seen = (
            f"{search.visited} of {search.planned} viewpoints visited, {len(search.unreachable)} unreachable"
            + (f" ({lost})" if lost else "")
        )
        if search.visited and search.blind == search.visited:
            why = f"{seen}; whoever looked may have no way to see {self._case.target.noun!r}"
            return Ruling(TierResult.MISSING, why), Outcome.UNRESOLVED
        if not search.visited:
            return Ruling(TierResult.EXHAUSTED, f"{seen}: nothing was looked at"), Outcome.UNRESOLVED
        if doubtful:
            return Ruling(
                TierResult.AMBIGUOUS, f"{seen}; voted for, but not confirmed", (), doubtful
            ), Outcome.UNRESOLVED
        return Ruling(TierResult.MISSING, f"{seen}; nothing voted for and confirmed"), Outcome.ABSENT

    async def _with_unexplored(self, search: Search, ruling: Ruling, outcome: Outcome) -> Ruling:
        """An absence says where the robot could still go and see what nobody has seen."""
        if outcome is not Outcome.ABSENT:
            return ruling
        beyond = await unseen.unexplored(self._case, search)
        told = f"{ruling.why}; unexplored floor begins {beyond}" if beyond else ruling.why
        return replace(ruling, why=told, unexplored=beyond)

    def _report(self, ruling: Ruling) -> TierReport:
        spent = (self._clock() - self._began) * 1e3
        return TierReport(4, ruling.result, ruling.why, self._case.judge.vlm.calls - self._calls, spent)

    async def _answer(self, search: Search, report: TierReport, ruling: Ruling, outcome: Outcome) -> Answer:
        case = self._case
        reports = [*search.account.tiers, report]
        coverage = await active.account(case, self._ground, search) if search.waypoints else None
        if ruling.found:
            return replace(await answering.found(case, reports, 4, ruling), coverage=coverage)
        base = answering.account(case, reports, outcome, 4)
        if outcome is Outcome.ABSENT:
            needs = f"a look at what nobody has seen: {ruling.unexplored}" if ruling.unexplored else ""
        else:
            needs = active.still_needs(case, search, ruling)
        return replace(base, coverage=coverage, candidates=ruling.doubtful[:MOST_CANDIDATES], needs=needs)

    def _kept(self, search: Search) -> Search:
        """The search with what this question has spent and rejected so far, for whoever goes on with it."""
        base = answering.account(self._case, search.account.tiers, Outcome.UNRESOLVED, 4)
        return replace(search, vlm_calls=self._case.judge.vlm.calls, account=base)


def _laid_out(plan: Search, search: Search) -> Search:
    """The plan, unless another replica has laid one out first."""
    return replace(plan, phase=Phase.SEARCHING) if search.phase is Phase.CASCADE else search


def _done(answer: Answer, search: Search) -> Search:
    return replace(search, phase=Phase.DONE, account=answer)
