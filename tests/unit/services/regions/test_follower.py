"""The follower: evidence exactly once, bursts once, restarts, fallbacks, and other replicas."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable

import numpy as np
import pytest
from prometheus_client import Counter

from ovip.errors import NotConfigured, Unavailable
from ovip.scene.types import Partition
from ovip.store import Store
from services.regions.adapters.table_grouping import TableGrouper
from services.regions.adapters.vlm_grouping import VlmGrouper
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.pace import PaceParams
from services.regions.domain.partition import PartitionParams
from services.regions.domain.staleness import StalenessParams
from services.regions.follower import RegionsFollower
from services.regions.metrics import LOST, STALE_FLOORS
from services.regions.partitioner import CutParams
from services.regions.ports import Grouper
from services.regions.service import Regions
from services.regions.shelf import STAGE, Shelf
from tests.unit.services.regions.damage import corrupt, forget
from tests.unit.services.regions.homes import (
    SCENE,
    Home,
    NoEncoder,
    ScriptedVlm,
    WordsAreFunctions,
    left_room,
    right_room,
)

EAGER = PaceParams(quiet_s=0.2, min_interval_s=0.0)
NEVER = PaceParams(quiet_s=1000.0, min_interval_s=1000.0)
Damage = Callable[[Store, str], Awaitable[None]]
LEFT, RIGHT = (2.0, 2.0, 1.2), (6.0, 2.0, 1.2)


def follower(
    store: Store,
    home: Home,
    *groupers: Grouper,
    pace: PaceParams = EAGER,
    checkpoint: int = 64,
    partition: PartitionParams | None = None,
) -> RegionsFollower:
    chosen = groupers or (WordsAreFunctions(),)
    params = CutParams(partition or PartitionParams(), StalenessParams())
    return RegionsFollower(store, home, chosen, pace, params, checkpoint)


@contextlib.asynccontextmanager
async def following(one: RegionsFollower) -> AsyncIterator[asyncio.Task[None]]:
    task = asyncio.create_task(one.follow(SCENE))
    try:
        yield task
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def until(condition: Callable[[], Awaitable[bool]], seconds: float = 20.0) -> None:
    async with asyncio.timeout(seconds):
        while not await condition():
            await asyncio.sleep(0.02)


async def revision_of(store: Store) -> int:
    return (await Shelf(store).partition(SCENE)).revision


async def moved_in(store: Store) -> Home:
    await store.add_scene(SCENE)
    home = Home(store)
    await home.sees(0, left_room(), LEFT)
    await home.sees(1, right_room(), RIGHT)
    await home.gains("kitchen", 0.5, 0.5)
    await home.gains("bedroom", 7.5, 3.5)
    return home


async def partitioned(store: Store, home: Home, *groupers: Grouper) -> Partition:
    async with following(follower(store, home, *groupers)):
        return await Regions(store, 20.0).recompute(SCENE)


async def test_frames_and_objects_become_a_partition_tagged_with_the_map(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
    partition = await Shelf(store).partition(SCENE)
    assert [(r.function, r.object_ids, r.frame_ids) for r in partition.regions] == [
        ("kitchen", ("o0",), ("f0",)),
        ("bedroom", ("o1",), ("f1",)),
    ]
    assert partition.map_version == 2
    assert partition.fallbacks == ("grouping: by the word",)
    (entry,) = await store.newest(SCENE, "regions")
    assert entry.fields["map_version"] == b"2"
    assert (await Shelf(store).grid(SCENE, 0)).region_ids == ("r1", "r2")


async def test_a_burst_of_changes_is_one_partition(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home, pace=PaceParams(quiet_s=0.5, min_interval_s=30.0))):
        await until(lambda: _holds(store))
        for number in range(30):
            await home.gains("kitchen", 0.5 + 0.05 * number, 1.0)
            await asyncio.sleep(0.02)
        await until(lambda: _at_least(store, 1))
        await asyncio.sleep(0.7)
    partition = await Shelf(store).partition(SCENE)
    assert (partition.revision, partition.map_version) == (1, 32)
    assert home.asked == 1


async def test_a_stream_that_never_pauses_is_partitioned_all_the_same(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home, pace=PaceParams(quiet_s=30.0, min_interval_s=0.0))):
        await asyncio.sleep(0.1)
        assert await revision_of(store) == 0
    async with following(follower(store, home, pace=PaceParams(quiet_s=0.5, min_interval_s=0.5))):
        async with asyncio.timeout(20):
            number = 0
            while await revision_of(store) < 3:
                number += 1
                await home.gains("kitchen", 0.5 + 0.01 * number, 1.0)
                await asyncio.sleep(0.1)
    assert number > 8


async def test_what_changes_nothing_is_not_published_and_no_object_is_read_twice(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
        asked = home.asked
        await home.tells()
        await home.moves("o0", 0.6, 0.6)
        await until(lambda: _has_asked(home, asked + 1))
        await home.tells()
        await asyncio.sleep(1.0)
    assert home.asked == asked + 1
    assert await revision_of(store) == 1
    assert await store.length(SCENE, "regions") == 1


async def test_an_object_that_goes_leaves_its_region(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
        await home.loses("o0")
        await until(lambda: _at_least(store, 2))
    partition = await Shelf(store).partition(SCENE)
    assert [name for r in partition.regions for name in r.object_ids] == ["o1"]
    assert partition.map_version == 3


async def test_an_empty_scene_has_nothing_to_partition_until_somebody_asks(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    async with following(follower(store, home)):
        await asyncio.sleep(0.6)
        assert await revision_of(store) == 0
        partition = await Regions(store, 20.0).recompute(SCENE)
    assert (partition.revision, partition.floors, partition.regions, partition.events) == (1, (), (), ())


async def test_frames_alone_make_floors_of_unknown_function(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    await home.sees(0, left_room(), LEFT)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
    partition = await Shelf(store).partition(SCENE)
    assert [(r.function, r.frame_ids) for r in partition.regions] == [("unknown", ("f0",))]


async def test_a_later_change_is_another_partition_with_the_same_ids(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
        await home.gains("bedroom", 7.0, 3.0)
        await until(lambda: _at_least(store, 2))
    partition = await Shelf(store).partition(SCENE)
    assert [r.region_id for r in partition.regions] == ["r1", "r2"]
    assert partition.regions[1].object_ids == ("o1", "o2")
    assert partition.map_version == 3


async def test_evidence_is_counted_once_whatever_the_restarts(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    expected = FloorEvidence()
    for frame in range(7):
        points = left_room()[frame::7]
        await home.sees(frame, points, LEFT)
        expected.add(f"f{frame}", points, np.array(LEFT))
    for checkpoint in (2, 3, 1):  # each follower is stopped at a checkpoint and the next one goes on
        async with following(follower(store, home, pace=NEVER, checkpoint=checkpoint)):
            await until(lambda: _any_evidence(store))
            await asyncio.sleep(0.3)
    async with following(follower(store, home)):
        await Regions(store, 20.0).recompute(SCENE)
        await until(lambda: _evidence_is(store, 7))
    assert (await Shelf(store).gathered(SCENE)).evidence.to_bytes() == expected.to_bytes()


async def test_a_late_batch_and_one_that_cannot_be_read_change_nothing(store: Store) -> None:
    home = await moved_in(store)
    await home.sees(0, left_room(), LEFT, late=True)
    await home.logs("detections", {"frame_id": "f9", "batch": "0" * 64, "kind": "frame"})
    partition = await partitioned(store, home)
    assert sorted(f for r in partition.regions for f in r.frame_ids) == ["f0", "f1"]


async def test_ids_and_revisions_go_on_after_a_restart(store: Store) -> None:
    home = await moved_in(store)
    first = await partitioned(store, home)
    second = await partitioned(store, home)
    assert (first.revision, second.revision) == (1, 2)
    assert [r.region_id for r in second.regions] == [r.region_id for r in first.regions]
    assert [len(first.events), len(second.events)] == [2, 0]


async def test_a_restart_with_nothing_new_publishes_nothing_and_asks_no_vlm(store: Store) -> None:
    home = await moved_in(store)
    vlm = ScriptedVlm({"areas": [{"function": "studio", "objects": [1, 2]}]})
    groupers = VlmGrouper(vlm, 5.0), TableGrouper(NoEncoder())
    async with following(follower(store, home, *groupers)):
        await until(lambda: _at_least(store, 1))
    async with following(follower(store, home, *groupers)):
        await asyncio.sleep(0.5)
        assert await revision_of(store) == 1
        await home.sees(2, left_room(), LEFT)
        await until(lambda: _at_least(store, 2))
    partition = await Shelf(store).partition(SCENE)
    assert {r.function for r in partition.regions} == {"studio"}
    assert len(vlm.prompts) == 1


async def test_frames_that_were_gathered_but_not_partitioned_before_a_restart_are_not_forgotten(
    store: Store,
) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    await home.sees(0, left_room(), LEFT)
    async with following(follower(store, home, pace=NEVER, checkpoint=1)):
        await until(lambda: _evidence_is(store, 1))
    assert await revision_of(store) == 0
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))


async def test_a_stream_that_never_ends_does_not_hold_up_a_wish(store: Store) -> None:
    home = await moved_in(store)

    async def stream() -> None:
        for frame in range(2, 10_000):
            await home.sees(frame, right_room()[frame % 40 :: 40], RIGHT)

    streaming = asyncio.create_task(stream())
    async with following(follower(store, home, pace=NEVER)):
        partition = await Regions(store, 20.0).recompute(SCENE)
        assert not streaming.done()
        streaming.cancel()
        await asyncio.gather(streaming, return_exceptions=True)
    assert partition.revision == 1


async def test_other_settings_cut_the_floors_anew_after_a_restart(store: Store) -> None:
    home = await moved_in(store)
    await partitioned(store, home)
    cut = _counted(STALE_FLOORS)
    async with following(follower(store, home)):
        await asyncio.sleep(0.6)
    assert _counted(STALE_FLOORS) == cut
    async with following(follower(store, home, partition=PartitionParams(marker_radius=0.2))):
        await until(lambda: _has_counted(STALE_FLOORS, cut + 1))


async def test_less_evidence_than_was_partitioned_is_never_partitioned(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    for frame in range(40):
        await home.sees(frame, left_room()[frame::40], LEFT)
    async with following(follower(store, home, pace=NEVER, checkpoint=1000)):
        await Regions(store, 20.0).recompute(SCENE)
    assert not await store.values(SCENE, STAGE, ["evidence"])
    at_once = PaceParams(quiet_s=0.0, min_interval_s=0.0)
    async with following(follower(store, home, pace=at_once, checkpoint=1000)):
        await home.sees(40, left_room(), LEFT)
        await until(lambda: _at_least(store, 2))
    for entry in await store.read(SCENE, "regions"):
        partition = await Shelf(store)._partition(entry.fields["partition"].decode())
        assert len({f for r in partition.regions for f in r.frame_ids}) >= 40


@pytest.mark.parametrize("damage", [corrupt, forget])
async def test_damaged_evidence_is_gathered_again_from_the_start(store: Store, damage: Damage) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _evidence_is(store, 2))
        await until(lambda: _at_least(store, 1))
    before = await Shelf(store).gathered(SCENE)
    lost = _counted(LOST.labels("evidence"))
    await damage(store, before.checkpoint.refs[0])
    async with following(follower(store, home)):
        await home.sees(2, left_room(), LEFT)
        await until(lambda: _at_least(store, 2))
        await until(lambda: _evidence_is(store, 3))
    again = await Shelf(store).gathered(SCENE)
    before.evidence.add("f2", left_room(), np.array(LEFT))
    assert again.evidence.to_bytes() == before.evidence.to_bytes()
    assert _counted(LOST.labels("evidence")) == lost + 1
    partition = await Shelf(store).partition(SCENE)
    assert [r.region_id for r in partition.regions] == ["r1", "r2"]
    assert partition.events == ()


@pytest.mark.parametrize("damage", [corrupt, forget])
@pytest.mark.parametrize("what", ["partition", "grids"])
async def test_a_damaged_partition_is_cut_again_at_once_under_new_ids(
    store: Store, damage: Damage, what: str
) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)):
        await until(lambda: _at_least(store, 1))
    index = json.loads((await store.values(SCENE, STAGE, ["index"]))["index"])
    await damage(store, index[what] if what == "partition" else index[what][0])
    async with following(follower(store, home)):
        await until(lambda: _index_is_at(store, 2))
    partition = await Shelf(store).partition(SCENE)
    assert [(r.region_id, r.function) for r in partition.regions] == [("r3", "kitchen"), ("r4", "bedroom")]
    assert (await Shelf(store).grid(SCENE, 0)).region_ids == ("r3", "r4")


async def test_recompute_first_catches_up_with_every_frame(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    for frame in range(40):
        await home.sees(frame, left_room()[frame::40], LEFT)
    async with following(follower(store, home, pace=NEVER)):
        partition = await Regions(store, 20.0).recompute(SCENE)
    assert len({f for r in partition.regions for f in r.frame_ids}) == 40


async def test_any_replica_answers_recompute_through_the_one_that_follows(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home, pace=NEVER)), following(follower(store, home, pace=NEVER)):
        partitions = await asyncio.gather(*(Regions(store, 20.0).recompute(SCENE) for _ in range(3)))
    assert {len(p.regions) for p in partitions} == {2}
    assert await revision_of(store) <= 3


async def test_a_second_follower_takes_over_where_the_first_one_stopped(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home)) as first:
        await until(lambda: _at_least(store, 1))
        async with following(follower(store, home)):
            first.cancel()
            await home.gains("bedroom", 7.0, 3.0)
            await until(lambda: _at_least(store, 2))
    assert (await Shelf(store).partition(SCENE)).map_version == 3


async def test_while_the_map_is_away_the_partition_waits(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.regions.follower._RETRY_S", 0.3)
    home = await moved_in(store)
    home.away = Unavailable("the mapper cannot be reached")
    async with following(follower(store, home)) as task:
        await until(lambda: _has_asked(home, 1))
        assert await revision_of(store) == 0
        home.away = None
        await until(lambda: _at_least(store, 1))
        assert not task.done()


async def test_without_a_vlm_the_table_groups_and_the_partition_says_so(store: Store) -> None:
    await store.add_scene(SCENE)
    home = Home(store)
    await home.sees(0, left_room(), LEFT)
    await home.gains("stove", 1.0, 1.0)
    await home.gains("zorb", 3.0, 3.0)
    none = VlmGrouper(ScriptedVlm(error=NotConfigured("set OVIP_VLM_UPSTREAMS")), 5.0)
    partition = await partitioned(store, home, none, TableGrouper(NoEncoder()))
    assert [r.function for r in partition.regions] == ["kitchen"]
    assert partition.fallbacks[0] == "grouping: function table, no VLM configured"
    assert "zorb" in partition.fallbacks[1]


async def test_with_a_vlm_its_functions_count_and_nothing_is_asked_twice(store: Store) -> None:
    home = await moved_in(store)
    vlm = ScriptedVlm(
        {"areas": [{"function": "workshop", "objects": [1]}, {"function": "studio", "objects": [2]}]}
    )
    async with following(follower(store, home, VlmGrouper(vlm, 5.0), TableGrouper(NoEncoder()))):
        await until(lambda: _at_least(store, 1))
        await home.sees(2, left_room(), LEFT)
        await until(lambda: _at_least(store, 2))
    partition = await Shelf(store).partition(SCENE)
    assert [r.function for r in partition.regions] == ["workshop", "studio"]
    assert partition.fallbacks == ()
    assert len(vlm.prompts) == 1


async def test_a_follower_that_is_cancelled_ends_whatever_it_was_doing(store: Store) -> None:
    home = await moved_in(store)
    for number in range(30):
        task = asyncio.create_task(follower(store, home).follow(SCENE))
        await asyncio.sleep(0.003 * number)
        task.cancel()
        done, _ = await asyncio.wait([task], timeout=10)
        assert done, f"still running after {3 * number} ms and a cancellation"


async def test_losing_the_lease_ends_the_work_without_a_write(store: Store) -> None:
    home = await moved_in(store)
    async with following(follower(store, home, pace=NEVER)) as task:
        await until(lambda: _holds(store))
        await store._client.delete(f"{{default/{SCENE}}}:lease:{STAGE}")
        thief = await store.acquire_lease(SCENE, STAGE, "thief", 30.0)
        assert thief is not None
        await Shelf(store).make_wish(SCENE)
        await asyncio.wait([task], timeout=20)
        assert "now written by another" in str(task.exception())
    assert await revision_of(store) == 0


async def _at_least(store: Store, revision: int) -> bool:
    return await revision_of(store) >= revision


async def _any_evidence(store: Store) -> bool:
    return bool((await Shelf(store).gathered(SCENE)).evidence.cameras)


async def _evidence_is(store: Store, frames: int) -> bool:
    return len((await Shelf(store).gathered(SCENE)).evidence.cameras) == frames


async def _has_asked(home: Home, times: int) -> bool:
    return home.asked >= times


async def _has_counted(counter: Counter, count: float) -> bool:
    return _counted(counter) >= count


async def _index_is_at(store: Store, revision: int) -> bool:
    index = json.loads((await store.values(SCENE, STAGE, ["index"]))["index"])
    return int(index["revision"]) >= revision


def _counted(counter: Counter) -> float:
    return float(counter._value.get())


async def _holds(store: Store) -> bool:
    lease = await store.acquire_lease(SCENE, STAGE, "probe", 5.0)
    if lease is not None:
        await store.release(lease)
    return lease is None
