"""Naming a scene's objects: what is asked, what is remembered, and what the table does meanwhile."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import DeadlineExceeded, Exhausted, NotConfigured, OvipError, Unavailable
from ovip.scene.types import I64
from services.regions.adapters.table_grouping import TableGrouper
from services.regions.domain.assembly import PlacedObjects
from services.regions.grouping import FloorGrouping, GroupingMemory, GroupingParams
from services.regions.ports import Grouping
from tests.unit.services.regions.homes import NoEncoder


class Namer:
    """Stands for the VLM: calls everything a studio, or raises; keeps which objects it was asked about."""

    def __init__(self, error: OvipError | None = None) -> None:
        self.error = error
        self.asked: list[tuple[str, ...]] = []

    async def group(self, objects: PlacedObjects) -> Grouping:
        self.asked.append(objects.ids)
        if self.error:
            raise self.error
        return Grouping(("studio",) * len(objects.ids))


def things(*labels: str, first: int = 0) -> PlacedObjects:
    ids = tuple(f"o{first + number}" for number in range(len(labels)))
    return PlacedObjects(ids, labels, np.arange(0, 27.0 * len(labels), 9).reshape(-1, 3))


def ground(objects: PlacedObjects) -> I64:
    return np.zeros(len(objects.ids), np.int64)


def namers(vlm: Namer, params: GroupingParams | None = None) -> FloorGrouping:
    return FloorGrouping((vlm, TableGrouper(NoEncoder())), params)


async def named(
    grouping: FloorGrouping, objects: PlacedObjects, memory: GroupingMemory
) -> tuple[Grouping, GroupingMemory]:
    return await grouping.functions(ground(objects), objects, memory)


async def test_a_floor_is_asked_about_once_and_again_only_with_another_set() -> None:
    vlm, objects = Namer(), things("bed", "stove")
    first, memory = await named(namers(vlm), objects, GroupingMemory())
    moved = PlacedObjects(objects.ids[::-1], objects.labels[::-1], objects.centres + 1)
    again, memory = await named(namers(vlm), moved, memory)
    assert first == again == Grouping(("studio", "studio"), (), (True, True))
    assert vlm.asked == [("o0", "o1")]
    await named(namers(vlm), things("bed", "oven"), memory)  # another label
    assert len(vlm.asked) == 2


async def test_after_a_restart_nothing_is_asked_again() -> None:
    vlm, objects = Namer(), things("bed", "stöve\n\u2028")
    _, memory = await named(namers(vlm), objects, GroupingMemory())
    kept = GroupingMemory.from_json(memory.to_json())
    assert kept == memory
    again, _ = await named(namers(vlm), objects, kept)
    assert again.functions == ("studio", "studio")
    assert len(vlm.asked) == 1


async def test_a_wish_that_brings_no_memory_asks_anew() -> None:
    vlm, objects = Namer(), things("bed")
    for _ in range(2):
        await named(namers(vlm), objects, GroupingMemory())
    assert len(vlm.asked) == 2


async def test_few_new_objects_have_the_tables_function_until_they_are_a_fifth() -> None:
    vlm = Namer()
    _, memory = await named(namers(vlm), things(*["box"] * 9), GroupingMemory())
    grouping, memory = await named(namers(vlm), things(*["box"] * 9, "stove"), memory)
    assert grouping.functions == (*["studio"] * 9, "kitchen")
    assert grouping.told == (*[True] * 9, False)
    assert grouping.fallbacks == ("grouping: function table for 1 of 10 objects, too few to ask a VLM again",)
    grouping, memory = await named(namers(vlm), things(*["box"] * 9, "stove", "bed"), memory)  # 2 of 11
    assert len(vlm.asked) == 1
    grouping, memory = await named(
        namers(vlm), things(*["box"] * 9, "stove", "bed", "cup"), memory
    )  # 3 of 12
    assert grouping == Grouping(("studio",) * 12, (), (True,) * 12)
    assert [len(ids) for ids in vlm.asked] == [9, 12]


async def test_a_map_that_grows_one_by_one_is_asked_about_a_few_times_only() -> None:
    vlm, memory = Namer(), GroupingMemory()
    for count in range(1, 301):
        _, memory = await named(namers(vlm), things(*["box"] * count), memory)
    assert [len(ids) for ids in vlm.asked][:9] == [1, 2, 3, 4, 5, 7, 9, 12, 15]
    assert len(vlm.asked) == 22


async def test_objects_that_are_gone_are_forgotten_and_ask_nothing() -> None:
    vlm = Namer()
    _, memory = await named(namers(vlm), things(*["box"] * 9), GroupingMemory())
    _, memory = await named(namers(vlm), things("box", "box"), memory)
    assert sorted(memory.answers) == ["o0", "o1"]
    assert len(vlm.asked) == 1
    nothing, memory = await named(namers(vlm), PlacedObjects.none(), memory)
    assert nothing == Grouping(())
    assert not memory.answers


async def test_each_floor_is_a_question_of_its_own_and_answers_keep_their_places() -> None:
    vlm, objects = Namer(), things("bed", "stove", "cup")
    grouping = namers(vlm)
    _, memory = await grouping.functions(np.array([1, 0, 1]), objects, GroupingMemory())
    assert vlm.asked == [("o1",), ("o0", "o2")]
    more = things("bed", "stove", "cup", "toilet")
    answer, _ = await grouping.functions(np.array([1, 0, 1, 7]), more, memory)
    assert vlm.asked[2:] == [("o3",)]
    assert answer == Grouping(("studio",) * 4, (), (True,) * 4)


@pytest.mark.parametrize(
    ("error", "why"),
    [
        (NotConfigured("set it"), "no VLM configured"),
        (Unavailable("gateway down"), "VLM unavailable: gateway down"),
        (DeadlineExceeded("took 60 s"), "VLM deadline exceeded: took 60 s"),
        (Exhausted("until tomorrow"), "VLM exhausted: until tomorrow"),
    ],
)
async def test_where_the_vlm_fails_the_table_answers_and_says_why_once_a_floor(
    error: OvipError, why: str
) -> None:
    objects = things("bed", "stove", "picture")
    grouping, memory = await named(namers(Namer(error)), objects, GroupingMemory())
    assert grouping.functions == ("bedroom", "kitchen", "unknown")
    assert grouping.fallbacks == (f"grouping: function table, {why}",)
    assert not memory.answers
    both, _ = await namers(Namer(error)).functions(np.array([0, 1, 1]), objects, GroupingMemory())
    assert len(both.fallbacks) == 2
    assert both.fallbacks[1] == f"grouping: function table on floor 1, {why}"


async def test_a_long_reason_is_cut() -> None:
    grouping, _ = await named(namers(Namer(Unavailable("x" * 999))), things("bed"), GroupingMemory())
    assert len(grouping.fallbacks[0]) < 250


async def test_failures_in_a_row_let_ever_more_occasions_go_by() -> None:
    vlm, memory = Namer(Unavailable("down")), GroupingMemory()
    asked = []
    for _ in range(30):
        before = len(vlm.asked)
        _, memory = await named(namers(vlm), things("bed"), GroupingMemory.from_json(memory.to_json()))
        asked.append(len(vlm.asked) - before)
    assert [number for number, times in enumerate(asked) if times] == [0, 2, 6, 14]


async def test_patience_ends_and_an_answer_makes_good() -> None:
    vlm, memory = Namer(Unavailable("down")), GroupingMemory(failures=40)
    params = GroupingParams(patience=2)
    for _ in range(2):
        waiting, memory = await named(namers(vlm, params), things("bed"), memory)
    assert vlm.asked == []
    assert waiting.functions == ("bedroom",)
    vlm.error = None
    grouping, memory = await named(namers(vlm, params), things("bed"), memory)
    assert grouping == Grouping(("studio",), (), (True,))
    assert (memory.failures, memory.skipped, memory.why) == (0, 0, "")


async def test_a_gateway_without_a_vlm_is_asked_each_time_because_it_costs_nothing() -> None:
    vlm, memory = Namer(NotConfigured("none")), GroupingMemory()
    for _ in range(3):
        _, memory = await named(namers(vlm), things("bed"), memory)
    assert len(vlm.asked) == 3


async def test_answers_outlive_a_failure_to_answer_for_more() -> None:
    vlm = Namer()
    _, memory = await named(namers(vlm), things("box", "box"), GroupingMemory())
    vlm.error = Unavailable("down")
    grouping, memory = await named(namers(vlm), things("box", "box", "stove"), memory)
    assert grouping.functions == ("studio", "studio", "kitchen")
    assert sorted(memory.answers) == ["o0", "o1"]


async def test_the_only_grouper_answers_each_time_and_gives_no_reason() -> None:
    only = FloorGrouping((TableGrouper(NoEncoder()),))
    grouping, memory = await only.functions(np.array([0]), things("bed"), GroupingMemory())
    assert grouping == Grouping(("bedroom",), (), (False,))
    assert memory == GroupingMemory()


@pytest.mark.parametrize(
    "text",
    ["", "nonsense", "[]", "null", "{}", '{"answers": {"a": 3}, "failures": 0, "skipped": 0, "why": ""}'],
)
def test_a_strange_text_is_a_memory_of_nothing(text: str) -> None:
    assert GroupingMemory.from_json(text) == GroupingMemory()


@given(
    st.dictionaries(st.text(max_size=9), st.tuples(st.text(max_size=9), st.text(max_size=9)), max_size=5),
    st.integers(0, 99),
    st.integers(0, 99),
    st.text(max_size=9),
)
def test_a_memory_survives_its_json(
    answers: dict[str, tuple[str, str]], failures: int, skipped: int, why: str
) -> None:
    memory = GroupingMemory(answers, failures, skipped, why)
    assert GroupingMemory.from_json(memory.to_json()) == memory
    turned = GroupingMemory(dict(reversed(answers.items())), failures, skipped, why)
    assert turned.to_json() == memory.to_json()
