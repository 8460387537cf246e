"""What is kept in the store: evidence in segments, partitions with what the next one needs, and damage."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ovip.scene.types import RegionEvent, RegionEventKind
from ovip.store import Lease, Store
from services.regions.domain.assembly import Cut
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.partition import PartitionParams
from services.regions.domain.staleness import StalenessParams
from services.regions.grouping import FloorGrouping, GroupingMemory
from services.regions.map_view import MapView
from services.regions.partitioner import CutParams, Partitioner
from services.regions.shelf import STAGE, Answered, Checkpoint, Gathered, Shelf
from tests.unit.services.regions.damage import corrupt, forget
from tests.unit.services.regions.homes import SCENE, PlainMap, WordsAreFunctions, left_room, mapped
from tests.unit.services.regions.rooms import two_rooms


async def leased(store: Store) -> Lease:
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    return lease


async def an_answer() -> Answered:
    view = MapView(SCENE, PlainMap(mapped("a", "kitchen", 0.5, 0.5), mapped("b", "bedroom", 7.5, 3.5)), "0-0")
    partitioner = Partitioner(
        view, FloorGrouping((WordsAreFunctions(),)), CutParams(PartitionParams(), StalenessParams())
    )
    made = await partitioner.partition(Gathered(two_rooms(), "5-0"), Answered(Cut.none(), "0-0", 0), 3)
    return made.answered


def walked(evidence: FloorEvidence, frames: range) -> FloorEvidence:
    for frame in frames:
        evidence.add(f"f{frame}", left_room()[frame::50], np.array([2.0, 2.0, 1.2]))
    return evidence


async def checkpoint(shelf: Shelf, lease: Lease, step: int, gathered: Gathered) -> Gathered:
    """As the follower does it."""
    base = Checkpoint() if gathered.checkpoint.is_outgrown else gathered.checkpoint
    segment = gathered.evidence.segment(base.frames)
    made = await shelf.save_gathered(lease, step, gathered, segment, base)
    return Gathered(gathered.evidence, gathered.after, made)


async def test_a_checkpoint_costs_what_came_since_the_last_and_all_together_are_the_evidence(
    store: Store,
) -> None:
    lease, shelf = await leased(store), Shelf(store)
    gathered = Gathered(walked(FloorEvidence(), range(40)), "40-0")
    for step, stop in enumerate((40, 41, 42), 1):
        walked(gathered.evidence, range(stop))
        gathered = Gathered(gathered.evidence, f"{stop}-0", gathered.checkpoint)
        gathered = await checkpoint(shelf, lease, step, gathered)
    kept = await shelf.gathered(SCENE)
    assert len(kept.checkpoint.refs) == 3
    assert max(kept.checkpoint.sizes[1:]) < kept.checkpoint.sizes[0]
    assert (kept.after, kept.checkpoint.frames, kept.lost) == ("42-0", 42, "")
    assert kept.evidence.to_bytes() == gathered.evidence.to_bytes()


async def test_evidence_goes_on_from_its_segments_after_a_restart(store: Store) -> None:
    lease, shelf = await leased(store), Shelf(store)
    gathered = Gathered(FloorEvidence(), "0-0")
    for step in range(1, 7):
        walked(gathered.evidence, range(5 * step - 5, 5 * step))
        await checkpoint(
            shelf, lease, step, Gathered(gathered.evidence, f"{5 * step}-0", gathered.checkpoint)
        )
        gathered = await shelf.gathered(SCENE)
        assert gathered.evidence.to_bytes() == walked(FloorEvidence(), range(5 * step)).to_bytes()


async def test_segments_that_outgrow_the_whole_are_written_whole(store: Store) -> None:
    lease, shelf = await leased(store), Shelf(store)
    gathered = Gathered(FloorEvidence(), "0-0")
    held = []
    for step in range(1, 12):
        walked(gathered.evidence, range(3 * step - 3, 3 * step))
        gathered = await checkpoint(shelf, lease, step, gathered)
        held.append(sum(gathered.checkpoint.sizes) / len(gathered.evidence.to_bytes()))
        before = Checkpoint(gathered.checkpoint.refs[:-1], gathered.checkpoint.sizes[:-1])
        assert len(gathered.checkpoint.refs) == 1 or not before.is_outgrown
    assert len(gathered.checkpoint.refs) < 11
    assert max(held) < 4


def test_a_checkpoint_is_outgrown_where_it_holds_over_twice_the_whole_or_too_many_parts() -> None:
    assert Checkpoint().is_outgrown
    assert not Checkpoint(("a", "b"), (100, 100)).is_outgrown
    assert Checkpoint(("a", "b"), (100, 101)).is_outgrown
    assert Checkpoint(("a",) * 64, (100,) * 1 + (0,) * 63).is_outgrown


@pytest.mark.parametrize("damage", [corrupt, forget])
@pytest.mark.parametrize("which", [0, -1])
async def test_evidence_of_which_any_part_is_damaged_is_empty_and_says_why(
    store: Store, damage: object, which: int
) -> None:
    lease, shelf = await leased(store), Shelf(store)
    gathered = Gathered(walked(FloorEvidence(), range(40)), "40-0")
    gathered = await checkpoint(shelf, lease, 1, gathered)
    walked(gathered.evidence, range(40, 41))
    gathered = await checkpoint(shelf, lease, 2, gathered)
    assert len(gathered.checkpoint.refs) == 2
    await damage(store, gathered.checkpoint.refs[which])  # type: ignore[operator]
    kept = await shelf.gathered(SCENE)
    assert (kept.after, kept.evidence.revision, kept.checkpoint) == ("0-0", 0, Checkpoint())
    assert gathered.checkpoint.refs[which][:12] in kept.lost


async def test_evidence_that_an_older_version_wrote_is_gathered_again(store: Store) -> None:
    lease = await leased(store)
    ref = await store.blobs.put(b"OVIPFE01 and so on")
    await store.commit(lease, "1-0", [], {"evidence": ref, "evidence_after": "7-0"})
    kept = await Shelf(store).gathered(SCENE)
    assert (kept.after, kept.evidence.revision) == ("0-0", 0)
    assert kept.lost


async def test_an_answer_is_read_with_all_that_the_next_one_needs(store: Store) -> None:
    lease, shelf, answered = await leased(store), Shelf(store), await an_answer()
    await shelf.save_answered(lease, 1, answered)
    kept = await shelf.answered(SCENE)
    assert (kept.wish, kept.detections_after, kept.settings, kept.lost) == (3, "5-0", answered.settings, "")
    assert kept.memory == answered.memory
    assert [b.to_bytes() for b in kept.bases] == [b.to_bytes() for b in answered.bases]
    assert kept.cut.next_number == answered.cut.next_number
    assert [g.region_ids for g in kept.cut.grids] == [("r1", "r2")]


async def test_the_log_entry_tells_the_events(store: Store) -> None:
    lease, shelf, answered = await leased(store), Shelf(store), await an_answer()
    await shelf.save_answered(lease, 1, answered)
    (entry,) = await store.newest(SCENE, "regions")
    told = [
        RegionEvent(**{**e, "kind": RegionEventKind(e["kind"])}) for e in json.loads(entry.fields["events"])
    ]
    assert tuple(told) == answered.cut.partition.events == (await shelf.partition(SCENE)).events
    assert [event.kind for event in told] == [RegionEventKind.APPEARED] * 2


@pytest.mark.parametrize("damage", [corrupt, forget])
@pytest.mark.parametrize("what", ["partition", "grids"])
async def test_a_damaged_partition_leaves_the_numbers_that_must_never_be_used_again(
    store: Store, damage: object, what: str
) -> None:
    lease, shelf, answered = await leased(store), Shelf(store), await an_answer()
    await shelf.save_answered(lease, 1, answered)
    index = json.loads((await store.values(SCENE, STAGE, ["index"]))["index"])
    ref = index[what] if isinstance(index[what], str) else index[what][0]
    await damage(store, ref)  # type: ignore[operator]
    kept = await shelf.answered(SCENE)
    assert ref[:12] in kept.lost
    assert (kept.cut.partition.revision, kept.cut.next_number) == (1, 3)
    assert (kept.cut.partition.regions, kept.cut.grids, kept.bases) == ((), (), ())
    assert (kept.wish, kept.memory) == (3, answered.memory)


async def test_a_damaged_basis_costs_no_more_than_cutting_again(store: Store) -> None:
    lease, shelf, answered = await leased(store), Shelf(store), await an_answer()
    await shelf.save_answered(lease, 1, answered)
    index = json.loads((await store.values(SCENE, STAGE, ["index"]))["index"])
    await forget(store, index["bases"][0])
    kept = await shelf.answered(SCENE)
    assert (kept.lost, kept.bases, len(kept.cut.partition.regions)) == ("", (), 2)


async def test_what_was_answered_on_functions_is_kept_without_a_partition(store: Store) -> None:
    lease, shelf = await leased(store), Shelf(store)
    memory = GroupingMemory({"a": ("bed", "bedroom")}, failures=2)
    await shelf.save_memory(lease, 1, Answered(Cut.none(), "0-0", 0, memory=memory))
    kept = await shelf.answered(SCENE)
    assert (kept.memory, kept.cut.partition.revision) == (memory, 0)
    assert await store.length(SCENE, "regions") == 0
