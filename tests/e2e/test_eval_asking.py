"""The asking protocols on the real stack: mapped once, asked, searched in copies that leave no trace."""

from __future__ import annotations

import asyncio
from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.asking.questions import Kind, Question
from lab.evaluation.asking.stack import Mapped, find, map_place, stack_over, the_map
from lab.evaluation.asking.worlds import WorldSpec, place_of
from lab.evaluation.experiments.absence import search_for
from ovip.scene.answers import Answer, Outcome

pytestmark = pytest.mark.models
ROOM = WorldSpec("room", 0)


@pytest.fixture(scope="module")
def mapped(embedded_models: Path, tmp_path_factory: pytest.TempPathFactory) -> Mapped:
    return map_place(ROOM, tmp_path_factory.mktemp("asked"))


def asked(mapped: Mapped, text: str) -> tuple[Answer, int]:
    async def ask() -> tuple[Answer, int]:
        async with stack_over(mapped.folder) as client:
            answer = await find(client, text, place_of(ROOM).world.walk()[-1])
            return answer, (await the_map(client)).version

    return asyncio.run(ask())


def the_things(label: str) -> tuple[int, ...]:
    return tuple(t.object_id for t in place_of(ROOM).truth.things if t.label == label)


def test_a_mapped_place_answers_what_its_robot_was_shown(mapped: Mapped) -> None:
    assert mapped.objects >= 15
    assert set(the_things("bed")) <= set(mapped.shown)
    answer, _ = asked(mapped, "bed")
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    truth = place_of(ROOM).truth.centres(the_things("bed"))[0]
    assert np.linalg.norm(answer.object.position - truth) < 1.0


def test_a_forced_search_finds_what_is_there_and_leaves_no_trace(mapped: Mapped) -> None:
    _, version = asked(mapped, "bed")
    question = Question("refrigerator", Kind.CLASS, "refrigerator", the_things("refrigerator"))
    done = search_for(mapped, question)
    assert done.found_at is not None
    assert done.miss < 1.0
    assert 0 < done.visited < done.planned
    assert done.travelled > 0
    again = search_for(mapped, question)
    assert (again.found_at, again.planned) == (done.found_at, done.planned)
    assert again.travelled == pytest.approx(done.travelled)
    assert asked(mapped, "bed")[1] == version
