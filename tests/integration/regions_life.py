"""What the tests of regions share: a scene that is explored step by step, and what a follower makes of its logs.

The steps are a robot's frames in two rooms, and objects that come, move and go. The map is a function of how
many of its versions are in the log, so that any process can ask for it at any time.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass, replace

import numpy as np

from ovip.codec import encode_delta, encode_detection_batch
from ovip.scene.types import F32, DetectionBatch, MapDelta, MapObject, Partition, RegionEventKind, SceneMap
from ovip.store import Append, Store
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.pace import PaceParams
from services.regions.domain.partition import PartitionParams
from services.regions.domain.staleness import StalenessParams
from services.regions.follower import RegionsFollower
from services.regions.partitioner import CutParams
from services.regions.shelf import Shelf
from tests.unit.services.regions.homes import CAMERA, SCENE, WordsAreFunctions, left_room, mapped, right_room

FRAMES = 26
EAGER = PaceParams(quiet_s=0.02, min_interval_s=0.0)


@dataclass(frozen=True, slots=True)
class Version:
    """One version of the map, and what it changed."""

    objects: tuple[MapObject, ...]
    delta: MapDelta


def versions() -> list[Version]:
    """A map's life, version 1 first: objects come one by one, then one moves, one is renamed and one goes."""
    places = [("kitchen", 0.5, 0.5), ("kitchen", 3.5, 0.6), ("bedroom", 7.5, 3.5), ("bedroom", 5.0, 3.4)]
    objects: tuple[MapObject, ...] = ()
    made = []
    for number, (word, x, y) in enumerate(places):
        objects = (*objects, mapped(f"o{number}", word, x, y))
        made.append(Version(objects, MapDelta(len(made) + 1, "", created=(f"o{number}",))))
    objects = (replace(objects[0], centroid=np.array([1.5, 3.0, 0.5])), *objects[1:])
    made.append(Version(objects, MapDelta(len(made) + 1, "", updated=("o0",))))
    objects = (*objects[:3], replace(objects[3], label="study"))
    made.append(Version(objects, MapDelta(len(made) + 1, "", updated=("o3",))))
    objects = (objects[0], *objects[2:])
    made.append(Version(objects, MapDelta(len(made) + 1, "", removed=("o1",))))
    return made


VERSIONS = versions()
STEPS = [
    step
    for n in range(FRAMES)
    for step in (("frame", n), ("version", n // 3 - 2))
    if step[0] == "frame" or (n % 3 == 0 and n >= 6)
]
"""Frames, and after every third from the seventh on a version of the map."""


def frame(number: int) -> DetectionBatch:
    """A frame of perception: the robot looks at a part of the left room first, of the right room later."""
    right = number >= FRAMES // 2
    cloud: F32 = (right_room() if right else left_room())[number % 12 :: 12]
    pose = np.eye(4)
    pose[:3, 3] = (6.0 if right else 2.0, 2.0, 1.2)
    return DetectionBatch(f"f{number:02d}", number, CAMERA, pose, (), cloud)


class MapOfLog:
    """The map as far as its log goes; counts how often it was asked for."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self.asked = 0

    async def get_map(self, scene: str) -> SceneMap:
        self.asked += 1
        version = await self._store.length(scene, "map")
        objects = VERSIONS[version - 1].objects if version else ()
        return SceneMap(scene, version, objects, "hash", 0, 0, "0-0")


async def take_step(store: Store, number: int) -> None:
    """What perception or the mapper does at a step; again changes nothing."""
    kind, which = STEPS[number]
    if kind == "frame":
        batch = await store.blobs.put(encode_detection_batch(frame(which)))
        await _append(store, "perception", "detections", which, {"kind": "frame", "batch": batch})
    else:
        delta = encode_delta(VERSIONS[which].delta)
        await _append(store, "mapper", "map", which, {"kind": "frame", "delta": delta})


async def _append(
    store: Store, stage: str, stream: str, which: int, fields: dict[str, bytes | str | int]
) -> None:
    lease = None
    while lease is None:  # a process that was killed may hold it a moment longer
        lease = await store.acquire_lease(SCENE, stage, "test", 0.1)
        await asyncio.sleep(0 if lease else 0.02)
    await store.commit(lease, f"{which + 1}-0", [Append(stream, fields)])


def a_follower(store: Store, pace: PaceParams = EAGER, checkpoint: int = 3) -> RegionsFollower:
    params = CutParams(PartitionParams(), StalenessParams())
    return RegionsFollower(store, MapOfLog(store), (WordsAreFunctions(),), pace, params, checkpoint)


@contextlib.asynccontextmanager
async def following(follower: RegionsFollower) -> AsyncIterator[asyncio.Task[None]]:
    task = asyncio.create_task(follower.follow(SCENE))
    try:
        yield task
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def until(condition: Callable[[], Awaitable[bool]], seconds: float = 30.0) -> None:
    async with asyncio.timeout(seconds):
        while not await condition():
            await asyncio.sleep(0.02)


def evidence_of_all() -> FloorEvidence:
    """What all frames say, by the domain alone."""
    evidence = FloorEvidence()
    for number in range(FRAMES):
        batch = frame(number)
        evidence.add(batch.frame_id, batch.surface, batch.world_from_camera[:3, 3])
    return evidence


async def partitions_in(store: Store) -> list[Partition]:
    """All that were published, oldest first."""
    shelf = Shelf(store)
    entries = await store.read(SCENE, "regions", count=1000)
    return [await shelf._partition(entry.fields["partition"].decode()) for entry in entries]


async def told_in(store: Store) -> list[tuple[str, str]]:
    """Kinds and regions of all events of the regions log."""
    entries = await store.read(SCENE, "regions", count=1000)
    return [
        (event["kind"], event["region_id"])
        for entry in entries
        for event in json.loads(entry.fields["events"])
    ]


def alive_after(told: list[tuple[str, str]]) -> set[str]:
    """The regions there are by their events alone; each appears once and vanishes at most once."""
    alive: set[str] = set()
    ever: set[str] = set()
    for kind, region_id in told:
        if kind == RegionEventKind.APPEARED:
            assert region_id not in ever
            alive.add(region_id)
            ever.add(region_id)
        elif kind == RegionEventKind.VANISHED:
            alive.remove(region_id)
        else:
            assert region_id in alive
    return alive
