"""Regions beside a real mapper and beside other replicas, as processes that come and go."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ovip.clients import MapperClient, RegionsClient, connect
from ovip.scene.edits import Delete, EditRequest
from ovip.scene.types import F32, DetectionBatch
from ovip.store import Store
from services.mapper.__main__ import serve as serve_mapper
from services.regions.__main__ import serve
from services.regions.config import Settings
from services.regions.shelf import Shelf
from tests.builders import axis, batch, detection
from tests.integration.mappers import SETTINGS as MAPPER
from tests.integration.mappers import write
from tests.integration.regions_life import alive_after, partitions_in, told_in, until
from tests.unit.services.regions.homes import SCENE, left_room, right_room

ROOT = Path(__file__).resolve().parents[2]
NOWHERE = "127.0.0.1:9"
REPLICA = """
import asyncio, sys
from pathlib import Path
from ovip import stages
from ovip.store import Store
from services.regions.__main__ import serve
from tests.builders import kernel_settings
from tests.integration.test_regions_service import settings

stages.LEASE_SECONDS = 0.6

async def live() -> None:
    data_dir, url, mapper = sys.argv[1:]
    store = await Store.connect(kernel_settings(Path(data_dir), redis_url=url))
    async with serve(settings(Path(data_dir), mapper), store) as port:
        print("up", port, flush=True)
        await asyncio.Event().wait()

asyncio.run(live())
"""


def settings(data_dir: Path, mapper: str) -> Settings:
    return Settings(
        _env_file=None,
        data_dir=data_dir,
        api_key=None,
        regions_port=0,
        mapper_address=mapper,
        perception_address=NOWHERE,
        vlm_gateway_address=NOWHERE,
        regions_quiet_s=0.2,
        regions_min_interval_s=0.2,
    )


def look(number: int, room: F32, x: float) -> DetectionBatch:
    """A frame from the middle of a room, with a stove in the left room's corner and a bed in the right room's."""
    pose = np.eye(4)
    pose[:3, 3] = (x, 2.0, 1.2)
    things = (
        detection("stove", (0.3, 0.3, 0.0), (0.8, 0.8, 0.9), feature=axis(0)),
        detection("bed", (6.5, 2.5, 0.0), (8.0, 3.9, 0.5), feature=axis(1)),
    )
    thing = things[x > 4.0]
    return replace(batch(number, thing), surface=room, world_from_camera=pose)


WALK = [look(n, left_room(), 2.0) for n in (1, 2, 3)] + [look(n, right_room(), 6.0) for n in (4, 5, 6)]


@contextlib.asynccontextmanager
async def regions_on(store: Store, tmp_path: Path, mapper: str) -> AsyncIterator[RegionsClient]:
    async with serve(settings(tmp_path, mapper), store) as port, connect(f"127.0.0.1:{port}") as channel:
        yield RegionsClient(channel)


async def labels_by_function(mapper: MapperClient, regions: RegionsClient) -> dict[str, list[str]]:
    labels = {o.object_id: o.label for o in (await mapper.get_map(SCENE)).objects}
    partition = await regions.get_partition(SCENE)
    return {r.function: [labels.get(name, "gone") for name in r.object_ids] for r in partition.regions}


async def test_the_mappers_objects_are_in_regions_and_one_that_is_deleted_leaves_its_region(
    store: Store, tmp_path: Path
) -> None:
    await write(store, WALK, SCENE)
    async with serve_mapper(MAPPER, store) as port, connect(f"127.0.0.1:{port}") as channel:
        mapper = MapperClient(channel)
        async with regions_on(store, tmp_path, f"127.0.0.1:{port}") as regions:
            both = {"kitchen": ["stove"], "bedroom": ["bed"]}
            await until(lambda: _is(both, mapper, regions))
            seen = await mapper.get_map(SCENE)
            (stove,) = [o.object_id for o in seen.objects if o.label == "stove"]
            await mapper.edit(SCENE, EditRequest("e1", seen.version, "test", Delete(stove)))
            await until(lambda: _is({"unknown": [], "bedroom": ["bed"]}, mapper, regions))
            partition = await regions.get_partition(SCENE)
            assert partition.map_version <= (await mapper.get_map(SCENE)).version
            assert [r.region_id for r in partition.regions] == ["r1", "r2"]


async def test_while_the_mapper_is_down_frames_are_gathered_and_the_partition_waits_for_it(
    store: Store, tmp_path: Path
) -> None:
    async with serve_mapper(MAPPER, store) as port:  # where it will be again
        pass
    await write(store, WALK, SCENE)
    async with regions_on(store, tmp_path, f"127.0.0.1:{port}") as regions:
        await until(lambda: _has_gathered(store, len(WALK)))
        assert (await regions.get_partition(SCENE)).revision == 0
        back = MAPPER.model_copy(update={"mapper_port": port})
        async with serve_mapper(back, store), connect(f"127.0.0.1:{port}") as channel:
            await until(
                lambda: _is({"kitchen": ["stove"], "bedroom": ["bed"]}, MapperClient(channel), regions)
            )
    assert [p.revision for p in await partitions_in(store)][:1] == [1]


async def test_of_two_replicas_one_follows_and_the_other_takes_over_where_it_was_killed(
    store: Store, tmp_path: Path
) -> None:
    await store.add_scene(SCENE)
    async with serve_mapper(MAPPER, store) as mapper_port:
        address = f"127.0.0.1:{mapper_port}"
        with (
            replica(store, tmp_path, address) as (one, first),
            replica(store, tmp_path, address) as (_, second),
        ):
            await write(store, WALK[:3], SCENE)
            async with connect(f"127.0.0.1:{first}") as a, connect(f"127.0.0.1:{second}") as b:
                await until(lambda: _revision_is(store, 1))
                assert await _same_partition(RegionsClient(a), RegionsClient(b))
            os.kill(one, signal.SIGKILL)
            await write(store, WALK[3:], SCENE)
            async with connect(f"127.0.0.1:{second}") as b:
                await until(lambda: _functions_are(RegionsClient(b), {"kitchen", "bedroom"}))
    published = await partitions_in(store)
    assert [p.revision for p in published] == list(range(1, len(published) + 1))
    assert alive_after(await told_in(store)) == {r.region_id for r in published[-1].regions}


@contextlib.contextmanager
def replica(store: Store, data_dir: Path, mapper: str) -> Iterator[tuple[int, int]]:
    """A process of regions on the same store: its process id and its port."""
    assert store._server is not None
    url = f"unix://{store._server.socket}"
    started = subprocess.Popen(
        [sys.executable, "-c", REPLICA, str(data_dir / "data"), url, mapper],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert started.stdout
    try:
        port = next(int(line.split()[1]) for line in started.stdout if line.startswith("up"))
        yield started.pid, port
    finally:
        started.kill()
        started.wait(10)
        started.stdout.close()


async def _is(expected: dict[str, list[str]], mapper: MapperClient, regions: RegionsClient) -> bool:
    return await labels_by_function(mapper, regions) == expected


async def _has_gathered(store: Store, frames: int) -> bool:
    return (await Shelf(store).gathered(SCENE)).evidence.revision == frames


async def _revision_is(store: Store, revision: int) -> bool:
    return (await Shelf(store).partition(SCENE)).revision >= revision


async def _functions_are(regions: RegionsClient, functions: set[str]) -> bool:
    await asyncio.sleep(0.05)
    return {r.function for r in (await regions.get_partition(SCENE)).regions} == functions


async def _same_partition(a: RegionsClient, b: RegionsClient) -> bool:
    one, two = await asyncio.gather(a.get_partition(SCENE), b.get_partition(SCENE))
    return abs(one.revision - two.revision) <= 1 and min(one.revision, two.revision) >= 1
