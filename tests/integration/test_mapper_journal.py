"""The map log as a journal: whatever made a map, and wherever its writer stopped, the log alone makes it again."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from ovip.errors import Corrupt, InvalidInput, Unavailable
from ovip.scene.types import DetectionBatch, StepKind
from ovip.store import Append, Committed, Lease, Store
from services.mapper.history import History
from services.mapper.journal import step_of
from services.mapper.service import STAGE, Mapper
from tests.builders import axis, batch, detection
from tests.integration.mappers import (
    OTHER_SETTINGS,
    RUN,
    SCENE,
    SETTINGS,
    a_life,
    a_mapper,
    applied,
    expected,
    following,
    made_of,
    versions_in,
    write,
)

STEADY = SETTINGS.model_copy(update={"snapshot_every": 1000})


async def kinds_in(store: Store) -> list[StepKind]:
    return [step_of(entry).delta.kind for entry in await store.read(SCENE, "map", count=10_000)]


def blob_file(store: Store, ref: str) -> Path:
    root: Path = store.blobs._root  # type: ignore[attr-defined]
    return root / ref[:2] / ref


async def frame_blob(store: Store, nth: int) -> Path:
    entry = (await store.read(SCENE, "detections"))[nth]
    return blob_file(store, entry.fields["batch"].decode())


# Steps of every kind


async def test_the_log_alone_makes_the_map_again_whatever_made_it(store: Store) -> None:
    live = await a_life(store)

    again = await History(store).at(SCENE, live.version)
    await store._client.delete("{default/kitchen}:stream:snapshots")
    from_the_start = await History(store).at(SCENE, live.version)

    assert set(await kinds_in(store)) == set(StepKind)
    assert await versions_in(store) == list(range(1, live.version + 1))
    assert again.objects.state_hash() == from_the_start.objects.state_hash() == live.state_hash
    assert again.applied == from_the_start.applied == live.applied_log_id


async def test_a_frame_is_told_before_its_upkeep_which_is_a_step_of_its_own(store: Store) -> None:
    newest = await write(store, RUN[:7])
    async with following(store) as mapper:
        await applied(mapper, newest)

    frame, upkeep = StepKind.FRAME, StepKind.UPKEEP
    assert await kinds_in(store) == [StepKind.SETTINGS, *2 * [frame, frame, frame, upkeep], frame]


async def test_a_change_of_settings_is_a_step_and_holds_in_every_replay(store: Store) -> None:
    await write(store, RUN[:10])
    async with following(store) as mapper:
        await applied(mapper, (await store.newest(SCENE, "detections"))[0].id)
    newest = await write(store, RUN[10:])
    async with following(store, OTHER_SETTINGS) as mapper:
        live = await applied(mapper, newest)
    made, _ = made_of(RUN[:10])
    made.adopt(OTHER_SETTINGS.map_params())
    for one in RUN[10:]:
        made.integrate(one)
        if made.upkeep_due:
            made.upkeep()

    read = await a_mapper(store, SETTINGS).get_map(SCENE)  # a replica of other settings reads the map's own

    assert live.state_hash == made.state_hash() == read.state_hash
    assert (await kinds_in(store)).count(StepKind.SETTINGS) == 2


async def test_the_same_settings_again_make_no_step(store: Store) -> None:
    newest = await write(store, RUN[:5])
    for _ in range(3):
        async with following(store) as mapper:
            live = await applied(mapper, newest)
            await asyncio.sleep(0.05)

    assert live.state_hash == expected(RUN[:5]).state_hash()
    assert (await kinds_in(store)).count(StepKind.SETTINGS) == 1


async def test_other_settings_are_taken_on_before_the_next_frame_comes(store: Store) -> None:
    newest = await write(store, [batch(n, detection("cup")) for n in (1, 2)])
    async with following(store) as mapper:
        await applied(mapper, newest)
        assert len((await mapper.get_map(SCENE)).objects) == 1
    async with following(store, OTHER_SETTINGS) as mapper, asyncio.timeout(10):
        while (await mapper.get_map(SCENE)).objects:  # three frames must see it now
            await asyncio.sleep(0.01)
        (summary,) = await mapper.list_scenes()

    assert summary.objects == 0


async def test_the_last_frames_get_their_upkeep_once_nothing_comes_any_more(store: Store) -> None:
    newest = await write(store, RUN[:4])
    async with following(store, settle_after_s=0.1) as mapper, asyncio.timeout(20):
        await applied(mapper, newest)
        while (await kinds_in(store))[-1] is not StepKind.UPKEEP:
            await asyncio.sleep(0.05)
        versions = await versions_in(store)
        await asyncio.sleep(1.5)
        live = await mapper.get_map(SCENE)
    made = expected(RUN[:4])
    made.upkeep()

    assert live.state_hash == made.state_hash()
    assert await versions_in(store) == versions  # once


async def test_a_scene_without_input_gets_no_version(store: Store) -> None:
    await store.add_scene(SCENE)
    async with following(store, settle_after_s=0.05) as mapper:
        await asyncio.sleep(1.3)
        seen = await mapper.get_map(SCENE)

    assert (seen.version, seen.objects) == (0, ())


# Stopping anywhere


async def test_a_mapper_restarted_after_any_frame_ends_in_the_same_map(store: Store) -> None:
    for cut in range(1, 13):
        scene = f"cut{cut}"
        middle = await write(store, RUN[:cut], scene)
        async with following(store, scenes=(scene,)) as mapper:
            await applied(mapper, middle, scene)
        newest = await write(store, RUN[cut:13], scene)
        async with following(store, scenes=(scene,)) as mapper:
            live = await applied(mapper, newest, scene)

        assert live.state_hash == expected(RUN[:13]).state_hash(), cut


class _Failing:
    """The store, whose nth commit fails: before it happens, or after, its answer lost."""

    def __init__(self, store: Store, at: int, after: bool) -> None:
        self._store, self._at, self._after = store, at, after
        self._commits = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    async def commit(
        self, lease: Lease, inputs: Any, appends: Sequence[Append] = (), puts: Any = None
    ) -> Committed:
        self._commits += 1
        if self._commits == self._at and not self._after:
            raise Unavailable("the store went away")
        done = await self._store.commit(lease, inputs, appends, puts)
        if self._commits == self._at:
            raise Unavailable("the answer was lost")
        return done


@pytest.mark.parametrize("after", [False, True])
async def test_a_commit_that_fails_or_whose_answer_is_lost_is_done_once(store: Store, after: bool) -> None:
    """Commits are, in turn: settings, three frames, their upkeep, a snapshot, and so on."""
    for at in range(1, 13):
        scene = f"fails{at}"
        newest = await write(store, RUN[:8], scene)
        failing = Mapper(_Failing(store, at, after), SETTINGS.map_params(), 4)  # type: ignore[arg-type]
        task = asyncio.create_task(failing.follow(scene))
        async with asyncio.timeout(20):
            while not task.done() and await store.cursor(scene, STAGE) != newest:
                await asyncio.sleep(0.01)
        task.cancel()
        with contextlib.suppress(Unavailable, asyncio.CancelledError):
            await task
        async with following(store, scenes=(scene,)) as mapper:
            live = await applied(mapper, newest, scene)

        assert live.state_hash == expected(RUN[:8]).state_hash(), at
        assert await versions_in(store, scene) == list(range(1, live.version + 1)), at


async def test_two_replicas_that_write_in_turn_and_read_always_agree(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ovip.stages.LEASE_SECONDS", 0.5)
    async with following(store) as one, following(store) as other:
        for n, some in enumerate((RUN[:4], RUN[4:9], RUN[9:15], RUN[15:])):
            newest = await write(store, some)
            here, there = await applied(one, newest), await applied(other, newest)
            async with asyncio.timeout(10):
                while not here.version == there.version == (await versions_in(store))[-1]:
                    here, there = await one.get_map(SCENE), await other.get_map(SCENE)
            assert here.state_hash == there.state_hash
            if n == 1:  # the writer's lease is taken away
                await store._client.delete("{default/kitchen}:lease:mapper")
                assert await store.acquire_lease(SCENE, STAGE, "a third process", 0.2)

    assert here.state_hash == expected(RUN).state_hash()
    assert await versions_in(store) == list(range(1, here.version + 1))


async def test_a_map_ahead_of_a_log_that_was_set_back_follows_the_log(store: Store) -> None:
    """As after a store that lost its last second."""
    newest = await write(store, RUN[:5])
    async with following(store, STEADY) as mapper:
        await applied(mapper, newest)
    before = expected(RUN[:4])
    await store._client.hset("{default/kitchen}:state:mapper", "v:version", before.version)

    assert (await mapper.get_map(SCENE)).state_hash == before.state_hash()


# Snapshots


async def snapshots_in(store: Store) -> list[dict[str, Any]]:
    entries = await store.read(SCENE, "snapshots", count=10_000)
    return [
        {
            "version": int(e.fields["version"]),
            "segments": json.loads(e.fields["segments"]),
            "sizes": json.loads(e.fields["sizes"]),
            "hash": e.fields["state_hash"].decode(),
        }
        for e in entries
    ]


async def test_every_snapshot_holds_what_the_whole_log_makes(store: Store) -> None:
    live = await a_life(store)
    history = History(store)

    taken = await history.snapshots(SCENE, live.version)

    assert len(taken) >= 5
    assert max(len(one.segments) for one in taken) > 1
    for one in taken:
        opened = await history.opened(one)
        assert opened.objects.state_hash() == one.state_hash
        assert one.state_hash == (await a_mapper(store).get_map(SCENE, at_version=one.version)).state_hash


async def test_snapshots_hold_bounded_bytes_and_begin_anew_now_and_then(store: Store) -> None:
    """One room seen over and over: its segments hold a few times the map, however long it goes on."""
    things = [detection(f"thing{i}", (i, 0, 0), (i + 0.3, 0.3, 0.3), axis(i)) for i in range(6)]
    newest = await write(store, [batch(n, *things) for n in range(1, 81)])
    async with following(store) as mapper:
        await applied(mapper, newest)

    taken = await snapshots_in(store)
    whole = len((await History(store).at(SCENE, taken[-1]["version"])).objects.segment(0))
    begun = [one["segments"][0] for one in taken]

    assert len(set(begun)) > 3
    assert all(sum(one["sizes"]) <= 3.5 * whole for one in taken)
    assert all(len(one["segments"]) < 8 for one in taken)


async def test_a_commit_and_a_snapshot_are_as_large_as_what_changed_whatever_the_map(store: Store) -> None:
    """The same cup is seen in a map of 3 things, and of 300."""
    sizes = {}
    for many in (3, 300):
        scene = f"things{many}"
        things = [
            detection("thing", (i % 20, i // 20, 0), (i % 20 + 0.2, i // 20 + 0.2, 0.2)) for i in range(many)
        ]
        cup = detection("cup", (-3, 0, 0), (-2.8, 0.2, 0.2))
        run = [*(batch(n, *things) for n in range(1, 5)), *(batch(n, cup) for n in range(5, 21))]
        newest = await write(store, run, scene)
        async with following(store, scenes=(scene,)) as mapper:
            await applied(mapper, newest, scene)
        steps = (await store.read(scene, "map", count=1000))[-6:]
        entry = sum(len(value) for step in steps for value in step.fields.values())
        newest_snapshot = (await store.newest(scene, "snapshots"))[0]
        sizes[many] = (entry, json.loads(newest_snapshot.fields["sizes"])[-1])

    assert sizes[300][0] <= sizes[3][0] + 60
    assert sizes[300][1] <= 1.5 * sizes[3][1]


async def test_a_restart_reads_the_snapshot_and_only_the_steps_since(store: Store) -> None:
    newest = await write(store, RUN)
    async with following(store) as mapper:
        live = await applied(mapper, newest)
    (last,) = (await snapshots_in(store))[-1:]
    for entry in await store.read(SCENE, "map", count=1000):
        if int(entry.fields["version"]) <= last["version"] and b"batch" in entry.fields:
            blob_file(store, entry.fields["batch"].decode()).unlink(missing_ok=True)

    assert (await a_mapper(store).get_map(SCENE)).state_hash == live.state_hash


@pytest.mark.parametrize("harm", ["gone", "damaged", "newer format", "no record"])
async def test_a_snapshot_that_cannot_be_read_is_passed_over(store: Store, harm: str) -> None:
    newest = await write(store, RUN)
    async with following(store) as mapper:
        live = await applied(mapper, newest)
    last = (await snapshots_in(store))[-1]
    assert live.version > last["version"]
    file = blob_file(store, last["segments"][-1])
    match harm:
        case "gone":
            file.unlink()
        case "damaged":
            file.write_bytes(file.read_bytes()[:-1])
        case "newer format":
            await _replace_snapshot(
                store, last, file.read_bytes().replace(b"OVIPMAP\n\x02", b"OVIPMAP\n\x09")
            )
        case "no record":
            key = "{default/kitchen}:stream:snapshots"
            await store._client.xadd(key, {"nonsense": 1}, f"{last['version']}-5")

    assert (await a_mapper(store).get_map(SCENE)).state_hash == live.state_hash


async def _replace_snapshot(store: Store, last: dict[str, Any], data: bytes) -> None:
    key = "{default/kitchen}:stream:snapshots"
    entry = (await store.newest(SCENE, "snapshots"))[0]
    refs = json.dumps([*last["segments"][:-1], await store.blobs.put(data)])
    for old in await store.read(SCENE, "snapshots", count=1000):
        await store._client.xdel(key, old.id)
    await store._client.xadd(key, {**entry.fields, "segments": refs}, f"{last['version'] + 1}-0")
    await store._client.xtrim(key, maxlen=1)


async def test_mapping_goes_on_from_a_snapshot_that_cannot_be_read(store: Store) -> None:
    newest = await write(store, RUN[:10])
    async with following(store) as mapper:
        await applied(mapper, newest)
    broken = (await snapshots_in(store))[-1]
    blob_file(store, broken["segments"][-1]).unlink()

    newest = await write(store, RUN[10:])
    async with following(store) as mapper:
        live = await applied(mapper, newest)
        proof = await mapper.verify(SCENE)

    assert live.state_hash == expected(RUN).state_hash()
    assert proof.holds
    assert broken["segments"][-1] not in (await snapshots_in(store))[-1]["segments"]


async def test_a_full_disk_costs_no_frame_and_the_snapshot_is_taken_later(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    newest = await write(store, RUN[:10])
    put, full = store.blobs.put, True

    async def put_or_fail(data: bytes) -> str:
        if full:
            raise Unavailable("blob could not be stored: No space left on device")
        return await put(data)

    monkeypatch.setattr(store.blobs, "put", put_or_fail)
    async with following(store) as mapper:
        await applied(mapper, newest)
        assert await snapshots_in(store) == []
        full = False
        newest = await write(store, RUN[10:])
        live = await applied(mapper, newest)
        assert (await mapper.verify(SCENE)).holds

    assert live.state_hash == expected(RUN).state_hash()
    assert await snapshots_in(store) != []


# What is not what was written


async def test_a_lost_batch_is_named_with_the_version_that_needs_it(store: Store) -> None:
    newest = await write(store, RUN[:5])
    async with following(store, STEADY) as mapper:
        await applied(mapper, newest)
    (await frame_blob(store, 2)).unlink()

    with pytest.raises(
        Corrupt, match="scene kitchen: version 4 of the map log, made by frame, cannot be made again: blob"
    ):
        await a_mapper(store).get_map(SCENE)


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": "dance", "delta": b""},
        {"kind": "frame", "delta": b"\xff\xff"},
        {"kind": "frame", "delta": b""},
        {"kind": "upkeep", "frame_id": "x"},
    ],
)
async def test_an_entry_that_is_no_step_is_named(store: Store, fields: dict[str, Any]) -> None:
    newest = await write(store, RUN[:3])
    async with following(store, STEADY) as mapper:
        await applied(mapper, newest)
    await _next_entry(store, fields)

    with pytest.raises(Corrupt, match="map log: entry 6-0 is no step of a map"):
        await a_mapper(store).get_map(SCENE)


async def test_a_log_that_ends_too_early_is_named(store: Store) -> None:
    newest = await write(store, RUN[:3])
    async with following(store, STEADY) as mapper:
        await applied(mapper, newest)
    await store._client.hset("{default/kitchen}:state:mapper", "v:version", 9)

    with pytest.raises(Corrupt, match="the map log ends at version 5, expected it to go on to 9"):
        await a_mapper(store).get_map(SCENE)


async def test_a_scene_of_an_older_mapper_is_refused_in_words(store: Store) -> None:
    """Its entries had ids of the store's choice, and no kind."""
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "an older mapper", 5)
    assert lease is not None
    old = Append("map", {"version": 1, "frame_id": "r.s.00000001", "delta": b""})
    await store.commit(lease, "1-0", [old], {"version": 1})
    await store.release(lease)

    reader = a_mapper(store)
    for read in (reader.get_map(SCENE), reader.follow(SCENE)):
        with pytest.raises(InvalidInput, match="written by an older version of the mapper"):
            await read
    (summary,) = await reader.list_scenes()

    assert summary.map_version == 1


async def _next_entry(store: Store, fields: dict[str, Any]) -> None:
    version = len(await versions_in(store)) + 1
    key = "{default/kitchen}:stream:map"
    await store._client.xadd(key, {"version": version, **fields}, f"{version}-0")
    await store._client.hset("{default/kitchen}:state:mapper", "v:version", version)


async def test_a_refused_batch_is_refused_in_every_replay(store: Store) -> None:
    poison = batch(2, detection("cup", feature=axis(0, 16)))
    run: list[DetectionBatch] = [batch(1, detection("cup")), poison, batch(3, detection("cup"))]
    newest = await write(store, run)
    async with following(store, STEADY) as mapper:
        live = await applied(mapper, newest)
    refused = [
        e.fields["refused"] for e in await store.read(SCENE, "map", count=100) if "refused" in e.fields
    ]

    assert refused == [b"detection f/0: expected a feature of 8 numbers like the map's, got 16"]
    assert (live.frames, live.detections) == (3, 2)
    assert (await a_mapper(store).get_map(SCENE)).state_hash == live.state_hash
    assert (await mapper.verify(SCENE)).holds
