"""The gateway as a caller meets it: the real server, the real client."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from ovip.clients import VlmClient, connect
from ovip.errors import InvalidInput, NotAuthorized, NotConfigured, Unavailable
from ovip.store import Store
from ovip.v1 import vlm_pb2, vlm_pb2_grpc
from services.vlm_gateway.__main__ import serve
from services.vlm_gateway.config import Settings, UpstreamSettings
from tests.unit.services.vlm_gateway.local_upstream import LocalUpstream, picture, refuses, says

SCHEMA = {"type": "array", "items": {"type": "string"}}


@contextlib.asynccontextmanager
async def running(
    store: Store, tmp_path: Path, *upstreams: UpstreamSettings, key: str | None = None
) -> AsyncIterator[str]:
    settings = Settings(
        _env_file=None,
        data_dir=tmp_path,
        host="127.0.0.1",
        api_key=key,
        vlm_gateway_port=0,
        vlm_upstreams=upstreams,
        vlm_attempts=1,
        vlm_jitter_seed=0,
    )
    async with serve(settings, store) as port:
        yield f"127.0.0.1:{port}"


async def test_ask_and_status_over_grpc(store: Store, tmp_path: Path, upstream: LocalUpstream) -> None:
    upstream.script(says(["mug", "café"]))
    async with running(store, tmp_path, upstream.settings()) as address, connect(address) as channel:
        client = VlmClient(channel)
        reply = await client.ask("search", "What is here?", [picture(64, 48)], SCHEMA)
        again = await client.ask("search", "What is here?", [picture(64, 48)], SCHEMA)
        status = await client.status()
    assert reply.value == ["mug", "café"] and reply.route == "local" and not reply.cached
    assert again.value == reply.value and again.cached
    assert (status.configured, status.routes, status.calls, status.cache_hits) == (True, ("local",), 1, 1)


async def test_no_upstream_is_told_as_not_configured(store: Store, tmp_path: Path) -> None:
    async with running(store, tmp_path) as address, connect(address) as channel:
        with pytest.raises(NotConfigured, match="OVIP_VLM_UPSTREAMS"):
            await VlmClient(channel).ask("group", "Group these.", schema=SCHEMA)
        assert not (await VlmClient(channel).status()).configured


async def test_failing_upstream_is_told_as_unavailable(
    store: Store, tmp_path: Path, upstream: LocalUpstream
) -> None:
    upstream.script(refuses(500, "boom"))
    async with running(store, tmp_path, upstream.settings()) as address, connect(address) as channel:
        with pytest.raises(Unavailable, match="local: HTTP 500: boom"):
            await VlmClient(channel).ask("enumerate", "What is here?", schema=SCHEMA)


async def test_bad_image_is_told_as_invalid(store: Store, tmp_path: Path, upstream: LocalUpstream) -> None:
    async with running(store, tmp_path, upstream.settings()) as address, connect(address) as channel:
        with pytest.raises(InvalidInput, match="image 1"):
            await VlmClient(channel).ask("enumerate", "What is here?", [picture(64, 48)[:200]], SCHEMA)


async def test_unnamed_purpose_is_told_as_invalid(store: Store, tmp_path: Path) -> None:
    async with running(store, tmp_path) as address, connect(address) as channel:
        stub: Any = vlm_pb2_grpc.VlmGatewayServiceStub(channel)  # type: ignore[no-untyped-call]
        with pytest.raises(Exception, match="PURPOSE_SEARCH"):
            await stub.Ask(vlm_pb2.AskRequest(prompt="What is here?"))


async def test_caller_without_the_key_is_turned_away(
    store: Store, tmp_path: Path, upstream: LocalUpstream
) -> None:
    upstream.script(says(["mug"]))
    async with running(store, tmp_path, upstream.settings(), key="right") as address:
        async with connect(address, "wrong") as channel:
            with pytest.raises(NotAuthorized):
                await VlmClient(channel).ask("search", "What is here?", schema=SCHEMA)
        async with connect(address, "right") as channel:
            assert (await VlmClient(channel).ask("search", "What is here?", schema=SCHEMA)).value == ["mug"]
