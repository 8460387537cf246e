"""Two robots in one scene at once, over real gRPC and a real store: one map, no frame lost, and the log proves it."""

from __future__ import annotations

import asyncio

from ovip.clients import MapperClient
from ovip.scene.types import SceneMap
from ovip.store import Store
from services.mapper.__main__ import serve as serve_mapper
from services.mapper.config import Settings as MapperSettings
from tests.builders import hello
from tests.integration.test_perception_stream import (
    SCENE,
    channel_to,
    detections_in,
    models,
    perception_on,
    processed,
    send,
)
from tests.unit.services.perception.painted import K, painted

__all__ = ["models"]  # the painted world's models stand behind the seams here, too

MAPPER = MapperSettings(_env_file=None, mapper_port=0, api_key=None, snapshot_every=5, upkeep_every=4)
FRAMES = 12


async def test_two_robots_stream_at_once_and_both_see_one_map(store: Store) -> None:
    ada = [painted(n, "cup", "chair") for n in range(1, FRAMES + 1)]
    bob = [painted(n, "cup", "table") for n in range(1, FRAMES + 1)]
    async with perception_on(store) as port, serve_mapper(MAPPER, store) as mapper_port:
        reports = await asyncio.gather(
            send(port, ada, hello(SCENE, robot="ada", k=K)), send(port, bob, hello(SCENE, robot="bob", k=K))
        )
        newest = (await processed(port)).newest_detections_id
        async with channel_to(mapper_port) as first, channel_to(mapper_port) as second:
            seen = await _map_at(MapperClient(first), newest)
            also = await _map_at(MapperClient(second), newest)
            proof = await MapperClient(first).verify(SCENE)

    assert [report.durable for report in reports] == [FRAMES, FRAMES]
    assert (seen.version, seen.state_hash) == (also.version, also.state_hash)
    assert sorted((o.label, o.frames) for o in seen.objects) == [
        ("chair", FRAMES),
        ("cup", 2 * FRAMES),
        ("table", FRAMES),
    ]
    batches = await detections_in(store)
    mapped = {batch.frame_id for batch in batches if not batch.late}
    assert mapped == {f"{robot}.s1.{n:08d}" for robot in ("ada", "bob") for n in range(1, FRAMES + 1)}
    assert seen.frames == 2 * FRAMES
    assert proof.holds


async def _map_at(mapper: MapperClient, log_id: str) -> SceneMap:
    """The map once it has seen a log entry and has nothing left to keep up."""
    async with asyncio.timeout(30):
        before = await mapper.get_map(SCENE)
        while True:
            await asyncio.sleep(0.3)
            seen = await mapper.get_map(SCENE)
            if seen.applied_log_id == log_id and seen.version == before.version:
                return seen
            before = seen
