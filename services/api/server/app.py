"""The whole REST interface and the dashboard as one ASGI application."""

from __future__ import annotations

import asyncio
from pathlib import Path

from fastapi import APIRouter, Depends, FastAPI
from fastapi.staticfiles import StaticFiles
from starlette.responses import FileResponse, Response
from starlette.types import Scope

from services.api.config import Settings
from services.api.server import (
    event_routes,
    export_routes,
    frame_routes,
    map_routes,
    navigation_routes,
    query_routes,
    system_routes,
)
from services.api.server.auth import key_check
from services.api.server.observing import Observing
from services.api.server.parameters import PROBLEMS
from services.api.server.problems import install_problem_handlers
from services.api.service import SceneService

_STATIC = Path(__file__).parent.parent / "static"
_ABOUT = """Where things are, by question and by map. Calls below /v1 need the stack's key where one is set.

Errors are problem details (RFC 9457). Objects, regions and the graph carry an ETag. `frame=source`
reports (and reads) positions in the recording's own frame instead of the z-up world."""


def create_app(service: SceneService, settings: Settings, stopping: asyncio.Event) -> FastAPI:
    """The application; event streams end when `stopping` is set."""
    app = FastAPI(title="OVIP-SG", version="1", description=_ABOUT, docs_url=None, redoc_url=None)
    app.state.service = service
    app.state.settings = settings
    app.state.stopping = stopping
    install_problem_handlers(app)
    app.add_middleware(Observing)
    app.include_router(system_routes.open_router, responses=PROBLEMS)
    app.include_router(_v1(settings))
    app.add_api_route("/", _index, include_in_schema=False)
    app.mount("/static", _Static(directory=_STATIC), name="static")
    return app


def _v1(settings: Settings) -> APIRouter:
    v1 = APIRouter(prefix="/v1", dependencies=[Depends(key_check(settings.api_key))], responses=PROBLEMS)
    for routes in (
        map_routes,
        navigation_routes,
        frame_routes,
        query_routes,
        event_routes,
        export_routes,
        system_routes,
    ):
        v1.include_router(routes.router)
    return v1


async def _index() -> Response:
    return FileResponse(_STATIC / "index.html", headers={"Cache-Control": "no-cache"})


class _Static(StaticFiles):
    """Files of the page, checked by ETag each time, so that a new version shows at once."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        return response
