"""Asks a real stack about a place that a simulated robot mapped for it: every service, a store, gRPC between them.

A place is mapped once, into a folder; whoever asks works on the folder or, where asking leaves traces in it (an
active search adds its frames to the scene), on a copy. So no answer depends on which questions came before.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import tempfile
from collections.abc import AsyncIterator, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from lab.evaluation.asking.worlds import PLANNING_RADIUS, ROBOT_RADIUS, Place, WorldSpec, place_of
from lab.simulation.robot import SimulatedRobot
from ovip.client import Addresses, AsyncClient
from ovip.scene.answers import Answer, Observation, Query, Viewpoint
from ovip.scene.types import F64, SceneMap
from ovip.telemetry import configure_logging
from services.standalone.config import Settings
from services.standalone.stack import running_stack

SCENE = "asked"
_LEFT_BEHIND = shutil.ignore_patterns("*.sock", "stack.json", "*.pid")


@dataclass(frozen=True, slots=True)
class Mapped:
    """A place's map on disk. shown: ids of the things that the robot's camera was shown on its walk."""

    spec: WorldSpec
    folder: Path
    shown: tuple[int, ...]
    frames: int
    objects: int


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """How an active search ended. travelled: metres that its robot drove. last: its camera `(4, 4)` at the end.

    looks: `(N, 3)` x, y metres and heading radians of the places it looked from, in order.
    """

    answer: Answer
    travelled: float
    last: F64
    looks: F64


def map_place(spec: WorldSpec, folder: Path) -> Mapped:
    """Maps a place into `folder` by its robot's walk. NotConfigured where the text model is not there."""
    return asyncio.run(_map_place(place_of(spec), folder))


@contextlib.asynccontextmanager
async def stack_over(folder: Path) -> AsyncIterator[AsyncClient]:
    """A stack in this process over a folder, on free ports, for robots that detect on board."""
    configure_logging("error", as_json=False)
    settings = Settings(
        data_dir=folder, redis_url=None, blob_url=None, host="127.0.0.1", api_key=None, free_ports=True
    )
    with _settings(OVIP_MODELS="given"):
        async with running_stack(settings) as stack, AsyncClient(Addresses.of_stack(asdict(stack))) as client:
            yield client


@contextlib.contextmanager
def copy_of(folder: Path) -> Iterator[Path]:
    """A copy of a folder that no stack runs over, gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="ovip-asking-") as home:
        yield Path(shutil.copytree(folder, Path(home) / "data", ignore=_LEFT_BEHIND))


async def find(client: AsyncClient, text: str, pose: F64, max_tier: int = 0) -> Answer:
    """Tiers 1 to 3 for a robot that stands at `pose`, with the plan of tier 4."""
    return await client.find(
        Query(SCENE, text, robot_pose=pose, robot_radius=PLANNING_RADIUS, max_tier=max_tier)
    )


async def search(
    place: Place, client: AsyncClient, text: str, pose: F64, min_tier: int = 0, most: int = 0
) -> Search:
    """A whole search with a robot that begins at `pose`. most: viewpoints it may visit, 0 for the product's own."""
    robot = SimulatedRobot(place.world, client, SCENE, robot_id="seeker", radius=ROBOT_RADIUS)
    robot.pose = pose
    query = Query(
        SCENE, text, robot_pose=pose, robot_radius=PLANNING_RADIUS, min_tier=min_tier, max_viewpoints=most
    )
    looks: list[tuple[float, float, float]] = []

    async def look(viewpoint: Viewpoint) -> Observation:
        seen = await robot.look(viewpoint)
        if not seen.unreachable:
            looks.append((float(robot.pose[0, 3]), float(robot.pose[1, 3]), viewpoint.yaw))
        return seen

    _, answer = await client.search(query, look)
    return Search(answer, robot.travelled, robot.pose, np.array(looks).reshape(-1, 3))


async def the_map(client: AsyncClient) -> SceneMap:
    """The mapped objects."""
    return await client.get_map(SCENE)


async def _map_place(place: Place, folder: Path) -> Mapped:
    async with stack_over(folder) as client:
        robot = SimulatedRobot(place.world, client, SCENE, robot_id="mapper", radius=ROBOT_RADIUS)
        await robot.walk()
        scene_map = await client.wait_until_applied(SCENE)
        await client.regions.recompute(SCENE)
        return Mapped(place.spec, folder, place.world.shown_ids(), robot.walk_length, len(scene_map.objects))


@contextlib.contextmanager
def _settings(**chosen: str) -> Iterator[None]:
    """Settings by environment, for services that are being started."""
    before = {name: os.environ.get(name) for name in chosen}
    os.environ.update(chosen)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
