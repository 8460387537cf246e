"""Whether the service stands, what it counts, and the state of the services it asks."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest

from ovip.errors import Unavailable
from ovip.jsonable import to_json
from services.api.server import models
from services.api.server.parameters import Service

open_router = APIRouter(tags=["system"])
router = APIRouter(tags=["system"])


@open_router.get("/healthz", response_model=models.Health)
async def alive() -> Any:
    """The process answers."""
    return {"status": "ok"}


@open_router.get("/readyz", response_model=models.Ready)
async def ready(service: Service) -> Any:
    """Every service the api asks can be reached; else 503 with the names of those that cannot."""
    reachable = await service.reachable()
    missing = [name for name, there in reachable.items() if not there]
    if missing:
        raise Unavailable(f"not reachable: {', '.join(missing)}; expected all of {', '.join(reachable)}")
    return {"status": "ready", "services": dict(reachable)}


@open_router.get("/metrics", response_class=Response, include_in_schema=False)
async def metrics() -> Response:
    return Response(generate_latest(), media_type=CONTENT_TYPE_LATEST)


@router.get("/status", response_model=models.SystemStatus)
async def get_status(service: Service) -> Any:
    """Which services can be reached, and whether a VLM is configured."""
    status = await service.system_status()
    return {"services": dict(status.reachable), "vlm": to_json(status.gateway)}
