"""The frame history over HTTP."""

from __future__ import annotations

from dataclasses import replace

import httpx
import pytest

from services.api.server import models
from tests.unit.services.api.flat import Flat, frame_record

BASE = "/v1/scenes/flat"


async def test_frames_come_in_order_of_arrival_page_by_page(client: httpx.AsyncClient) -> None:
    first = (await client.get(f"{BASE}/frames", params={"limit": 8})).json()
    rest = (await client.get(f"{BASE}/frames", params={"limit": 8, "cursor": first["next_cursor"]})).json()
    ids = [frame["frame_id"] for frame in first["frames"] + rest["frames"]]
    assert ids == [f"robot.walk.{n}" for n in range(1, 13)]
    assert rest["next_cursor"] is None
    assert models.FramePage.model_validate(first)


async def test_the_end_of_the_last_page_leads_to_what_came_since(
    client: httpx.AsyncClient, home: Flat
) -> None:
    end = (await client.get(f"{BASE}/frames")).json()["end_cursor"]
    nothing = (await client.get(f"{BASE}/frames", params={"cursor": end})).json()
    assert (nothing["frames"], nothing["end_cursor"]) == ([], end)
    home.records.append(frame_record(13))
    later = (await client.get(f"{BASE}/frames", params={"cursor": end})).json()
    assert [frame["frame_id"] for frame in later["frames"]] == ["robot.walk.13"]


async def test_a_scene_without_frames_has_an_empty_page(client: httpx.AsyncClient, home: Flat) -> None:
    home.records = []
    page = (await client.get(f"{BASE}/frames")).json()
    assert (page["frames"], page["next_cursor"], page["end_cursor"]) == ([], None, None)


async def test_an_objects_cursor_is_not_taken_for_frames(client: httpx.AsyncClient) -> None:
    cursor = (await client.get(f"{BASE}/objects", params={"limit": 1})).json()["next_cursor"]
    assert (await client.get(f"{BASE}/frames", params={"cursor": cursor})).status_code == 422


async def test_a_pose_in_the_recordings_frame_is_turned_as_its_position_is(client: httpx.AsyncClient) -> None:
    world = (await client.get(f"{BASE}/frames?limit=1")).json()["frames"][0]
    source = (await client.get(f"{BASE}/frames?limit=1&frame=source")).json()["frames"][0]
    x, y, z = world["position"]
    assert source["position"] == pytest.approx([x, z - 0.5, -y], abs=1e-3)
    assert [row[3] for row in source["pose"][:3]] == pytest.approx(source["position"], abs=1e-3)


async def test_an_image_comes_as_it_was_sent(client: httpx.AsyncClient) -> None:
    reply = await client.get(f"{BASE}/frames/robot.walk.3/rgb")
    assert reply.headers["content-type"] == "image/jpeg"
    assert reply.content[:2] == b"\xff\xd8"


async def test_a_frame_says_which_region_it_was_taken_in(client: httpx.AsyncClient, home: Flat) -> None:
    home.regions = [replace(home.regions[0], frame_ids=("robot.walk.2", "robot.walk.3")), home.regions[1]]
    home.regions[1] = replace(home.regions[1], frame_ids=("robot.walk.7",))
    frames = (await client.get(f"{BASE}/frames")).json()["frames"]
    assert {f["frame_id"]: f["region_id"] for f in frames if f["region_id"]} == {
        "robot.walk.2": "r-living",
        "robot.walk.3": "r-living",
        "robot.walk.7": "r-kitchen",
    }
