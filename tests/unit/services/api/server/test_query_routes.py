"""Questions over HTTP, answered at once or told event by event."""

from __future__ import annotations

import httpx
import numpy as np
import pytest

from ovip.errors import NotConfigured
from services.api.server import models
from tests.unit.services.api.flat import Y_UP, Flat
from tests.unit.services.api.server.reading import events_of

ASK = "/v1/scenes/flat/queries"
STREAM = {"Accept": "text/event-stream"}


@pytest.mark.parametrize("text", ["sofa", "white mug", "piano"])
async def test_an_answer_is_what_openapi_promises(client: httpx.AsyncClient, text: str) -> None:
    reply = await client.post(ASK, json={"text": text})
    assert reply.status_code == 200
    assert models.Answer.model_validate(reply.json()).model_dump() == reply.json()


async def test_a_thing_on_the_map_is_found_in_tier_1(client: httpx.AsyncClient) -> None:
    body = (await client.post(ASK, json={"text": "sofa"})).json()
    assert (body["outcome"], body["tier"], body["object"]["id"], body["search_id"]) == (
        "found",
        1,
        "o-001",
        "s-1",
    )
    assert body["goal"]["position"][2] == 0.0
    assert len(body["path"]) == 3


async def test_what_is_not_found_says_what_tier_4_would_need(client: httpx.AsyncClient) -> None:
    body = (await client.post(ASK, json={"text": "piano"})).json()
    assert (body["outcome"], body["tier"], body["object"]) == ("unresolved", 4, None)
    assert "18 viewpoints" in body["needs"]
    assert body["coverage"]["planned"] == 18
    assert [tier["tier"] for tier in body["tiers"]] == [1, 2, 3, 4]


async def test_the_stream_tells_each_tier_and_the_answer_last(live: httpx.AsyncClient) -> None:
    async with live.stream("POST", ASK, json={"text": "white mug"}, headers=STREAM) as reply:
        assert reply.headers["content-type"].startswith("text/event-stream")
        told = [event async for event in events_of(reply)]
    assert [(name, body.get("tier")) for name, body, _ in told] == [
        ("tier_started", 1),
        ("tier_finished", 1),
        ("tier_started", 2),
        ("tier_finished", 2),
        ("answer", 2),
    ]
    at_once = (await live.post(ASK, json={"text": "white mug"})).json()
    assert told[-1][1] == at_once


async def test_a_search_that_is_refused_has_a_status_and_no_stream(client: httpx.AsyncClient) -> None:
    for headers in ({}, STREAM):
        reply = await client.post(ASK, json={"text": "refuse"}, headers=headers)
        assert reply.status_code == 422
        assert reply.json()["detail"] == "text: expected a thing to look for"


async def test_a_search_that_breaks_off_ends_in_a_problem(client: httpx.AsyncClient) -> None:
    reply = await client.post(ASK, json={"text": "silence"})
    assert reply.status_code == 503
    async with client.stream("POST", ASK, json={"text": "silence"}, headers=STREAM) as stream:
        told = [event async for event in events_of(stream)]
    assert told[-1][0] == "problem"
    assert told[-1][1]["status"] == 503


async def test_a_question_reaches_retrieval_as_it_was_asked(client: httpx.AsyncClient, home: Flat) -> None:
    pose = np.eye(4)
    pose[:3, 3] = [1.0, 2.0, 3.0]
    body = {
        "text": " white mug ",
        "robot": {"pose": pose.tolist(), "radius": 0.3},
        "region_hint": "kitchen",
        "min_tier": 2,
        "max_tier": 3,
        "max_vlm_calls": 7,
        "max_viewpoints": 9,
    }
    await client.post(ASK, json=body)
    asked = home.queries[-1]
    assert (asked.scene, asked.text, asked.region_hint, asked.robot_radius) == (
        "flat",
        "white mug",
        "kitchen",
        0.3,
    )
    assert (asked.min_tier, asked.max_tier, asked.max_vlm_calls, asked.max_viewpoints) == (2, 3, 7, 9)
    np.testing.assert_array_equal(asked.robot_pose, pose)


async def test_a_bare_question_leaves_everything_to_the_service(
    client: httpx.AsyncClient, home: Flat
) -> None:
    await client.post(ASK, json={"text": "mug"})
    asked = home.queries[-1]
    assert (asked.robot_pose, asked.robot_radius, asked.min_tier, asked.max_tier) == (None, 0.0, 0, 0)


async def test_in_the_recordings_frame_the_robots_pose_is_read_and_the_answer_told(
    client: httpx.AsyncClient, home: Flat
) -> None:
    body = {"text": "sofa", "robot": {"pose": np.eye(4).tolist()}}
    told = (await client.post(f"{ASK}?frame=source", json=body)).json()
    np.testing.assert_allclose(home.queries[-1].robot_pose, Y_UP)
    world = (await client.post(ASK, json=body)).json()
    x, y, z = world["object"]["position"]
    assert told["object"]["position"] == pytest.approx([x, z - 0.5, -y])
    assert (told["frame"], told["goal"]["yaw"]) == ("source", None)


async def test_a_pose_that_is_no_rigid_motion_is_refused(client: httpx.AsyncClient, home: Flat) -> None:
    bent = np.diag([2.0, 1.0, 1.0, 1.0]).tolist()
    reply = await client.post(ASK, json={"text": "sofa", "robot": {"pose": bent}})
    assert reply.status_code == 422
    assert "rigid" in reply.json()["detail"]
    assert home.queries == []


async def test_a_search_can_be_read_again(client: httpx.AsyncClient) -> None:
    answer = (await client.post(ASK, json={"text": "sofa"})).json()
    stored = (await client.get("/v1/scenes/flat/searches/s-1")).json()
    assert stored == {"search_id": "s-1", "text": "sofa", "done": True, "answer": answer}


async def test_a_service_away_is_said_with_its_status(client: httpx.AsyncClient, home: Flat) -> None:
    home.broken = NotConfigured("set OVIP_VLM_UPSTREAMS")
    assert (await client.post(ASK, json={"text": "sofa"}, headers=STREAM)).status_code == 409
