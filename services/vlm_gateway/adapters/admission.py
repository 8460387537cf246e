"""Limits of one upstream: its budgets a minute are shared through the store, its queue is this process's."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from dataclasses import dataclass, field

from ovip.errors import TooLarge
from ovip.store import Store
from services.vlm_gateway.config import UpstreamSettings
from services.vlm_gateway.domain.priority import Place
from services.vlm_gateway.domain.question import Purpose

MAX_PAUSE_S = 300.0
_MINUTE = 60.0


@dataclass(frozen=True, slots=True)
class _Budget:
    """A token bucket in the store: `capacity` a minute, of which this question takes `amount`."""

    bucket: str
    capacity: float
    amount: float


@dataclass(slots=True)
class _Waiter:
    place: Place
    budgets: list[_Budget]
    taken: list[_Budget] = field(default_factory=list)
    woken: asyncio.Event = field(default_factory=asyncio.Event)


class SharedAdmission:
    """Admits the most urgent waiter once there is a free place and both budgets give what it needs.

    Only the first in the queue draws on the budgets, so a search that arrives overtakes every enumeration
    that waits. Budgets hold for all replicas; the queue, the pause and `max_concurrent` for this one.
    """

    def __init__(self, upstream: UpstreamSettings, store: Store, clock: Callable[[], float]) -> None:
        self._upstream = upstream
        self._store = store
        self._clock = clock
        self._waiting: list[_Waiter] = []
        self._arrivals = 0
        self._inside = 0
        self._closed_until = 0.0

    async def enter(self, purpose: Purpose, tokens: int, until: float) -> float:
        """Waits for room until the clock reads `until`; see `ports.Admission`."""
        waiter = self._join(purpose, tokens)
        wait = math.inf
        try:
            wait = await self._wait_for_room(waiter, until)
            return wait
        finally:
            self._waiting.remove(waiter)
            self._wake_first()
            if wait > 0.0:
                await self._give_back(waiter)

    def leave(self) -> None:
        """Gives back the place of an `enter` that returned 0.0."""
        self._inside -= 1
        self._wake_first()

    def pause(self, seconds: float) -> None:
        """Lets nobody in for `seconds`, at most `MAX_PAUSE_S`: then one question tries whether it is over."""
        self._closed_until = max(self._closed_until, self._clock() + min(seconds, MAX_PAUSE_S))

    def _join(self, purpose: Purpose, tokens: int) -> _Waiter:
        self._arrivals += 1
        waiter = _Waiter(Place.of(purpose, self._arrivals), self._budgets(tokens))
        self._waiting.append(waiter)
        return waiter

    def _budgets(self, tokens: int) -> list[_Budget]:
        requests_a_minute, tokens_a_minute = (
            self._upstream.requests_per_minute,
            self._upstream.tokens_per_minute,
        )
        if tokens_a_minute and tokens > tokens_a_minute:
            raise TooLarge(f"needs about {tokens} tokens, its limit is {tokens_a_minute} a minute")
        name = self._upstream.name
        budgets = [
            _Budget(f"vlm:{name}:tokens", tokens_a_minute, tokens),
            _Budget(f"vlm:{name}:requests", requests_a_minute, 1),
        ]
        return [budget for budget in budgets if budget.capacity]

    async def _wait_for_room(self, waiter: _Waiter, until: float) -> float:
        while True:
            waiter.woken.clear()
            need = await self._need(waiter)
            if need == 0.0:
                self._inside += 1
                return 0.0
            remaining = until - self._clock()
            if remaining <= 0.0 or (need is not None and need > remaining):
                return need or self._turn_comes_in(waiter)
            await _sleep_until_woken(waiter.woken, remaining if need is None else need)

    async def _need(self, waiter: _Waiter) -> float | None:
        """Seconds until this waiter may try again; 0.0: it is in; None: when another leaves or gives up."""
        if waiter is not self._first() or self._inside >= self._upstream.max_concurrent:
            return None
        closed = self._closed_until - self._clock()
        if closed > 0.0:
            return closed
        while waiter.budgets:
            wait = await self._take(waiter.budgets[0])
            if wait > 0.0:
                return wait
            waiter.taken.append(waiter.budgets.pop(0))
        # The budgets are in hand; while they were drawn, a place may have gone or someone urgent come.
        return 0.0 if self._inside < self._upstream.max_concurrent else None

    async def _take(self, budget: _Budget) -> float:
        return await self._draw(budget, budget.amount)

    async def _give_back(self, waiter: _Waiter) -> None:
        """Returns what a waiter drew before it gave up."""
        for budget in waiter.taken:
            await self._draw(budget, -budget.amount)

    async def _draw(self, budget: _Budget, amount: float) -> float:
        return await self._store.take_tokens(
            budget.bucket, budget.capacity, budget.capacity / _MINUTE, amount
        )

    def _first(self) -> _Waiter:
        return min(self._waiting, key=lambda waiter: waiter.place)

    def _wake_first(self) -> None:
        if self._waiting:
            self._first().woken.set()

    def _turn_comes_in(self, waiter: _Waiter) -> float:
        """A guess for one who never came to the front: position times the pace of requests, at least 1 s."""
        ahead = sum(other.place < waiter.place for other in self._waiting) + 1
        pace = _MINUTE / self._upstream.requests_per_minute if self._upstream.requests_per_minute else 1.0
        return max(1.0, ahead * pace)


async def _sleep_until_woken(woken: asyncio.Event, seconds: float) -> None:
    try:
        async with asyncio.timeout(seconds):
            await woken.wait()
    except TimeoutError:
        pass
