"""Changes of a scene as they happen."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import aclosing
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import StreamingResponse

from ovip.jsonable import to_json
from ovip.scene.types import MapDelta
from services.api.server.parameters import KnownScene, Service
from services.api.server.sse import MEDIA_TYPE, Event, event_stream
from services.api.service import SceneEvent

router = APIRouter(tags=["events"])


@router.get(
    "/scenes/{scene}/events",
    response_class=StreamingResponse,
    responses={200: {"content": {MEDIA_TYPE: {"schema": {"type": "string"}}}, "description": "the events"}},
)
async def follow(
    known: KnownScene,
    service: Service,
    request: Request,
    last_event_id: Annotated[
        str | None, Header(description="map version to go on after", pattern=r"^\d{1,19}$")
    ] = None,
    after: Annotated[int | None, Query(ge=0, description="the same, for the first connection")] = None,
) -> StreamingResponse:
    """`map` (a delta, its id the map version) and `regions` (a revision and what changed with it), from a version on
    or from now on.

    A client that reconnects with the last id it saw misses no delta. `regions` comes once at the start.
    """
    resumed = int(last_event_id) if last_event_id else after
    events = service.events(known.scene, known.map_version if resumed is None else resumed)
    return event_stream(
        _named(events), request.app.state.stopping, request.app.state.settings.api_heartbeat_s
    )


async def _named(events: AsyncGenerator[SceneEvent]) -> AsyncGenerator[Event]:
    async with aclosing(events):
        async for event in events:
            if isinstance(event, MapDelta):
                yield Event("map", to_json(event), str(event.version))
            else:
                yield Event("regions", to_json(event))
