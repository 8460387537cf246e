"""What the mapper's tests share: a log to map, a mapper over it, and the map that the domain alone makes of it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Sequence

import numpy as np

from ovip.clients import MapperClient, connect
from ovip.codec import encode_detection_batch
from ovip.scene.edits import Delete, EditRequest, Pin, Rename
from ovip.scene.types import F64, DetectionBatch, MapDelta, SceneMap
from ovip.store import Append, Store
from services.mapper.__main__ import serve
from services.mapper.config import Settings
from services.mapper.domain.object_map import ObjectMap
from services.mapper.service import Mapper
from tests.builders import random_run

SCENE, OTHER = "kitchen", "attic"
SETTINGS = Settings(
    _env_file=None, mapper_port=0, api_key=None, snapshot_every=4, upkeep_every=3, confirm_frames=2
)
OTHER_SETTINGS = SETTINGS.model_copy(update={"confirm_frames": 3, "upkeep_every": 4, "tau": 0.9})
RUN = random_run(7, 20)


async def write(store: Store, batches: Sequence[DetectionBatch], scene: str = SCENE) -> str:
    """What perception does: appends batches to the detections log; returns the id of the last."""
    await store.add_scene(scene)
    lease = await store.acquire_lease(scene, "perception", "test", 30)
    assert lease is not None
    at = int((await store.cursor(scene, "perception")).partition("-")[0])
    newest = ""
    for n, one in enumerate(batches, at + 1):
        ref = await store.blobs.put(encode_detection_batch(one))
        fields = {"frame_id": one.frame_id, "batch": ref, "kind": "frame"}
        newest = (await store.commit(lease, f"{n}-0", [Append("detections", fields)])).ids[0]
    return newest


@contextlib.asynccontextmanager
async def mapper_on(store: Store, settings: Settings = SETTINGS) -> AsyncIterator[MapperClient]:
    """A mapper that serves and follows; yields a client of it."""
    async with serve(settings, store) as port:
        channel = connect(f"127.0.0.1:{port}")
        try:
            yield MapperClient(channel)
        finally:
            await channel.close()


async def map_at(
    mapper: MapperClient, log_id: str, scene: str = SCENE, unconfirmed: bool = False
) -> SceneMap:
    """The map once it has seen a log entry."""
    async with asyncio.timeout(20):
        while True:
            current = await mapper.get_map(scene, unconfirmed)
            if current.applied_log_id == log_id:
                return current
            await asyncio.sleep(0.02)


def made_of(
    batches: Sequence[DetectionBatch], settings: Settings = SETTINGS
) -> tuple[ObjectMap, list[MapDelta]]:
    """The map that the batches make by the domain alone, and its versions: settings, frames, upkeep when it is due."""
    made = ObjectMap()
    deltas = [made.adopt(settings.map_params())]
    for one in batches:
        deltas.append(made.integrate(one))
        if made.upkeep_due:
            deltas.append(made.upkeep())
    return made, deltas


def expected(batches: Sequence[DetectionBatch]) -> ObjectMap:
    """The map that the batches make, by the domain alone."""
    return made_of(batches)[0]


def a_mapper(store: Store, settings: Settings = SETTINGS, **more: float) -> Mapper:
    """A mapper as a replica has one: reads and edits, follows only where asked to."""
    return Mapper(store, settings.map_params(), settings.snapshot_every, **more)


@contextlib.asynccontextmanager
async def following(
    store: Store, settings: Settings = SETTINGS, scenes: Sequence[str] = (SCENE,), **more: float
) -> AsyncIterator[Mapper]:
    """A mapper that writes scenes' maps, called directly."""
    mapper = a_mapper(store, settings, **more)
    tasks = [asyncio.create_task(mapper.follow(scene)) for scene in scenes]
    try:
        yield mapper
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.wait(tasks)


async def a_life(store: Store) -> SceneMap:
    """A map with steps of every kind: frames and upkeep, edits, another scene joined, other settings, frames again."""
    newest, there = await write(store, RUN[:10]), await write(store, random_run(11, 8), OTHER)
    async with following(store, scenes=(SCENE, OTHER)) as mapper:
        await applied(mapper, there, OTHER)
        seen = await applied(mapper, newest)
        names = [o.object_id for o in seen.objects]
        for number, edit in enumerate((Rename(names[0], "teapot"), Pin(names[1]), Delete(names[2]))):
            await mapper.edit(SCENE, EditRequest(f"e{number}", seen.version, "test", edit))
        await mapper.join(SCENE, OTHER, shifted(5.0), "j0")
    newest = await write(store, RUN[10:])
    async with following(store, OTHER_SETTINGS) as mapper:
        return await applied(mapper, newest)


def shifted(x: float) -> F64:
    """A rigid `(4, 4)` that moves everything `x` metres along x."""
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


async def applied(mapper: Mapper, log_id: str, scene: str = SCENE) -> SceneMap:
    """The map once it has seen a log entry, everything of it."""
    async with asyncio.timeout(20):
        while True:
            current = await mapper.get_map(scene, include_unconfirmed=True, include_departed=True)
            if current.applied_log_id == log_id:
                return current
            await asyncio.sleep(0.01)


async def versions_in(store: Store, scene: str = SCENE) -> list[int]:
    return [int(e.fields["version"]) for e in await store.read(scene, "map", count=10_000)]
