"""What regions does for others: shows the newest partition and its grids, and makes a new one on demand."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable

from ovip.errors import DeadlineExceeded, NotFound
from ovip.scene.grid import FloorGrid
from ovip.scene.types import Partition
from ovip.store import Store
from services.regions.shelf import Shelf

_LOOK_S = 0.05


class Regions:
    """The use cases; any replica answers from the store, whoever follows the scene."""

    def __init__(
        self, store: Store, recompute_timeout_s: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._store = store
        self._shelf = Shelf(store)
        self._recompute_timeout_s = recompute_timeout_s
        self._clock = clock

    async def partition(self, scene: str) -> Partition:
        """The newest partition; empty, with revision 0, before the first. NotFound for an unknown scene."""
        await self._check(scene)
        return await self._shelf.partition(scene)

    async def watch(self, scene: str, after_revision: int) -> AsyncIterator[Partition]:
        """The newest partition, if it is above a revision, then each new one, for ever. NotFound as above."""
        await self._check(scene)
        since = await self._shelf.newest_entry(scene)
        newest = await self._shelf.partition(scene)
        if newest.revision > after_revision:
            yield newest
        async for partition in self._shelf.partitions(scene, since):
            if partition.revision > max(newest.revision, after_revision):
                yield partition

    async def floor_grid(self, scene: str, floor: int) -> FloorGrid:
        """The newest grid of a floor. NotFound for an unknown scene or floor."""
        await self._check(scene)
        return await self._shelf.grid(scene, floor)

    async def recompute(self, scene: str) -> Partition:
        """A partition of everything in the logs now. DeadlineExceeded where nobody makes it in time."""
        await self._check(scene)
        wish = await self._shelf.make_wish(scene)
        until = self._clock() + self._recompute_timeout_s
        while await self._shelf.answered_wish(scene) < wish:
            if self._clock() > until:
                raise DeadlineExceeded(
                    f"no new partition of scene {scene} within {self._recompute_timeout_s:g} s; "
                    "the log of the regions service that follows it says why"
                )
            await asyncio.sleep(_LOOK_S)
        return await self._shelf.partition(scene)

    async def _check(self, scene: str) -> None:
        if scene not in await self._store.scenes():
            raise NotFound(f"no scene {scene!r}")
