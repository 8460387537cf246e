"""The mapper over real gRPC on a real store: one log, one map, whoever reads or writes it and however often."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from ovip.clients import MapperClient
from ovip.errors import InvalidInput, NotFound
from ovip.scene.types import DetectionBatch, MapDelta, StepKind
from ovip.store import Store
from services.mapper.domain.object_map import ObjectMap
from services.mapper.service import STAGE
from tests.builders import axis, batch, detection
from tests.integration.mappers import (
    RUN,
    SCENE,
    SETTINGS,
    a_mapper,
    expected,
    made_of,
    map_at,
    mapper_on,
    versions_in,
    write,
)

ROOT = Path(__file__).resolve().parents[2]
VERSIONS = [delta.version for delta in made_of(RUN)[1]]


# One log, one map


async def test_the_log_becomes_the_map_that_the_domain_makes_of_it(store: Store) -> None:
    newest = await write(store, RUN)

    async with mapper_on(store) as mapper:
        seen = await map_at(mapper, newest)

    made = expected(RUN)
    assert seen.state_hash == made.state_hash()
    assert (seen.version, seen.frames, seen.detections) == (made.version, made.frames, made.detections)
    assert [o.object_id for o in seen.objects] == [o.object_id for o in made.objects()]
    assert await versions_in(store) == VERSIONS


async def test_a_second_reader_makes_the_same_map_of_the_same_log(store: Store) -> None:
    newest = await write(store, RUN)
    async with mapper_on(store) as mapper:
        await map_at(mapper, newest)

    reader = a_mapper(store)

    assert (await reader.get_map(SCENE, False)).state_hash == expected(RUN).state_hash()


READER = """
import asyncio, json, sys
from pathlib import Path
from ovip.config import KernelSettings
from ovip.store import Store
from services.mapper.config import Settings
from services.mapper.service import Mapper

async def read() -> None:
    url, blobs, snapshot_every = sys.argv[1:4]
    store = await Store.connect(KernelSettings(_env_file=None, redis_url=url, blob_url=blobs, data_dir=Path(blobs[7:])))
    settings = Settings(_env_file=None, snapshot_every=snapshot_every, upkeep_every=3, confirm_frames=2)
    seen = await Mapper(store, settings.map_params(), settings.snapshot_every).get_map("kitchen", False)
    print(json.dumps([seen.state_hash, seen.version]))
    await store.close()

asyncio.run(read())
"""


async def test_another_process_reads_the_same_map_to_the_bit(store: Store, tmp_path: Path) -> None:
    newest = await write(store, RUN)
    async with mapper_on(store) as mapper:
        here = await map_at(mapper, newest)
    assert store._server

    command = [
        sys.executable,
        "-c",
        READER,
        f"unix://{store._server.socket}",
        f"file://{tmp_path}/data/blobs",
        "4",
    ]
    done = await asyncio.to_thread(
        subprocess.run, command, cwd=ROOT, capture_output=True, text=True, check=True
    )

    assert json.loads(done.stdout) == [here.state_hash, here.version]


async def test_a_restarted_mapper_goes_on_from_its_snapshot_to_the_same_map(store: Store) -> None:
    middle = await write(store, RUN[:10])
    async with mapper_on(store) as mapper:
        await map_at(mapper, middle)
    (snapshot,) = await store.newest(SCENE, "snapshots")
    segments = [await store.blobs.get(ref) for ref in json.loads(snapshot.fields["segments"])]
    assert ObjectMap.restore(segments).version == int(snapshot.fields["version"]) >= 8

    newest = await write(store, RUN[10:])
    async with mapper_on(store) as mapper:
        seen = await map_at(mapper, newest)

    assert seen.state_hash == expected(RUN).state_hash()
    assert await versions_in(store) == VERSIONS


async def test_a_writer_that_loses_its_lease_midway_is_followed_without_a_gap_or_a_repeat(
    store: Store,
) -> None:
    await write(store, RUN[:5])
    async with mapper_on(store) as first, mapper_on(store) as second:
        await map_at(first, (await store.newest(SCENE, "detections"))[0].id)
        holder = await store._client.hget("{default/kitchen}:lease:mapper", "owner")
        await store._client.delete("{default/kitchen}:lease:mapper")
        stolen = await store.acquire_lease(SCENE, STAGE, "a third process", 0.3)
        assert stolen is not None
        newest = await write(store, RUN[5:])

        one, other = await map_at(first, newest), await map_at(second, newest)
        assert await store._client.hget("{default/kitchen}:lease:mapper", "owner") is not None
        assert holder is not None

    assert one.state_hash == other.state_hash == expected(RUN).state_hash()
    assert await versions_in(store) == VERSIONS


async def test_a_writer_stopped_midway_is_followed_by_the_other(store: Store) -> None:
    async with mapper_on(store) as second:
        async with mapper_on(store) as first:
            middle = await write(store, RUN[:8])
            await map_at(first, middle)
        newest = await write(store, RUN[8:])

        seen = await map_at(second, newest)

    assert seen.state_hash == expected(RUN).state_hash()
    assert await versions_in(store) == VERSIONS


async def test_a_caller_that_hangs_up_while_the_map_is_read_back_leaves_it_whole(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    await write(store, RUN)
    async with mapper_on(store, SETTINGS.model_copy(update={"snapshot_every": 1000})) as mapper:
        await map_at(mapper, (await store.newest(SCENE, "detections"))[0].id)
    reader = a_mapper(store)
    begun, integrate = threading.Semaphore(0), ObjectMap.integrate

    def slowly(self: ObjectMap, one: DetectionBatch) -> MapDelta:
        begun.release()
        time.sleep(0.02)
        return integrate(self, one)

    monkeypatch.setattr(ObjectMap, "integrate", slowly)
    for batches_before in (0, 3):
        impatient = asyncio.create_task(reader.get_map(SCENE, False))
        for _ in range(batches_before + 1):
            await asyncio.to_thread(begun.acquire)
        impatient.cancel()
        await asyncio.wait({impatient})

    assert (await reader.get_map(SCENE, False)).state_hash == expected(RUN).state_hash()


async def test_a_batch_that_cannot_be_the_maps_does_not_block_the_scene(store: Store) -> None:
    good = [batch(n, detection("cup")) for n in range(1, 4)]
    poison = batch(4, detection("cup", feature=axis(0, 16)))
    newest = await write(store, [*good, poison, batch(5, detection("cup"))])

    async with mapper_on(store) as mapper:
        seen = await map_at(mapper, newest)

    assert (seen.frames, seen.detections) == (5, 4)
    assert [o.observations for o in seen.objects] == [4]
    assert (await a_mapper(store).get_map(SCENE, False)).state_hash == seen.state_hash


async def test_scenes_do_not_wait_for_one_another(store: Store) -> None:
    """The attic's log names bytes that are gone; the kitchen's map is made all the same."""
    await write(store, [batch(1, detection("cup"))], "attic")
    entry = (await store.newest("attic", "detections"))[0]
    ref = entry.fields["batch"].decode()
    (store.blobs._root / ref[:2] / ref).unlink()  # type: ignore[attr-defined]
    newest = await write(store, RUN)

    async with mapper_on(store) as mapper:
        seen = await map_at(mapper, newest)

    assert seen.state_hash == expected(RUN).state_hash()


# Watching


async def test_watching_yields_every_delta_in_order_old_ones_and_new(store: Store) -> None:
    await write(store, RUN[:6])
    async with mapper_on(store) as mapper:
        deltas: list[MapDelta] = []
        async with asyncio.timeout(20):
            async for delta in mapper.watch(SCENE, 0):
                deltas.append(delta)
                if len(deltas) == len(made_of(RUN[:6])[1]):
                    await write(store, RUN[6:])
                if len(deltas) == len(VERSIONS):
                    break

    assert deltas == made_of(RUN)[1]
    assert [d.kind for d in deltas[:5]] == [StepKind.SETTINGS, *3 * [StepKind.FRAME], StepKind.UPKEEP]


async def test_watching_starts_above_a_version(store: Store) -> None:
    newest = await write(store, RUN[:6])
    async with mapper_on(store) as mapper:
        await map_at(mapper, newest)
        async with asyncio.timeout(20):
            watched = [delta.version async for delta in _until(mapper, 4, 6)]

    assert watched == [5, 6]


async def _until(mapper: MapperClient, after: int, last: int) -> AsyncIterator[MapDelta]:
    async for delta in mapper.watch(SCENE, after):
        yield delta
        if delta.version == last:
            return


# Reading


async def test_a_scene_without_frames_has_an_empty_map(store: Store) -> None:
    await store.add_scene(SCENE)
    async with mapper_on(store) as mapper:
        seen = await mapper.get_map(SCENE)

    assert (seen.version, seen.objects, seen.applied_log_id) == (0, (), "0-0")


async def test_what_is_not_there_is_not_found_in_words(store: Store) -> None:
    newest = await write(store, [batch(1, detection("cup"))])
    async with mapper_on(store) as mapper:
        await map_at(mapper, newest)
        with pytest.raises(NotFound, match="there is no scene 'attic'; known: kitchen"):
            await mapper.get_map("attic")
        with pytest.raises(NotFound, match="object 'o000009' is not in scene kitchen at version 2"):
            await mapper.get_object(SCENE, "o000009")
        with pytest.raises(NotFound, match="object 'o000009'"):
            await mapper.get_points(SCENE, ["o000001", "o000009"])
        with pytest.raises(NotFound, match="no scene"):
            async for _ in mapper.watch("attic", 0):
                pass
        with pytest.raises(InvalidInput, match="scene 'a b'"):
            await mapper.get_map("a b")


async def test_unconfirmed_objects_are_shown_only_when_asked_for(store: Store) -> None:
    newest = await write(
        store,
        [batch(1, detection("cup")), batch(2, detection("cup"), detection("lamp", (3, 0, 0), (4, 1, 1)))],
    )
    async with mapper_on(store) as mapper:
        believed, everything = await map_at(mapper, newest), await map_at(mapper, newest, unconfirmed=True)

    assert [o.label for o in believed.objects] == ["cup"]
    assert [o.label for o in everything.objects] == ["cup", "lamp"]


async def test_an_object_is_found_by_an_id_merged_away(store: Store) -> None:
    parts = [((0, 0, 0), (1, 0.6, 0.04)), ((1.02, 0, 0), (2, 0.6, 0.04)), ((0.4, 0, 0), (1.6, 0.6, 0.04))]
    newest = await write(store, [batch(n, detection("table", *part)) for n, part in enumerate(parts, 1)])
    async with mapper_on(store) as mapper:
        (table,) = (await map_at(mapper, newest)).objects
        again = await mapper.get_object(SCENE, "o000002")
        points = await mapper.get_points(SCENE, ["o000002"])

    assert table.object_id == again.object_id == "o000001"
    assert len(points["o000002"][0]) == table.voxels


async def test_points_are_thinned_to_no_more_than_asked_with_some_of_each_object(store: Store) -> None:
    cups = [detection("cup", (float(x), 0, 0), (x + 0.2, 0.2, 0.2)) for x in range(3)]
    sideboard = detection("sideboard", (0, 3, 0), (2, 3.4, 0.6))
    newest = await write(store, [batch(n, *cups, sideboard) for n in (1, 2)])
    async with mapper_on(store) as mapper:
        objects = {o.object_id: o for o in (await map_at(mapper, newest)).objects}
        every = await mapper.get_points(SCENE)
        for most in (4, 10, 100):
            thin = await mapper.get_points(SCENE, max_points=most)
            counts = [len(points) for points, _ in thin.values()]
            assert sum(counts) <= most
            assert min(counts) >= 1
            assert all(points.shape == colors.shape for points, colors in thin.values())
        fewer_than_objects = await mapper.get_points(SCENE, max_points=2)

    assert {name: len(points) for name, (points, _) in every.items()} == {
        n: o.voxels for n, o in objects.items()
    }
    assert sum(len(points) for points, _ in fewer_than_objects.values()) <= 2
    low, high = objects["o000004"].box[:3], objects["o000004"].box[3:]
    assert ((every["o000004"][0] >= low - 1e-6) & (every["o000004"][0] <= high + 1e-6)).all()
    assert every["o000004"][1].tolist() == [[200, 100, 50]] * objects["o000004"].voxels


async def test_scenes_are_listed_with_their_sizes(store: Store) -> None:
    await store.add_scene("attic")
    newest = await write(store, RUN)
    async with mapper_on(store) as mapper:
        seen = await map_at(mapper, newest)
        attic, kitchen = await mapper.list_scenes()

    assert (attic.scene, attic.map_version, attic.objects) == ("attic", 0, 0)
    assert (kitchen.scene, kitchen.map_version, kitchen.objects) == (SCENE, seen.version, len(seen.objects))
    assert (kitchen.frames, kitchen.detections) == (seen.frames, seen.detections)


async def test_the_mapper_keeps_to_its_key(store: Store) -> None:
    from ovip.errors import NotAuthorized

    await store.add_scene(SCENE)
    async with mapper_on(store, SETTINGS.model_copy(update={"api_key": "key"})) as mapper:
        with pytest.raises(NotAuthorized):
            await mapper.get_map(SCENE)
