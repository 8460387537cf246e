"""A running api over the flat in memory, and a client of it."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import AsyncIterator

import httpx
import pytest
import pytest_asyncio
from fastapi import FastAPI

from ovip.telemetry import configure_logging
from services.api.config import Settings
from services.api.server import create_app
from services.api.server.listening import listening
from services.api.service import SceneService
from tests.unit.services.api.flat import Flat, backends_of, flat


@pytest.fixture(autouse=True)
def _plain_logs() -> None:
    configure_logging("error", as_json=False)


@pytest.fixture
def home() -> Flat:
    return flat()


@pytest.fixture
def settings() -> Settings:
    return Settings(api_port=0, api_key=None, api_heartbeat_s=0.2, _env_file=None)


@pytest.fixture
def stopping() -> asyncio.Event:
    return asyncio.Event()


@pytest.fixture
def app(home: Flat, settings: Settings, stopping: asyncio.Event) -> FastAPI:
    made = _app(settings.api_key)
    made.state.service = SceneService(backends_of(home))
    made.state.settings, made.state.stopping = settings, stopping
    return made


@pytest_asyncio.fixture
async def client(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    """Asks the application without a socket between."""
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://api") as running:
        yield running


@pytest_asyncio.fixture
async def live(app: FastAPI, stopping: asyncio.Event) -> AsyncIterator[httpx.AsyncClient]:
    """Asks over a real socket, which endless streams need."""
    async with listening(app, "127.0.0.1", 0, stopping) as port:
        base = f"http://127.0.0.1:{port}"
        async with httpx.AsyncClient(base_url=base, trust_env=False, verify=False, timeout=10) as running:
            yield running


@functools.cache
def _app(api_key: str | None) -> FastAPI:
    """Making the routes takes a third of a second, so tests that differ in their state alone share them."""
    keyed = Settings(api_port=0, api_key=api_key, _env_file=None)
    return create_app(SceneService(backends_of(flat())), keyed, asyncio.Event())
