"""The key."""

from __future__ import annotations

import httpx
import pytest

from services.api.config import Settings


@pytest.fixture
def settings() -> Settings:
    return Settings(api_port=0, api_key="schlüssel-1", _env_file=None)


@pytest.mark.parametrize(
    "path",
    [
        "/v1/scenes",
        "/v1/scenes/flat/objects",
        "/v1/scenes/flat/frames/robot.walk.1/rgb",
        "/v1/status",
        "/v1/scenes/attic",
    ],
)
@pytest.mark.parametrize(
    "headers", [{}, {"Authorization": "Bearer wrong"}, {"Authorization": "Basic c2NobMO8c3NlbC0x"}]
)
async def test_without_the_right_key_nothing_is_told(
    client: httpx.AsyncClient, path: str, headers: dict[str, str]
) -> None:
    reply = await client.get(path, headers=headers)
    assert reply.status_code == 401
    assert reply.headers["www-authenticate"] == "Bearer"
    assert reply.json()["type"] == "urn:ovip:problem:not-authorized"
    assert "Authorization: Bearer KEY" in reply.json()["detail"]


async def test_a_question_needs_the_key_too(client: httpx.AsyncClient) -> None:
    assert (await client.post("/v1/scenes/flat/queries", json={"text": "mug"})).status_code == 401


async def test_the_key_is_taken_from_the_header_or_the_address(client: httpx.AsyncClient) -> None:
    by_header = await client.get("/v1/scenes", headers={"Authorization": "Bearer schlüssel-1".encode()})
    by_address = await client.get("/v1/scenes", params={"key": "schlüssel-1"})
    assert by_address.status_code == 200
    assert by_header.status_code == 200


@pytest.mark.parametrize("path", ["/", "/healthz", "/static/main.js", "/openapi.json"])
async def test_the_page_and_the_health_are_open(client: httpx.AsyncClient, path: str) -> None:
    assert (await client.get(path)).status_code == 200
