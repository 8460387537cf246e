"""Ways through a scene: the shortest route between two places, and the graph of its passages."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query

from ovip.answer_json import OutputFrame
from ovip.errors import InvalidInput
from ovip.scene.types import F64
from services.api.domain.route_json import route_graph_to_json, route_to_json
from services.api.server import models
from services.api.server.parameters import InFrame, KnownScene, Service
from services.api.service import FrameName

router = APIRouter(tags=["navigation"])
Radius = Annotated[
    float, Query(ge=0, le=2, description="of the robot, metres; 0: the setting of the regions service")
]


@router.get("/scenes/{scene}/route", response_model=models.Route)
async def plan_route(
    known: KnownScene,
    service: Service,
    start: Annotated[str, Query(alias="from", max_length=200, examples=["1.0,2.5,0"])],
    goal: Annotated[str, Query(alias="to", max_length=200, examples=["6.2,1.1,2.8"])],
    radius: Radius = 0.0,
    frame: InFrame = FrameName.WORLD,
) -> Any:
    """The shortest way between two points x,y,z for a robot, around furniture, through doorways, over stairs.

    No way is no error: the path is empty and `why` says what is missing. The ends need not be places to stand
    on: each moves to floor at most 2 m away.
    """
    shown = await service.output_frame(known.scene, frame)
    ends = _point("from", start, shown), _point("to", goal, shown)
    return route_to_json(await service.route(known.scene, *ends, radius), shown)


@router.get("/scenes/{scene}/route-graph", response_model=models.RouteGraph)
async def get_route_graph(
    known: KnownScene, service: Service, radius: Radius = 0.0, frame: InFrame = FrameName.WORLD
) -> Any:
    """Doorways, openings and stairs that the robot fits through, with the metres walked between those of one
    region.
    """
    shown = await service.output_frame(known.scene, frame)
    return route_graph_to_json(await service.route_graph(known.scene, radius), shown)


def _point(name: str, text: str, frame: OutputFrame) -> F64:
    """World point `(3,)` of "x,y,z" metres in the caller's frame; InvalidInput for anything else."""
    try:
        point = np.array([float(part) for part in text.split(",")])
    except ValueError:
        point = np.zeros(0)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InvalidInput(f"{name}: expected three numbers x,y,z in metres, got {text[:80]!r}")
    pose = np.eye(4)
    pose[:3, 3] = point
    return frame.world_pose(pose)[:3, 3]
