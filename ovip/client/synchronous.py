"""The same client for code that does not await: one event loop in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Sequence
from types import TracebackType
from typing import Any, Literal, TypeVar

from ovip.client.addresses import Addresses
from ovip.client.asynchronous import AsyncClient
from ovip.client.streaming import Hello, OutgoingFrame, StreamEvent, StreamReport
from ovip.scene.answers import Answer, Observation, Query, SearchEvent, Viewpoint
from ovip.scene.edits import Edit
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import F64, MapDelta, Partition, SceneMap
from ovip.scene.versions import MapDiff, Verification

T = TypeVar("T")


class Client:
    """One stack. Use as `with Client(Addresses(...)) as client:`."""

    def __init__(self, addresses: Addresses) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="ovip-client", daemon=True)
        self._thread.start()
        self._client = self._run(_make(addresses))

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections and ends the thread."""
        self._run(self._client.close())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def stream(
        self,
        hello: Hello,
        frames: Iterable[OutgoingFrame],
        keep: Literal["all", "newest"] = "all",
        on_event: Callable[[StreamEvent], None] | None = None,
    ) -> StreamReport:
        """Sends frames; returns when each is durable or rejected."""
        return self._run(self._client.stream(hello, frames, keep, on_event))

    def wait_until_applied(self, scene: str, timeout_s: float = 3600.0) -> SceneMap:
        """Waits until every durable frame of a scene is in its map, and returns the map."""
        return self._run(self._client.wait_until_applied(scene, timeout_s))

    def find(self, query: Query, on_event: Callable[[SearchEvent], None] | None = None) -> Answer:
        """The answer of tiers 1 to 3, with the plan of tier 4."""
        return self._run(self._client.find(query, on_event))

    def search(
        self, query: Query | str, look: Callable[[Viewpoint], Observation | None]
    ) -> tuple[str, Answer]:
        """An active search; `look` runs in a thread, one viewpoint at a time."""

        def in_thread(viewpoint: Viewpoint) -> Awaitable[Observation | None]:
            return asyncio.to_thread(look, viewpoint)

        return self._run(self._client.search(query, in_thread))

    def get_map(self, scene: str, at_version: int = 0, include_departed: bool = False) -> SceneMap:
        """The confirmed objects of a scene, as they stand or stood at a version; those gone only where asked for."""
        return self._run(self._client.get_map(scene, at_version, include_departed))

    def diff(self, scene: str, from_version: int, to_version: int = 0) -> MapDiff:
        """What differs between two versions of a map (to_version 0: as it stands)."""
        return self._run(self._client.diff(scene, from_version, to_version))

    def verify(self, scene: str) -> Verification:
        """Rebuilds a map from its log and compares: `.holds` says whether it is the same, bit for bit."""
        return self._run(self._client.verify(scene))

    def edit_map(
        self, scene: str, edit: Edit, made_on_version: int, operator: str = "", edit_id: str = ""
    ) -> MapDelta:
        """An operator's edit, made on the map as it was at `made_on_version`. See `AsyncClient.edit_map`."""
        return self._run(self._client.edit_map(scene, edit, made_on_version, operator, edit_id))

    def rename(
        self, scene: str, object_id: str, label: str, made_on_version: int, operator: str = ""
    ) -> MapDelta:
        """Calls an object `label` from now on; an empty label lets the detections decide again."""
        return self._run(self._client.rename(scene, object_id, label, made_on_version, operator))

    def merge(
        self, scene: str, keep_id: str, merged_ids: Sequence[str], made_on_version: int, operator: str = ""
    ) -> MapDelta:
        """Makes all of them one object, known as `keep_id`."""
        return self._run(self._client.merge(scene, keep_id, merged_ids, made_on_version, operator))

    def split(
        self,
        scene: str,
        object_id: str,
        part: F64,
        made_on_version: int,
        part_label: str = "",
        operator: str = "",
    ) -> MapDelta:
        """Makes what of an object lies in `part` `(6,)` (low, high, world metres) an object of its own."""
        return self._run(self._client.split(scene, object_id, part, made_on_version, part_label, operator))

    def delete(self, scene: str, object_id: str, made_on_version: int, operator: str = "") -> MapDelta:
        """Says that there is no such thing, whatever is detected there."""
        return self._run(self._client.delete(scene, object_id, made_on_version, operator))

    def pin(
        self, scene: str, object_id: str, made_on_version: int, pinned: bool = True, operator: str = ""
    ) -> MapDelta:
        """Keeps upkeep from merging an object away or giving it up; `pinned=False` lets it again."""
        return self._run(self._client.pin(scene, object_id, made_on_version, pinned, operator))

    def get_regions(self, scene: str) -> Partition:
        """The newest partition of a scene's floors."""
        return self._run(self._client.get_regions(scene))

    def route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route:
        """The shortest way between two points `(3,)`, world metres. See `AsyncClient.route`."""
        return self._run(self._client.route(scene, start, goal, robot_radius))

    def route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph:
        """Doorways, openings and stairs that a robot fits through, and the metres walked between them."""
        return self._run(self._client.route_graph(scene, robot_radius))

    def _run(self, work: Coroutine[Any, Any, T]) -> T:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()


async def _make(addresses: Addresses) -> AsyncClient:
    return AsyncClient(addresses)
