"""A follower's process killed -9 again and again: the same evidence, the same regions, each event told once."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
import signal
import subprocess
import sys
from collections.abc import Coroutine, Iterator
from pathlib import Path
from typing import Any

import pytest

from ovip.scene.types import Partition
from ovip.store import Store
from services.regions.service import Regions
from services.regions.shelf import STAGE, Shelf
from tests.builders import kernel_settings
from tests.integration.regions_life import (
    STEPS,
    a_follower,
    alive_after,
    evidence_of_all,
    following,
    partitions_in,
    take_step,
    told_in,
    until,
)
from tests.unit.services.regions.homes import SCENE

ROOT = Path(__file__).resolve().parents[2]

# perception's and the mapper's part too; what is written is in the cursors of their stages
PROCESS = """
import asyncio, sys
from pathlib import Path
from ovip import stages
from ovip.store import Store
from tests.builders import kernel_settings
from tests.integration.regions_life import STEPS, a_follower, following, take_step
from tests.unit.services.regions.homes import SCENE

stages.LEASE_SECONDS = 0.4

async def live() -> None:
    store = await Store.connect(kernel_settings(Path(sys.argv[1])))
    await store.add_scene(SCENE)
    done = await store.length(SCENE, "detections") + await store.length(SCENE, "map")
    async with following(a_follower(store)) as task:
        print("up", flush=True)
        for number in range(done, len(STEPS)):
            await take_step(store, number)
            await asyncio.sleep(0.05)
            print("step", flush=True)
        print("done", flush=True)
        await task

asyncio.run(live())
"""


@contextlib.contextmanager
def process(data_dir: Path) -> Iterator[subprocess.Popen[str]]:
    started = subprocess.Popen(
        [sys.executable, "-c", PROCESS, str(data_dir)], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    try:
        yield started
    finally:
        started.kill()
        started.wait(10)
        assert started.stdout
        started.stdout.close()


def killed_after(data_dir: Path, steps: int) -> None:
    """Runs the process until it has taken so many steps more, then kills it whatever it does."""
    with process(data_dir) as running:
        assert running.stdout
        seen = 0
        for line in running.stdout:
            seen += line.startswith("step")
            if seen >= steps or line.startswith("done"):
                break
        os.kill(running.pid, signal.SIGKILL)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Partition:
    """What comes of it where nobody dies."""

    async def live() -> Partition:
        store = await Store.connect(kernel_settings(tmp_path_factory.mktemp("undisturbed")))
        try:
            await store.add_scene(SCENE)
            for number in range(len(STEPS)):
                await take_step(store, number)
            async with following(a_follower(store)):
                return await Regions(store, 30.0).recompute(SCENE)
        finally:
            await store.close()

    return asyncio.run(live())


def content(partition: Partition) -> list[tuple[object, ...]]:
    """A partition but for its numbers and ids, which tell of its past."""
    return sorted(
        (r.function, r.area, r.object_ids, r.frame_ids, r.seen_by, r.outlines[0].tobytes())
        for r in partition.regions
    )


@pytest.mark.parametrize("seed", [1, 2])
async def test_a_follower_killed_again_and_again_ends_where_an_undisturbed_one_does(
    tmp_path: Path, undisturbed: Partition, seed: int
) -> None:
    kills = random.Random(seed)
    for _ in range(2):
        killed_after(tmp_path / "killed", kills.randint(4, 10))

    store = await Store.connect(kernel_settings(tmp_path / "killed"))
    try:
        for number in range(len(STEPS)):
            await take_step(store, number)
        await _ends_like(undisturbed, store)
    finally:
        await store.close()


class Died(BaseException):
    """What stands for the end of a process."""


class DyingStore:
    """A store over which a process dies at its n-th write, blobs and commits alike: before it is done, or after."""

    def __init__(self, store: Store, at: int, after: bool) -> None:
        self._store, self._left, self._after = store, at, after
        self.blobs = self

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    async def get(self, ref: str) -> bytes:
        return await self._store.blobs.get(ref)

    async def put(self, data: bytes) -> str:
        return await self._write(self._store.blobs.put(data))

    async def commit(self, *words: Any) -> Any:
        return await self._write(self._store.commit(*words))

    async def _write(self, writing: Coroutine[Any, Any, Any]) -> Any:
        self._left -= 1
        if self._left < 0 or (self._left == 0 and not self._after):
            writing.close()
            raise Died
        done = await writing
        if self._left == 0:
            raise Died
        return done


@pytest.mark.parametrize("after", [False, True])
async def test_a_follower_may_die_at_any_write_it_makes(
    store: Store, undisturbed: Partition, after: bool
) -> None:
    await store.add_scene(SCENE)
    died = 0
    for number in range(len(STEPS)):
        await take_step(store, number)
        if number % 2:
            continue
        dying: Any = DyingStore(store, 1 + number // 2 % 7, after)
        task = asyncio.create_task(a_follower(dying).follow(SCENE))
        await asyncio.wait([task], timeout=0.5)
        task.cancel()
        (outcome,) = await asyncio.gather(task, return_exceptions=True)
        died += isinstance(outcome, Died)
    await _ends_like(undisturbed, store)
    assert died > 7


async def _ends_like(undisturbed: Partition, store: Store) -> None:
    async with following(a_follower(store)):
        ended = await Regions(store, 30.0).recompute(SCENE)
        await until(lambda: _all_is_kept(store))
    published = await partitions_in(store)
    gathered = await Shelf(store).gathered(SCENE)
    told = await told_in(store)

    assert content(ended) == content(undisturbed)
    assert [p.revision for p in published] == list(range(1, len(published) + 1))
    assert len(published) > 1
    assert told == [(event.kind, event.region_id) for p in published for event in p.events]
    assert alive_after(told) == {r.region_id for r in ended.regions}
    assert gathered.evidence.to_bytes() == evidence_of_all().to_bytes()
    assert await store.cursor(SCENE, STAGE) == f"{await Shelf(store).step(SCENE)}-0"


async def _all_is_kept(store: Store) -> bool:
    return (await Shelf(store).gathered(SCENE)).after == (await store.newest(SCENE, "detections"))[0].id
