"""Server-sent events over HTTP."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import aclosing
from dataclasses import dataclass
from typing import Any

from starlette.responses import StreamingResponse

from ovip.errors import OvipError
from services.api.server.problems import problem_of

MEDIA_TYPE = "text/event-stream"
_HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}


@dataclass(frozen=True, slots=True)
class Event:
    """One event. event_id: what the client sends back as Last-Event-ID to go on after it; "": none."""

    name: str
    data: Any
    event_id: str = ""


def event_stream(
    events: AsyncGenerator[Event], stopping: asyncio.Event, heartbeat_s: float
) -> StreamingResponse:
    """The events as a response; an error becomes a last event "problem". Ends when the service stops."""
    return StreamingResponse(_lines(events, stopping, heartbeat_s), media_type=MEDIA_TYPE, headers=_HEADERS)


def encode(event: Event) -> bytes:
    """One event as bytes on the wire."""
    head = f"id: {event.event_id}\n" if event.event_id else ""
    return f"{head}event: {event.name}\ndata: {json.dumps(event.data, allow_nan=False)}\n\n".encode()


async def _lines(
    events: AsyncGenerator[Event], stopping: asyncio.Event, heartbeat_s: float
) -> AsyncIterator[bytes]:
    stop = asyncio.create_task(stopping.wait())
    following = asyncio.create_task(_next(events))
    try:
        yield b": open\n\n"
        while True:
            done, _ = await asyncio.wait(
                [following, stop], timeout=heartbeat_s, return_when=asyncio.FIRST_COMPLETED
            )
            if stop in done:
                return
            if not done:
                yield b": still here\n\n"
                continue
            event = following.result()
            if event is None:
                return
            yield encode(event)
            following = asyncio.create_task(_next(events))
    except OvipError as error:
        yield encode(Event("problem", problem_of(error)))
    finally:
        stop.cancel()
        following.cancel()
        await asyncio.gather(stop, following, return_exceptions=True)
        async with aclosing(events):
            pass


async def _next(events: AsyncGenerator[Event]) -> Event | None:
    return await anext(events, None)
