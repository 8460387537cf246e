"""Identical work in flight is done once and its result shared."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from ovip.errors import DeadlineExceeded, Exhausted

T = TypeVar("T")


class Flights(Generic[T]):
    """Work by key. It goes on while somebody waits for it, and is cancelled when the last one leaves.

    clock: monotonic seconds, by which `work` keeps its own deadline.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._flights: dict[str, _Flight[T]] = {}

    async def share(self, key: str, until: float, work: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """The result of `work`, or of the same work already under way.

        Whoever joined another's work and saw that one's time run out goes on with the time left to it.
        Raises DeadlineExceeded for a joiner when the clock reads `until`.
        """
        while (flight := self._flights.get(key)) is not None:
            try:
                return await self._wait(key, flight, until)
            except (DeadlineExceeded, Exhausted):
                if self._clock() >= until:
                    raise
        return await self._wait(key, self._start(key, work), math.inf)

    def _start(self, key: str, work: Callable[[], Coroutine[Any, Any, T]]) -> _Flight[T]:
        flight = _Flight(asyncio.create_task(work()))
        self._flights[key] = flight
        flight.task.add_done_callback(lambda _: self._land(key, flight))
        return flight

    async def _wait(self, key: str, flight: _Flight[T], until: float) -> T:
        flight.waiters += 1
        try:
            async with asyncio.timeout(max(0.0, until - self._clock()) if until < math.inf else None):
                return await asyncio.shield(flight.task)
        except TimeoutError:
            raise DeadlineExceeded("the deadline passed before a VLM answered") from None
        finally:
            flight.waiters -= 1
            if not flight.waiters:
                self._land(key, flight)
                flight.task.cancel()

    def _land(self, key: str, flight: _Flight[T]) -> None:
        """Takes a flight off the board, so that nobody joins it any more."""
        if self._flights.get(key) is flight:
            del self._flights[key]


@dataclass(slots=True, eq=False)
class _Flight(Generic[T]):
    task: asyncio.Task[T]
    waiters: int = 0
