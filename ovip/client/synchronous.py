"""The same client for code that does not await: one event loop in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable, Coroutine, Iterable
from types import TracebackType
from typing import Any, Literal, TypeVar

from ovip.client.addresses import Addresses
from ovip.client.asynchronous import AsyncClient
from ovip.client.streaming import Hello, OutgoingFrame, StreamEvent, StreamReport
from ovip.scene.answers import Answer, Observation, Query, SearchEvent, Viewpoint
from ovip.scene.types import Partition, SceneMap

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

    def get_map(self, scene: str) -> SceneMap:
        """The confirmed objects of a scene."""
        return self._run(self._client.get_map(scene))

    def get_regions(self, scene: str) -> Partition:
        """The newest partition of a scene's floors."""
        return self._run(self._client.get_regions(scene))

    def _run(self, work: Coroutine[Any, Any, T]) -> T:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()


async def _make(addresses: Addresses) -> AsyncClient:
    return AsyncClient(addresses)
