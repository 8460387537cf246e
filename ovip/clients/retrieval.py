"""The client of retrieval."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

from ovip import codec
from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, errors, read
from ovip.scene.answers import Observation, Query, SearchEvent
from ovip.v1 import retrieval_pb2, retrieval_pb2_grpc


class RetrievalClient:
    """Asks where things are."""

    def __init__(self, channel: Any) -> None:
        self._stub = retrieval_pb2_grpc.RetrievalServiceStub(channel)

    async def find(self, query: Query) -> AsyncIterator[tuple[str, SearchEvent]]:
        """(search id, event) pairs; the last event is the Answer."""
        with errors():
            async for reply in self._stub.Find(codec.query_message(query), timeout=SLOW_SECONDS):
                yield reply.search_id, codec.event_value(reply.event)

    async def search(
        self,
        start: Query | str,
        observe: Callable[[SearchEvent], Awaitable[Observation | None]],
    ) -> AsyncIterator[tuple[str, SearchEvent]]:
        """A search with a robot: `observe` is called for each event and answers viewpoints; the Answer comes last.

        start: a new query, or "SCENE/SEARCH_ID" to go on with a stored search. `observe` returning None for a
        viewpoint cancels the search.
        """
        call = self._stub.Search()
        with errors():
            if isinstance(start, Query):
                await call.write(retrieval_pb2.SearchRequest(start=codec.query_message(start)))
            else:
                await call.write(retrieval_pb2.SearchRequest(resume_search_id=start))
            async for reply in call:
                event = codec.event_value(reply.event)
                yield reply.search_id, event
                if reply.event.WhichOneof("event") != "viewpoint":
                    continue
                seen = await observe(event)
                if seen is None:
                    await call.write(retrieval_pb2.SearchRequest(cancel=True))
                    continue
                await call.write(
                    retrieval_pb2.SearchRequest(
                        observation=retrieval_pb2.Observation(
                            viewpoint_id=seen.viewpoint_id,
                            frame_id=seen.frame_id,
                            unreachable=seen.unreachable,
                        )
                    )
                )

    async def get_search(self, scene: str, search_id: str) -> tuple[str, bool, Any]:
        """Text, whether it is done, and the Answer if so."""
        request = retrieval_pb2.GetSearchRequest(scene=scene, search_id=search_id)
        reply = await read(lambda: self._stub.GetSearch(request, timeout=READ_SECONDS))
        return reply.text, reply.done, codec.answer_value(reply.answer) if reply.HasField("answer") else None
