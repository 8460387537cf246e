"""Limits shared through the real store, and the order in which waiting questions get in."""

from __future__ import annotations

import asyncio
import time

import pytest

from ovip.errors import TooLarge
from ovip.store import Store
from services.vlm_gateway.adapters.admission import SharedAdmission
from services.vlm_gateway.config import UpstreamSettings
from services.vlm_gateway.domain.question import Purpose

NEVER = 1e12


def admission(store: Store, **limits: int) -> SharedAdmission:
    upstream = UpstreamSettings(name="local", base_url="http://127.0.0.1:1/v1", model="tiny-vl", **limits)
    return SharedAdmission(upstream, store, time.monotonic)


async def soon(gate: SharedAdmission, tokens: int = 10, purpose: Purpose = Purpose.ENUMERATE) -> float:
    return await gate.enter(purpose, tokens, time.monotonic() + 0.01)


async def drain(store: Store, bucket: str, capacity: int) -> None:
    assert await store.take_tokens(bucket, capacity, capacity / 60.0, capacity) == 0.0


async def test_without_limits_everyone_enters_at_once(store: Store) -> None:
    gate = admission(store, max_concurrent=100)
    assert [await soon(gate, 10**9) for _ in range(50)] == [0.0] * 50


async def test_used_up_requests_say_when_there_is_room_again(store: Store) -> None:
    gate = admission(store, requests_per_minute=2)
    assert [await soon(gate) for _ in range(2)] == [0.0, 0.0]
    began = time.monotonic()
    # two a minute: the next one is 30 s away, and nobody waits 30 s for a deadline of 10 ms
    assert await soon(gate) == pytest.approx(30.0, abs=1.0)
    assert time.monotonic() - began < 1.0


async def test_used_up_tokens_say_when_there_is_room_again(store: Store) -> None:
    gate = admission(store, tokens_per_minute=600)
    assert await soon(gate, 600) == 0.0
    assert await soon(gate, 300) == pytest.approx(30.0, abs=1.0)


async def test_waits_for_room_within_the_deadline(store: Store) -> None:
    gate = admission(store, requests_per_minute=300)
    await drain(store, "vlm:local:requests", 300)
    began = time.monotonic()
    assert await gate.enter(Purpose.GROUP, 10, began + 5.0) == 0.0
    assert 0.1 <= time.monotonic() - began < 2.0


async def test_replicas_share_one_budget(store: Store) -> None:
    one, other = admission(store, requests_per_minute=4), admission(store, requests_per_minute=4)
    entered = [await soon(gate) == 0.0 for gate in (one, other, one, other, one, other)]
    assert entered == [True, True, True, True, False, False]


async def test_who_gives_up_gives_back_what_it_drew(store: Store) -> None:
    gate = admission(store, requests_per_minute=2, tokens_per_minute=600)
    await drain(store, "vlm:local:requests", 2)
    assert await soon(gate, 500) > 0.0
    assert await store.take_tokens("vlm:local:tokens", 600, 10.0, 600) == 0.0


async def test_search_overtakes_waiting_enumeration_and_that_grouping(store: Store) -> None:
    gate = admission(store, requests_per_minute=600)
    await drain(store, "vlm:local:requests", 600)
    entered: list[Purpose] = []

    async def one(purpose: Purpose) -> None:
        assert await gate.enter(purpose, 10, NEVER) == 0.0
        entered.append(purpose)

    asked = [Purpose.GROUP, Purpose.GROUP, Purpose.ENUMERATE, Purpose.ENUMERATE, Purpose.SEARCH]
    async with asyncio.TaskGroup() as group:
        for purpose in asked:
            group.create_task(one(purpose))
            await asyncio.sleep(0.005)
    assert entered == sorted(asked, key=list(Purpose).index)


async def test_no_more_enter_than_fit_at_once(store: Store) -> None:
    gate = admission(store, max_concurrent=2)
    assert [await soon(gate) for _ in range(2)] == [0.0, 0.0]
    assert await soon(gate) >= 1.0
    waiting = asyncio.create_task(gate.enter(Purpose.SEARCH, 10, NEVER))
    await asyncio.sleep(0.01)
    assert not waiting.done()
    gate.leave()
    assert await waiting == 0.0


async def test_waiter_that_is_cancelled_blocks_nobody(store: Store) -> None:
    gate = admission(store, max_concurrent=1)
    assert await soon(gate) == 0.0
    first = asyncio.create_task(gate.enter(Purpose.SEARCH, 10, NEVER))
    second = asyncio.create_task(gate.enter(Purpose.GROUP, 10, NEVER))
    await asyncio.sleep(0.01)
    first.cancel()
    gate.leave()
    assert await asyncio.wait_for(second, 2.0) == 0.0


async def test_pause_keeps_everyone_out_until_it_is_over(store: Store) -> None:
    gate = admission(store)
    gate.pause(0.2)
    assert await soon(gate) == pytest.approx(0.2, abs=0.1)
    began = time.monotonic()
    assert await gate.enter(Purpose.ENUMERATE, 10, began + 5.0) == 0.0
    assert time.monotonic() - began >= 0.1


async def test_absurd_pause_is_cut_to_five_minutes(store: Store) -> None:
    gate = admission(store)
    gate.pause(1e9)
    assert await soon(gate) == pytest.approx(300.0, abs=1.0)


async def test_question_larger_than_a_minutes_tokens_never_fits(store: Store) -> None:
    with pytest.raises(TooLarge, match="about 601 tokens, its limit is 600 a minute"):
        await soon(admission(store, tokens_per_minute=600), 601)


async def test_hundred_waiters_all_get_in_and_never_too_many(store: Store) -> None:
    gate = admission(store, max_concurrent=3, requests_per_minute=60_000)
    inside, most = 0, 0

    async def one(purpose: Purpose) -> None:
        nonlocal inside, most
        assert await gate.enter(purpose, 10, NEVER) == 0.0
        inside += 1
        most = max(most, inside)
        await asyncio.sleep(0.001)
        inside -= 1
        gate.leave()

    async with asyncio.timeout(20.0), asyncio.TaskGroup() as group:
        for number in range(100):
            group.create_task(one(list(Purpose)[number % 3]))
    assert most == 3
