"""Errors as problem details that say what was expected."""

from __future__ import annotations

import httpx
import pytest

from ovip.errors import NotConfigured, Unavailable
from tests.unit.services.api.flat import Flat


@pytest.mark.parametrize(
    ("path", "status", "slug", "said"),
    [
        ("/nope", 404, "not-found", "/openapi.json lists"),
        ("/v1/scenes/attic", 404, "not-found", "there are: flat"),
        ("/v1/scenes/attic/objects", 404, "not-found", "there are: flat"),
        ("/v1/scenes/flat/objects/o-999", 404, "not-found", "o-999"),
        ("/v1/scenes/flat/frames/robot.walk.99/rgb", 404, "not-found", "robot.walk.99"),
        ("/v1/scenes/flat/grid/4", 404, "not-found", "there are: 0"),
        ("/v1/scenes/flat/searches/s-9", 404, "not-found", "s-9"),
        ("/v1/scenes/flat/objects?limit=0", 422, "invalid-input", "query.limit"),
        ("/v1/scenes/flat/objects?cursor=zzz", 422, "invalid-input", "earlier page of objects"),
        ("/v1/scenes/flat/objects?frame=camera", 422, "invalid-input", "'world' or 'source'"),
        ("/v1/scenes/fl%20at/objects", 422, "invalid-input", "path.scene"),
        ("/v1/scenes/flat/exports/ply?format=obj", 422, "invalid-input", "binary_little_endian"),
        ("/v1/scenes/flat/floorplan.png?scale=0", 422, "invalid-input", "query.scale"),
        ("/static/nope.js", 404, "not-found", "no such path"),
        ("/static/../config.py", 404, "not-found", "no such path"),
    ],
)
async def test_a_wrong_address_is_told_what_was_expected(
    client: httpx.AsyncClient, path: str, status: int, slug: str, said: str
) -> None:
    reply = await client.get(path)
    body = reply.json()
    assert reply.headers["content-type"] == "application/problem+json"
    assert (reply.status_code, body["status"]) == (status, status)
    assert body["type"] == f"urn:ovip:problem:{slug}"
    assert said in body["detail"]
    assert body["title"]


@pytest.mark.parametrize(
    ("body", "where"),
    [
        ({}, "body.text"),
        ({"text": "  "}, "body.text"),
        ({"text": "x" * 501}, "body.text"),
        ({"text": "mug", "max_tier": 5}, "body.max_tier"),
        ({"text": "mug", "color": "red"}, "body.color"),
        ({"text": "mug", "robot": {"pose": [[1, 2], [3, 4]]}}, "body.robot.pose"),
        ({"text": "mug", "robot": {"radius": -1}}, "body.robot.radius"),
    ],
)
async def test_a_wrong_question_names_the_field(
    client: httpx.AsyncClient, body: dict[str, object], where: str
) -> None:
    reply = await client.post("/v1/scenes/flat/queries", json=body)
    assert reply.status_code == 422
    assert where in reply.json()["detail"]
    assert reply.json()["errors"][0]["where"].startswith(where)


async def test_a_question_that_is_no_json_is_refused(client: httpx.AsyncClient) -> None:
    reply = await client.post(
        "/v1/scenes/flat/queries", content="{mug", headers={"Content-Type": "application/json"}
    )
    assert reply.status_code == 422
    assert reply.headers["content-type"] == "application/problem+json"


async def test_a_wrong_method_names_the_right_one(client: httpx.AsyncClient) -> None:
    reply = await client.delete("/v1/scenes/flat/objects")
    assert reply.status_code == 405
    assert "expected GET" in reply.json()["detail"]


async def test_an_error_of_another_service_keeps_its_status_and_words(
    client: httpx.AsyncClient, home: Flat
) -> None:
    home.broken = Unavailable("mapper: connection refused")
    reply = await client.get("/v1/scenes")
    assert (reply.status_code, reply.json()["detail"]) == (503, "mapper: connection refused")
    home.broken = NotConfigured("OVIP_X is not set")
    assert (await client.get("/v1/scenes")).json()["type"] == "urn:ovip:problem:not-configured"


async def test_an_error_that_nobody_meant_tells_nothing_of_the_inside(
    client: httpx.AsyncClient, home: Flat
) -> None:
    home.objects = None  # type: ignore[assignment]
    reply = await client.get("/v1/scenes")
    assert reply.status_code == 500
    assert reply.json() == {
        "type": "urn:ovip:problem:internal",
        "title": "Internal Server Error",
        "status": 500,
        "detail": "an error of ours, written to the log of the api service",
    }
