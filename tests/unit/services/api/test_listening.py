"""Standing up and going down, alone or among others."""

from __future__ import annotations

import signal
import socket
import time
from pathlib import Path

import httpx
import pytest

from ovip.errors import InvalidInput
from services.api.__main__ import serve
from services.api.config import Settings


def settings(port: int = 0, host: str = "127.0.0.1", key: str | None = None) -> Settings:
    return Settings(api_port=port, host=host, api_key=key, api_ready_timeout_s=0.2, _env_file=None)


async def test_a_free_port_is_found_and_given_back() -> None:
    async with serve(settings(), None) as port, httpx.AsyncClient(trust_env=False) as client:  # type: ignore[arg-type]
        assert (await client.get(f"http://127.0.0.1:{port}/healthz")).status_code == 200
    with socket.create_server(("127.0.0.1", port)):
        pass


async def test_a_taken_port_is_named_with_its_setting() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(InvalidInput, match=f"port {port} .*OVIP_API_PORT"):
            async with serve(settings(port), None):  # type: ignore[arg-type]
                pass


async def test_it_does_not_listen_beyond_this_machine_without_a_key() -> None:
    with pytest.raises(InvalidInput, match="OVIP_API_KEY"):
        async with serve(settings(host="0.0.0.0"), None):  # type: ignore[arg-type]
            pass


async def test_signals_are_left_to_the_process() -> None:
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    async with serve(settings(), None):  # type: ignore[arg-type]
        assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


async def test_without_the_other_services_it_stands_and_says_whom_it_misses() -> None:
    names = ("perception", "mapper", "regions", "retrieval", "vlm_gateway")
    alone = settings().model_copy(update={f"{name}_address": "127.0.0.1:1" for name in names})
    async with serve(alone, None) as port, httpx.AsyncClient(trust_env=False) as client:  # type: ignore[arg-type]
        reply = await client.get(f"http://127.0.0.1:{port}/readyz")
    assert reply.status_code == 503
    assert "perception, mapper, regions, retrieval, vlm_gateway" in reply.json()["detail"]


def test_the_port_is_read_from_its_variable(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("OVIP_API_PORT", "9123")
    assert Settings(_env_file=None).port == 9123


async def test_small_answers_are_not_held_back_for_an_acknowledgement(live: httpx.AsyncClient) -> None:
    await live.get("/healthz")
    began = time.perf_counter()
    for _ in range(20):
        await live.get("/healthz")
    assert time.perf_counter() - began < 20 * 0.030
