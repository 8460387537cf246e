"""What routes are given: the service, a scene's name, a page, a frame of reference."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Path, Query, Request

from ovip.scene.answers import SceneSummary
from services.api.server.models import Problem
from services.api.service import FrameName, SceneService

Responses = dict[int | str, dict[str, Any]]
Scene = Annotated[
    str,
    Path(
        description="name of the scene: letters, digits, '_' or '-'",
        pattern="^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$",
        examples=["kitchen"],
    ),
]
FrameId = Annotated[str, Path(description="robot.session.sequence", pattern="^[A-Za-z0-9._-]{1,256}$")]
InFrame = Annotated[FrameName, Query(alias="frame", description="frame of reference of all positions")]
Cursor = Annotated[str | None, Query(description="next_cursor of the page before")]
Limit = Annotated[int, Query(ge=1, le=1000, description="most items in the page")]
OneFloor = Annotated[int | None, Query(ge=0, alias="floor", description="only this floor; none: all")]
FloorNumber = Annotated[int, Path(ge=0, description="number of the floor, 0 the lowest")]

PROBLEMS: Responses = {
    "4XX": {"model": Problem, "description": "what was wrong with the request"},
    "5XX": {"model": Problem, "description": "what did not work on our side"},
}


def _service(request: Request) -> SceneService:
    service: SceneService = request.app.state.service
    return service


Service = Annotated[SceneService, Depends(_service)]


async def _summary(scene: Scene, service: Service) -> SceneSummary:
    return await service.summary(scene)


KnownScene = Annotated[SceneSummary, Depends(_summary)]
