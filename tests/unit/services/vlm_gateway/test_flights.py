"""Identical work is done once, for as long as somebody waits for it."""

from __future__ import annotations

import asyncio
import time

import pytest

from ovip.errors import DeadlineExceeded, Unavailable
from services.vlm_gateway.flights import Flights


class Work:
    """Work that counts its runs and can be let go."""

    def __init__(self) -> None:
        self.runs = 0
        self.cancelled = 0
        self.go = asyncio.Event()

    async def __call__(self) -> str:
        self.runs += 1
        try:
            await self.go.wait()
        except asyncio.CancelledError:
            self.cancelled += 1
            raise
        return "done"


def far() -> float:
    return time.monotonic() + 60.0


async def test_same_key_runs_once_for_all_who_wait() -> None:
    flights, work = Flights[str](time.monotonic), Work()
    waiting = [asyncio.create_task(flights.share("k", far(), work)) for _ in range(5)]
    await asyncio.sleep(0)
    work.go.set()
    assert await asyncio.gather(*waiting) == ["done"] * 5
    assert work.runs == 1


async def test_other_keys_and_later_calls_run_anew() -> None:
    flights, work = Flights[str](time.monotonic), Work()
    work.go.set()
    for key in ("a", "b", "a"):
        assert await flights.share(key, far(), work) == "done"
    assert work.runs == 3


async def test_work_outlives_the_one_who_started_it() -> None:
    flights, work = Flights[str](time.monotonic), Work()
    starter = asyncio.create_task(flights.share("k", far(), work))
    await asyncio.sleep(0)
    joiner = asyncio.create_task(flights.share("k", far(), work))
    await asyncio.sleep(0)
    starter.cancel()
    await asyncio.sleep(0)
    work.go.set()
    assert await joiner == "done" and work.runs == 1 and work.cancelled == 0


async def test_work_stops_when_nobody_waits_and_the_next_starts_anew() -> None:
    flights, work = Flights[str](time.monotonic), Work()
    starter = asyncio.create_task(flights.share("k", far(), work))
    await asyncio.sleep(0.01)
    starter.cancel()
    again = asyncio.create_task(flights.share("k", far(), work))
    await asyncio.sleep(0.01)
    work.go.set()
    assert await again == "done" and work.runs == 2 and work.cancelled == 1


async def test_joiner_leaves_at_its_own_deadline() -> None:
    flights, work = Flights[str](time.monotonic), Work()
    starter = asyncio.create_task(flights.share("k", far(), work))
    await asyncio.sleep(0)
    with pytest.raises(DeadlineExceeded):
        await flights.share("k", time.monotonic() + 0.05, work)
    work.go.set()
    assert await starter == "done"


async def test_joiner_with_time_left_goes_on_when_the_other_ran_out_of_its_own() -> None:
    flights, runs = Flights[str](time.monotonic), []

    async def first_in_a_hurry() -> str:
        runs.append(1)
        await asyncio.sleep(0.01)
        if len(runs) == 1:
            raise DeadlineExceeded("the first one's time is up")
        return "done"

    outcomes = await asyncio.gather(
        flights.share("k", time.monotonic() + 0.01, first_in_a_hurry),
        flights.share("k", far(), first_in_a_hurry),
        return_exceptions=True,
    )
    assert isinstance(outcomes[0], DeadlineExceeded) and outcomes[1] == "done" and len(runs) == 2


async def test_failure_reaches_everyone() -> None:
    flights = Flights[str](time.monotonic)

    async def fails() -> str:
        await asyncio.sleep(0.01)
        raise Unavailable("gone")

    outcomes = await asyncio.gather(
        *(flights.share("k", far(), fails) for _ in range(3)), return_exceptions=True
    )
    assert [type(outcome) for outcome in outcomes] == [Unavailable] * 3
