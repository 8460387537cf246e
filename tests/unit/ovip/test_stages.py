"""Following scenes: one writer a stage, kept while it works, given back when it ends."""

from __future__ import annotations

import asyncio
import contextlib

import pytest

from ovip import stages
from ovip.errors import Unavailable
from ovip.stages import follow_scenes, holding, new_owner
from ovip.store import Store


@pytest.fixture(autouse=True)
def _short_leases(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "LEASE_SECONDS", 0.4)
    monkeypatch.setattr(stages, "_LOOK_FOR_SCENES_SECONDS", 0.02)


def test_owners_differ() -> None:
    assert new_owner() != new_owner()


async def test_a_stage_is_held_for_as_long_as_the_block_runs(store: Store) -> None:
    async with holding(store, "kitchen", "mapper", "me"):
        await asyncio.sleep(0.9)  # over two leases long

        assert await store.acquire_lease("kitchen", "mapper", "you", 1) is None


async def test_a_stage_is_given_back_at_once_even_after_an_error(store: Store) -> None:
    with pytest.raises(ValueError, match="a bug"):
        async with holding(store, "kitchen", "mapper", "me"):
            raise ValueError("a bug")

    assert await store.acquire_lease("kitchen", "mapper", "you", 1)


async def test_a_second_writer_waits_for_the_first(store: Store) -> None:
    turns: list[str] = []

    async def write(owner: str) -> None:
        async with holding(store, "kitchen", "mapper", owner):
            turns.append(f"{owner} in")
            await asyncio.sleep(0.1)
            turns.append(f"{owner} out")

    await asyncio.gather(write("a"), write("b"))

    assert turns in (["a in", "a out", "b in", "b out"], ["b in", "b out", "a in", "a out"])


async def test_a_writer_that_died_is_followed_after_its_lease_ends(store: Store) -> None:
    await store.acquire_lease("kitchen", "mapper", "the dead", 0.3)

    async with asyncio.timeout(3), holding(store, "kitchen", "mapper", "me") as lease:
        assert lease.owner == "me"


async def test_every_scene_is_followed_and_new_ones_as_they_come(store: Store) -> None:
    begun: list[str] = []
    third = asyncio.Event()

    async def work(scene: str) -> None:
        begun.append(scene)
        if scene == "cellar":
            third.set()
        await asyncio.Event().wait()

    await store.add_scene("kitchen")
    await store.add_scene("attic")
    following = asyncio.create_task(follow_scenes(store, "mapper", work))
    await asyncio.sleep(0.2)
    await store.add_scene("cellar")
    await asyncio.wait_for(third.wait(), 3)
    await _cancelled(following)

    assert sorted(begun) == ["attic", "cellar", "kitchen"]


async def test_a_scene_that_fails_is_begun_again_and_holds_up_no_other(store: Store) -> None:
    begun: list[str] = []
    again = asyncio.Event()

    async def work(scene: str) -> None:
        begun.append(scene)
        if scene == "attic":
            if begun.count("attic") == 3:
                again.set()
            raise Unavailable("away") if begun.count("attic") == 1 else ValueError("a bug")
        await asyncio.Event().wait()

    await store.add_scene("kitchen")
    await store.add_scene("attic")
    following = asyncio.create_task(follow_scenes(store, "mapper", work))
    await asyncio.wait_for(again.wait(), 5)
    await _cancelled(following)

    assert begun.count("kitchen") == 1


async def test_when_following_ends_all_work_ends(store: Store) -> None:
    ended = asyncio.Event()

    async def work(scene: str) -> None:
        try:
            await asyncio.Event().wait()
        finally:
            ended.set()

    await store.add_scene("kitchen")
    following = asyncio.create_task(follow_scenes(store, "mapper", work))
    await asyncio.sleep(0.1)
    await _cancelled(following)

    assert ended.is_set()


async def _cancelled(task: asyncio.Task[None]) -> None:
    task.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await task
