"""Functions of a scene's objects: one question a floor, asked again only when enough of its objects are new.

A live map gains objects all the time, and each question costs money and a minute. So an answer is kept for each
object, by its id and label, and a floor is asked again, whole, when the objects without an answer are a fifth of
it: 300 objects that come one by one make 22 questions, and a map that stays makes none, also after a restart.
Until then new objects have the function that the table gives them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ovip.errors import NotConfigured, OvipError
from ovip.scene.types import I64
from ovip.telemetry import get_logger
from services.regions.domain.assembly import PlacedObjects
from services.regions.metrics import FALLBACKS
from services.regions.ports import Grouper, Grouping

_LONGEST_REASON = 200
log = get_logger("regions")


@dataclass(frozen=True, slots=True)
class GroupingParams:
    """share: a floor is asked about when at least this share of its objects has no answer. patience: after the
    k-th failure in a row 2^k - 1 occasions to ask go by unused, at most this many."""

    share: float = 0.2
    patience: int = 63


@dataclass(frozen=True, slots=True)
class GroupingMemory:
    """What was answered, and how asking went of late; `GroupingMemory()` knows nothing, so all is asked anew.

    answers: object id -> (label it was asked with, function). failures: in a row. skipped: occasions to ask since
    the last one. why: what the last failure was, "" after an answer.
    """

    answers: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    failures: int = 0
    skipped: int = 0
    why: str = ""

    def functions(self, floor: PlacedObjects) -> tuple[str | None, ...]:
        """The answer for each object; None where there is none, or was for another label."""
        kept = (self.answers.get(object_id) for object_id in floor.ids)
        return tuple(
            answer[1] if answer and answer[0] == label else None
            for answer, label in zip(kept, floor.labels, strict=True)
        )

    def of(self, objects: PlacedObjects) -> GroupingMemory:
        """Without the objects that are gone."""
        present = set(objects.ids)
        return replace(self, answers={k: v for k, v in self.answers.items() if k in present})

    def with_answer(self, floor: PlacedObjects, functions: Sequence[str]) -> GroupingMemory:
        """With a floor's answer, and no failure."""
        new = dict(zip(floor.ids, zip(floor.labels, functions, strict=True), strict=True))
        return GroupingMemory({**self.answers, **new})

    def to_json(self) -> str:
        return json.dumps(
            {
                "answers": {k: list(v) for k, v in sorted(self.answers.items())},
                "failures": self.failures,
                "skipped": self.skipped,
                "why": self.why,
            }
        )

    @classmethod
    def from_json(cls, text: str) -> GroupingMemory:
        """The memory behind `to_json`; one that knows nothing for an empty or a strange text."""
        try:
            kept = json.loads(text)
            answers = {str(k): (str(label), str(name)) for k, (label, name) in kept["answers"].items()}
            return cls(answers, int(kept["failures"]), int(kept["skipped"]), str(kept["why"]))
        except (ValueError, KeyError, TypeError, AttributeError):
            return cls()


class FloorGrouping:
    """Names the functions of all objects, floor by floor."""

    def __init__(self, groupers: Sequence[Grouper], params: GroupingParams | None = None) -> None:
        """groupers: the first that does not raise answers; the last, which is asked for what has no answer
        and not remembered, must not raise."""
        *self._better, self._last = groupers
        self._params = params or GroupingParams()

    async def functions(
        self, storeys: I64, objects: PlacedObjects, memory: GroupingMemory
    ) -> tuple[Grouping, GroupingMemory]:
        """The function of each object, and what to remember of it. storeys: `(N,)` the floor of each object."""
        memory = memory.of(objects)
        functions, told = [""] * len(objects.ids), [False] * len(objects.ids)
        fallbacks: list[str] = []
        floors = np.unique(storeys).tolist()
        for number in floors:
            members = np.flatnonzero(storeys == number)
            where = f" on floor {number}" if len(floors) > 1 else ""
            grouping, memory = await self._floor(objects.only(members), memory, where)
            for at, member in enumerate(members.tolist()):
                functions[member], told[member] = grouping.functions[at], grouping.told[at]
            fallbacks += [text for text in grouping.fallbacks if text not in fallbacks]
        return Grouping(tuple(functions), tuple(fallbacks), tuple(told)), memory

    async def _floor(
        self, floor: PlacedObjects, memory: GroupingMemory, where: str
    ) -> tuple[Grouping, GroupingMemory]:
        memory = await self._asked(floor, memory)
        answers = memory.functions(floor)
        told = tuple(answer is not None for answer in answers)
        open_count = answers.count(None)
        if not open_count:
            return Grouping(tuple(answer or "" for answer in answers), (), told), memory
        table = await self._last.group(floor)
        functions = tuple(a if a is not None else b for a, b in zip(answers, table.functions, strict=True))
        reason = self._reason(memory, where, open_count, len(answers))
        return Grouping(functions, (*reason, *table.fallbacks), told), memory

    async def _asked(self, floor: PlacedObjects, memory: GroupingMemory) -> GroupingMemory:
        """The memory after asking about the floor, if it is time to."""
        missing = memory.functions(floor).count(None)
        if not self._better or not missing or missing < self._params.share * len(floor.ids):
            return memory
        if memory.skipped < min(2**memory.failures - 1, self._params.patience):
            return replace(memory, skipped=memory.skipped + 1)
        for grouper in self._better:
            try:
                return memory.with_answer(floor, (await grouper.group(floor)).functions)
            except OvipError as error:
                memory = _failed(memory, error)
        return memory

    def _reason(self, memory: GroupingMemory, where: str, missing: int, count: int) -> tuple[str, ...]:
        """Why the table took part, in words; nothing where there is nobody else."""
        if not self._better:
            return ()
        if memory.why:
            return (f"grouping: function table{where}, {memory.why}",)
        return (
            f"grouping: function table{where} for {missing} of {count} objects, too few to ask a VLM again",
        )


def _failed(memory: GroupingMemory, error: OvipError) -> GroupingMemory:
    """A gateway that has no VLM costs nothing to ask: that is no failure, and it is asked the next time too."""
    FALLBACKS.inc()
    if isinstance(error, NotConfigured):
        return replace(memory, failures=0, skipped=0, why="no VLM configured")
    why = f"VLM {error.slug.replace('-', ' ')}: {error}"[:_LONGEST_REASON]
    log.info("grouping_fell_back", slug=error.slug, reason=str(error))
    return replace(memory, failures=memory.failures + 1, skipped=0, why=why)
