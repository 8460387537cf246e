"""Changes of a scene as server-sent events."""

from __future__ import annotations

import asyncio
import time

import httpx
import pytest
from fastapi import FastAPI

from ovip.errors import Unavailable
from ovip.scene.types import RegionEvent, RegionEventKind
from services.api.server.listening import listening
from tests.unit.services.api.flat import Flat
from tests.unit.services.api.server.reading import Read, events_of

EVENTS = "/v1/scenes/flat/events"
APPEARED = {
    "kind": "appeared",
    "region_id": "r-bath",
    "floor": 0,
    "display_name": "bathroom",
    "other": "r-living",
}
BOX = (1.0, 1.0, 0.0, 2.0, 2.0, 1.0)


async def take(reply: httpx.Response, count: int) -> list[Read]:
    told: list[Read] = []
    async with asyncio.timeout(5):
        async for event in events_of(reply):
            told.append(event)
            if len(told) == count:
                break
    return told


async def test_the_stream_begins_with_the_regions_and_goes_on_with_live_deltas(
    live: httpx.AsyncClient, home: Flat
) -> None:
    async with live.stream("GET", EVENTS) as reply:
        events = events_of(reply)
        assert await anext(events) == ("regions", {"revision": 3, "map_version": 11, "events": []}, "")
        grown = home.grow("lamp", BOX, "r-living")
        name, delta, event_id = await anext(events)
    assert (name, event_id) == ("map", "13")
    assert delta["created"] == [grown.object_id]
    assert delta["aliases"] == {"o-900": "o-001"}


async def test_a_client_that_reconnects_misses_no_delta(live: httpx.AsyncClient, home: Flat) -> None:
    for _ in range(3):
        home.grow("lamp", BOX, "r-living")
    async with live.stream("GET", EVENTS, headers={"Last-Event-ID": "13"}) as reply:
        told = await take(reply, 3)
    assert [event_id for name, _, event_id in told if name == "map"] == ["14", "15"]


async def test_the_first_connection_may_name_the_version_it_has(live: httpx.AsyncClient) -> None:
    async with live.stream("GET", EVENTS, params={"after": 10}) as reply:
        told = await take(reply, 3)
    assert [event_id for name, _, event_id in told if name == "map"] == ["11", "12"]


async def test_a_new_partition_is_told_once(live: httpx.AsyncClient, home: Flat) -> None:
    async with live.stream("GET", EVENTS) as reply:
        events = events_of(reply)
        await anext(events)
        home.cut_anew(RegionEvent(RegionEventKind.APPEARED, "r-bath", 0, "bathroom", "r-living"))
        assert await anext(events) == (
            "regions",
            {"revision": 4, "map_version": 11, "events": [APPEARED]},
            "",
        )
        await asyncio.sleep(0.1)
        home.grow("lamp", BOX, "r-living")
        assert (await anext(events))[0] == "map"


async def test_an_unknown_scene_and_a_wrong_id_are_refused_before_the_stream(
    live: httpx.AsyncClient,
) -> None:
    assert (await live.get("/v1/scenes/attic/events")).status_code == 404
    assert (await live.get(EVENTS, headers={"Last-Event-ID": "x"})).status_code == 422


async def test_a_service_that_goes_away_ends_the_stream_in_a_problem(
    live: httpx.AsyncClient, home: Flat
) -> None:
    async with live.stream("GET", EVENTS) as reply:
        events = events_of(reply)
        await anext(events)
        home.fail(Unavailable("regions: connection refused"))
        name, body, _ = await anext(events)
        assert (name, body["detail"]) == ("problem", "regions: connection refused")
        assert await anext(events, None) is None


async def test_a_silent_stream_is_kept_open_by_comments(live: httpx.AsyncClient) -> None:
    async with live.stream("GET", EVENTS) as reply, asyncio.timeout(3):
        lines = [line async for line in _first_lines(reply, 8)]
    assert lines.count(": still here") >= 1


async def _first_lines(reply: httpx.Response, count: int):  # type: ignore[no-untyped-def]
    async for line in reply.aiter_lines():
        yield line
        count -= 1
        if count == 0:
            return


async def test_a_reader_that_leaves_is_forgotten(live: httpx.AsyncClient) -> None:
    before = len(asyncio.all_tasks())
    async with live.stream("GET", EVENTS) as reply:
        await take(reply, 1)
        assert len(asyncio.all_tasks()) > before
    for _ in range(100):
        if len(asyncio.all_tasks()) <= before:
            break
        await asyncio.sleep(0.02)
    assert len(asyncio.all_tasks()) <= before


@pytest.mark.parametrize("readers", [3])
async def test_open_streams_do_not_hold_up_the_stop(
    app: FastAPI, stopping: asyncio.Event, readers: int
) -> None:
    async with httpx.AsyncClient(trust_env=False, verify=False, timeout=10) as client:
        async with listening(app, "127.0.0.1", 0, stopping) as port:
            requests = [
                client.build_request("GET", f"http://127.0.0.1:{port}{EVENTS}") for _ in range(readers)
            ]
            replies = [await client.send(request, stream=True) for request in requests]
            for reply in replies:
                await anext(reply.aiter_raw())
            began = time.monotonic()
        assert time.monotonic() - began < 9  # an open stream would wait for its client's 10 s
        for reply in replies:
            await reply.aclose()
