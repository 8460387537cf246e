"""The asynchronous client: stream frames, read the map and the regions, ask where things are."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Sequence
from types import TracebackType
from typing import Literal

from ovip.client.addresses import Addresses
from ovip.client.streaming import (
    PATIENCE_SECONDS,
    FrameStream,
    Hello,
    OutgoingFrame,
    StreamEvent,
    StreamReport,
)
from ovip.clients import MapperClient, PerceptionClient, RegionsClient, RetrievalClient, connect
from ovip.errors import Corrupt, DeadlineExceeded, Unavailable
from ovip.ids import uuid7
from ovip.keys import log_order
from ovip.scene.answers import Answer, Observation, PerceptionStatus, Query, SearchEvent, Viewpoint
from ovip.scene.edits import Delete, Edit, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import F64, MapDelta, Partition, SceneMap
from ovip.scene.versions import MapDiff, Verification


class AsyncClient:
    """One stack. Use as `async with AsyncClient(Addresses(...)) as client:`.

    `perception`, `mapper`, `regions` and `retrieval` are the full clients; the methods here are the daily ones.
    """

    def __init__(self, addresses: Addresses) -> None:
        self._channels = {
            name: connect(getattr(addresses, name), addresses.api_key)
            for name in ("perception", "mapper", "regions", "retrieval")
        }
        self.perception = PerceptionClient(self._channels["perception"])
        self.mapper = MapperClient(self._channels["mapper"])
        self.regions = RegionsClient(self._channels["regions"])
        self.retrieval = RetrievalClient(self._channels["retrieval"])

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Closes the connections."""
        await asyncio.gather(*(channel.close() for channel in self._channels.values()))

    async def stream(
        self,
        hello: Hello,
        frames: AsyncIterator[OutgoingFrame] | Iterable[OutgoingFrame],
        keep: Literal["all", "newest"] = "all",
        on_event: Callable[[StreamEvent], None] | None = None,
    ) -> StreamReport:
        """Sends frames; returns when each is durable or rejected. See `FrameStream`."""
        return await FrameStream(self._channels["perception"], hello, keep, on_event).send(frames)

    async def wait_until_applied(
        self,
        scene: str,
        timeout_s: float = 3600.0,
        on_progress: Callable[[PerceptionStatus], None] | None = None,
    ) -> SceneMap:
        """Waits until every durable frame of a scene is in its map, and returns the map.

        Outlives services that go away and come back for up to `PATIENCE_SECONDS`, then Unavailable.
        DeadlineExceeded where `timeout_s` passes first.
        """
        deadline = time.monotonic() + timeout_s
        last_heard = time.monotonic()
        while time.monotonic() < deadline:
            try:
                current = await self._map_if_complete(scene, on_progress)
                last_heard = time.monotonic()
            except Unavailable:
                if time.monotonic() - last_heard > PATIENCE_SECONDS:
                    raise
                current = None
            if current is not None:
                return current
            await asyncio.sleep(0.2)
        raise DeadlineExceeded(f"scene {scene}: not every frame was in the map after {timeout_s:.0f} s")

    async def _map_if_complete(
        self, scene: str, on_progress: Callable[[PerceptionStatus], None] | None
    ) -> SceneMap | None:
        status = await self.perception.status(scene)
        if on_progress:
            on_progress(status)
        if status.frames_processed + status.frames_skipped < status.frames_durable:
            return None
        current = await self.mapper.get_map(scene)
        complete = log_order(current.applied_log_id) >= log_order(status.newest_detections_id)
        return current if complete else None

    async def find(self, query: Query, on_event: Callable[[SearchEvent], None] | None = None) -> Answer:
        """The answer of tiers 1 to 3, with the plan of tier 4."""
        async for _, event in self.retrieval.find(query):
            if on_event:
                on_event(event)
            if isinstance(event, Answer):
                return event
        raise Corrupt("retrieval ended without an answer")

    async def search(
        self, query: Query | str, look: Callable[[Viewpoint], Awaitable[Observation | None]]
    ) -> tuple[str, Answer]:
        """An active search: `look` drives to each viewpoint and answers with a frame. Returns search id and answer.

        query: a query, or the id of a stored search to go on with. `look` returning None cancels the search.
        """

        async def observe(event: SearchEvent) -> Observation | None:
            return await look(event) if isinstance(event, Viewpoint) else None

        async for search_id, event in self.retrieval.search(query, observe):
            if isinstance(event, Answer):
                return search_id, event
        raise Corrupt("retrieval ended without an answer")

    async def get_map(self, scene: str, at_version: int = 0, include_departed: bool = False) -> SceneMap:
        """The confirmed objects of a scene, as they stand or stood at a version; those gone only where asked for."""
        return await self.mapper.get_map(scene, at_version=at_version, include_departed=include_departed)

    async def diff(self, scene: str, from_version: int, to_version: int = 0) -> MapDiff:
        """What differs between two versions of a map (to_version 0: as it stands)."""
        return await self.mapper.diff(scene, from_version, to_version)

    async def verify(self, scene: str) -> Verification:
        """Rebuilds a map from its log and compares: `.holds` says whether it is the same, bit for bit."""
        return await self.mapper.verify(scene)

    async def edit_map(
        self, scene: str, edit: Edit, made_on_version: int, operator: str = "", edit_id: str = ""
    ) -> MapDelta:
        """An operator's edit, made on the map as it was at `made_on_version`.

        Conflict where what it edits has changed since: read the map again and decide again. edit_id: the same again
        is done once; a new one where empty.
        """
        return await self.mapper.edit(scene, EditRequest(edit_id or uuid7(), made_on_version, operator, edit))

    async def rename(
        self, scene: str, object_id: str, label: str, made_on_version: int, operator: str = ""
    ) -> MapDelta:
        """Calls an object `label` from now on; an empty label lets the detections decide again."""
        return await self.edit_map(scene, Rename(object_id, label), made_on_version, operator)

    async def merge(
        self, scene: str, keep_id: str, merged_ids: Sequence[str], made_on_version: int, operator: str = ""
    ) -> MapDelta:
        """Makes all of them one object, known as `keep_id`."""
        return await self.edit_map(scene, Merge(keep_id, tuple(merged_ids)), made_on_version, operator)

    async def split(
        self,
        scene: str,
        object_id: str,
        part: F64,
        made_on_version: int,
        part_label: str = "",
        operator: str = "",
    ) -> MapDelta:
        """Makes what of an object lies in `part` `(6,)` (low, high, world metres) an object of its own."""
        return await self.edit_map(scene, Split(object_id, part, part_label), made_on_version, operator)

    async def delete(self, scene: str, object_id: str, made_on_version: int, operator: str = "") -> MapDelta:
        """Says that there is no such thing, whatever is detected there."""
        return await self.edit_map(scene, Delete(object_id), made_on_version, operator)

    async def pin(
        self, scene: str, object_id: str, made_on_version: int, pinned: bool = True, operator: str = ""
    ) -> MapDelta:
        """Keeps upkeep from merging an object away or giving it up; `pinned=False` lets it again."""
        return await self.edit_map(scene, Pin(object_id, pinned), made_on_version, operator)

    async def get_regions(self, scene: str) -> Partition:
        """The newest partition of a scene's floors."""
        return await self.regions.get_partition(scene)

    async def route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route:
        """The shortest way between two points `(3,)`, world metres, around furniture and over stairs.

        robot_radius: metres, 0 for the service's own setting. Where there is no way, `.why` says so.
        """
        return await self.regions.plan_route(scene, start, goal, robot_radius)

    async def route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph:
        """Doorways, openings and stairs that a robot fits through, and the metres walked between them."""
        return await self.regions.get_route_graph(scene, robot_radius)
