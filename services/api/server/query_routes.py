"""Questions, their answers, and searches as retrieval keeps them."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import aclosing
from typing import Any

import numpy as np
from fastapi import APIRouter, Request

from ovip.answer_json import OutputFrame, answer_to_json, event_to_json
from ovip.scene.answers import Query, SearchEvent
from ovip.scene.camera import check_pose
from services.api.server import models
from services.api.server.parameters import InFrame, Scene, Service
from services.api.server.sse import MEDIA_TYPE, Event, event_stream
from services.api.service import FrameName

router = APIRouter(tags=["queries"])


@router.post(
    "/scenes/{scene}/queries",
    response_model=models.Answer,
    responses={
        200: {
            "description": "The answer; or, where text/event-stream is accepted, the events of the search as "
            "they happen: tier_started, tier_finished, viewpoint, then answer (or problem).",
            "content": {MEDIA_TYPE: {"schema": {"type": "string"}}},
        }
    },
)
async def ask(
    scene: Scene, body: models.QueryBody, service: Service, request: Request, frame: InFrame = FrameName.WORLD
) -> Any:
    """Asks where something is, in four tiers, the cheapest first."""
    shown = await service.output_frame(scene, frame)
    query = _query(scene, body, shown)
    if MEDIA_TYPE not in request.headers.get("accept", ""):
        search_id, answer = await service.answer(query)
        return answer_to_json(answer, search_id, shown.world_from_source)
    events = service.find(query)
    first = await anext(events)
    return event_stream(
        _named(first, events, shown), request.app.state.stopping, request.app.state.settings.api_heartbeat_s
    )


@router.get("/scenes/{scene}/searches/{search_id}", response_model=models.Search)
async def get_search(scene: Scene, search_id: str, service: Service, frame: InFrame = FrameName.WORLD) -> Any:
    """A search asked earlier, done or not."""
    shown = await service.output_frame(scene, frame)
    text, done, answer = await service.search(scene, search_id)
    return {
        "search_id": search_id,
        "text": text,
        "done": done,
        "answer": answer and answer_to_json(answer, search_id, shown.world_from_source),
    }


def _query(scene: str, body: models.QueryBody, frame: OutputFrame) -> Query:
    robot = body.robot or models.RobotBody()
    return Query(
        scene=scene,
        text=body.text,
        robot_pose=None if robot.pose is None else frame.world_pose(check_pose(np.array(robot.pose))),
        robot_radius=robot.radius or 0.0,
        region_hint=body.region_hint,
        min_tier=body.min_tier or 0,
        max_tier=body.max_tier or 0,
        max_vlm_calls=body.max_vlm_calls or 0,
        max_viewpoints=body.max_viewpoints or 0,
    )


async def _named(
    first: tuple[str, SearchEvent], rest: AsyncGenerator[tuple[str, SearchEvent]], frame: OutputFrame
) -> AsyncGenerator[Event]:
    """Search events under the names they have on the wire. The first was awaited for its error's sake."""
    async with aclosing(rest):
        yield _event(first, frame)
        async for pair in rest:
            yield _event(pair, frame)


def _event(pair: tuple[str, SearchEvent], frame: OutputFrame) -> Event:
    search_id, event = pair
    return Event(*event_to_json(event, search_id, frame.world_from_source))
