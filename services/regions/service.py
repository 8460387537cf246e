"""What regions does for others: shows the newest partition and its grids, plans ways on
them, and has a new one made on demand."""

from __future__ import annotations

import asyncio
import time
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable

import numpy as np

from ovip.errors import DeadlineExceeded, InvalidInput, NotFound
from ovip.scene.building import Building, check_radius
from ovip.scene.grid import FloorGrid
from ovip.scene.navigation import Route, inflated, route_in
from ovip.scene.route_graph import RouteGraph, graph_of
from ovip.scene.types import F64, Partition
from ovip.store import Store
from services.regions.shelf import Shelf

_LOOK_S = 0.05
_BUILDINGS = 4


class Regions:
    """The use cases; any replica answers from the store, whoever follows the scene."""

    def __init__(
        self,
        store: Store,
        recompute_timeout_s: float,
        clock: Callable[[], float] = time.monotonic,
        robot_radius: float = 0.25,
    ) -> None:
        """robot_radius: metres, of a robot that names none."""
        self._store = store
        self._robot_radius = robot_radius
        self._buildings: OrderedDict[tuple[str, int, float], Building] = OrderedDict()
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

    async def floor_grid(self, scene: str, floor: int, robot_radius: float = 0.0) -> FloorGrid:
        """The newest grid of a floor; above radius 0, free cells where such a robot does not fit are occupied.

        NotFound for an unknown scene or floor, InvalidInput for a radius that no robot has.
        """
        check_radius(robot_radius)
        await self._check(scene)
        grid = await self._shelf.grid(scene, floor)
        return await asyncio.to_thread(inflated, grid, robot_radius) if robot_radius else grid

    async def route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route:
        """The shortest way between two points `(3,)`; radius 0: the setting. NotFound, InvalidInput as above."""
        if not np.isfinite([start, goal]).all():
            raise InvalidInput(f"route: expected finite points, got {start.tolist()} and {goal.tolist()}")
        building = await self._building(scene, robot_radius)
        return await asyncio.to_thread(route_in, building, start, goal)

    async def route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph:
        """The passages that a robot fits through, and the walks between them. NotFound, InvalidInput as above."""
        return await asyncio.to_thread(graph_of, await self._building(scene, robot_radius))

    async def _building(self, scene: str, robot_radius: float) -> Building:
        """The floors of the newest partition for a robot; the last few are kept, for ways are asked for in rows."""
        radius = check_radius(robot_radius) or self._robot_radius
        partition = await self.partition(scene)
        key = (scene, partition.revision, radius)
        if key not in self._buildings:
            partition, grids = await self._with_grids(scene, partition)
            key = (scene, partition.revision, radius)
            self._buildings[key] = await asyncio.to_thread(Building, partition, grids, radius)
        building = self._buildings[key]
        self._buildings.move_to_end(key)
        while len(self._buildings) > _BUILDINGS:
            self._buildings.popitem(last=False)
        return building

    async def _with_grids(self, scene: str, partition: Partition) -> tuple[Partition, dict[int, FloorGrid]]:
        """The newest partition with its own grids: read again where a new one came between the two."""
        while True:
            grids = {f.floor: await self._shelf.grid(scene, f.floor) for f in partition.floors}
            newest = await self._shelf.partition(scene)
            if newest.revision == partition.revision:
                return partition, grids
            partition = newest

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
