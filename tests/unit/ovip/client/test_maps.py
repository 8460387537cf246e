"""Both clients read, edit and prove maps alike: each word reaches the mapper as the same request."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Any

import numpy as np
import pytest

from ovip.client import Addresses, AsyncClient, Client
from ovip.errors import Conflict
from ovip.scene.edits import Delete, Merge, Pin, Rename, Split
from tests.builders import same
from tests.unit.services.mapper.recorded import DIFF, EDITED, KITCHEN, Recorded, mapper_port

PART = np.arange(6.0)
EDITS: dict[str, tuple[Callable[[Any], Any], Any]] = {
    "rename": (lambda c: c.rename("kitchen", "o1", "mug", 7, "ada"), Rename("o1", "mug")),
    "merge": (lambda c: c.merge("kitchen", "o1", ["o2", "o3"], 7, operator="ada"), Merge("o1", ("o2", "o3"))),
    "split": (
        lambda c: c.split("kitchen", "o1", PART, 7, "lid", operator="ada"),
        Split("o1", PART, "lid"),
    ),
    "delete": (lambda c: c.delete("kitchen", "o1", 7, operator="ada"), Delete("o1")),
    "pin": (lambda c: c.pin("kitchen", "o1", 7, operator="ada"), Pin("o1")),
    "unpin": (lambda c: c.pin("kitchen", "o1", 7, pinned=False, operator="ada"), Pin("o1", pinned=False)),
    "edit_map": (lambda c: c.edit_map("kitchen", Delete("o1"), 7, "ada"), Delete("o1")),
}
READS: dict[str, tuple[Callable[[Any], Any], Any, list[Any]]] = {
    "map": (lambda c: c.get_map("kitchen"), KITCHEN, [("kitchen", False, 0, False)]),
    "map as of": (
        lambda c: c.get_map("kitchen", at_version=5, include_departed=True),
        KITCHEN,
        [("kitchen", False, 5, True)],
    ),
    "diff": (lambda c: c.diff("kitchen", 3, 7), DIFF, [("kitchen", 3, 7)]),
    "verify": (lambda c: c.verify("kitchen"), Recorded().verification, []),
}


@pytest.fixture
def mapper() -> Recorded:
    return Recorded()


@pytest.fixture
async def addresses(mapper: Recorded) -> AsyncIterator[Addresses]:
    async with mapper_port(mapper) as port:
        yield Addresses(mapper=f"127.0.0.1:{port}")


async def by_both(addresses: Addresses, act: Callable[[Any], Any]) -> list[Any]:
    """What the asynchronous client answers, then the synchronous one."""

    def synchronously() -> Any:
        with Client(addresses) as client:
            return act(client)

    async with AsyncClient(addresses) as client:
        first = await act(client)
    return [first, await asyncio.to_thread(synchronously)]


@pytest.mark.parametrize("word", EDITS)
async def test_an_edit_is_one_request_on_the_version_seen(
    addresses: Addresses, mapper: Recorded, word: str
) -> None:
    act, edit = EDITS[word]

    assert await by_both(addresses, act) == [EDITED, EDITED]

    for scene, request in mapper.asked:
        assert (scene, request.made_on_version, request.operator) == ("kitchen", 7, "ada")
        assert same(request.edit, edit)
    assert len({request.edit_id for _, request in mapper.asked}) == 2


@pytest.mark.parametrize("word", READS)
async def test_a_read_is_answered_as_the_mapper_answers(
    addresses: Addresses, mapper: Recorded, word: str
) -> None:
    act, answer, asked = READS[word]

    assert all(same(given, answer) for given in await by_both(addresses, act))
    assert mapper.asked == asked * 2


async def test_an_edit_keeps_the_id_it_is_given(addresses: Addresses, mapper: Recorded) -> None:
    await by_both(addresses, lambda c: c.edit_map("kitchen", Delete("o1"), 7, edit_id="e1"))

    assert [request.edit_id for _, request in mapper.asked] == ["e1", "e1"]


async def test_an_edit_made_on_what_has_changed_is_a_conflict(addresses: Addresses) -> None:
    with pytest.raises(Conflict, match="has changed"):
        await by_both(addresses, lambda c: c.rename("kitchen", "o1", "mug", 3))
