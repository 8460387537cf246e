"""Starts the api service."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from ovip.serving import check_exposure, run_alone
from ovip.store import Store
from ovip.telemetry import get_logger
from services.api.adapters.backends import connected
from services.api.config import Settings
from services.api.server import create_app
from services.api.server.listening import listening
from services.api.service import SceneService


@asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:  # noqa: ARG001
    """The running api; yields the bound port. It owns nothing, so it leaves the store alone."""
    check_exposure(settings.host, settings.api_key)
    stopping = asyncio.Event()
    async with connected(settings) as backends:
        service = SceneService(backends)
        app = create_app(service, settings, stopping)
        async with listening(app, settings.host, settings.port, stopping) as port:
            get_logger("api").info("listening", service="api", address=f"{settings.host}:{port}")
            yield port


if __name__ == "__main__":
    run_alone("api", Settings, serve)
