"""What any replica answers from the store."""

from __future__ import annotations

import pytest

from ovip.errors import Corrupt, DeadlineExceeded, NotFound
from ovip.store import Store
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.survey import survey
from services.regions.service import Regions
from services.regions.shelf import STAGE, Answered, Gathered, Shelf
from tests.unit.services.regions.rooms import two_rooms

SCENE = "home"


def cut_of(evidence: FloorEvidence) -> Cut:
    return assemble(survey(evidence), PlacedObjects.none(), (), evidence, Cut.none())


async def test_before_the_first_partition_there_is_an_empty_one_and_no_grid(store: Store) -> None:
    await store.add_scene(SCENE)
    partition = await Regions(store, 1.0).partition(SCENE)
    assert (partition.revision, partition.regions, partition.floors) == (0, (), ())
    with pytest.raises(NotFound, match="no floors yet"):
        await Regions(store, 1.0).floor_grid(SCENE, 0)


async def test_an_unknown_scene_is_not_found(store: Store) -> None:
    regions = Regions(store, 1.0)
    for ask in (regions.partition("nowhere"), regions.floor_grid("nowhere", 0), regions.recompute("nowhere")):
        with pytest.raises(NotFound, match="nowhere"):
            await ask


async def test_what_was_published_is_what_is_read(store: Store) -> None:
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    evidence = two_rooms()
    shelf = Shelf(store)
    cut = cut_of(evidence)
    await shelf.save_gathered(lease, 1, Gathered(evidence, "5-0"), evidence.to_bytes())
    await shelf.save_answered(lease, 2, Answered(cut, "7-0", 3))
    regions = Regions(store, 1.0)
    assert [r.region_id for r in (await regions.partition(SCENE)).regions] == ["r1"]
    grid = await regions.floor_grid(SCENE, 0)
    assert grid.regions.tolist() == cut.grids[0].regions.tolist()
    assert grid.occupancy.tolist() == cut.grids[0].occupancy.tolist()
    with pytest.raises(NotFound, match="floors 0 to 0"):
        await regions.floor_grid(SCENE, 1)
    again = await shelf.answered(SCENE)
    assert (again.map_after, again.wish, again.cut.next_number) == ("7-0", 3, cut.next_number)
    gathered = await shelf.gathered(SCENE)
    assert (gathered.after, gathered.evidence.to_bytes()) == ("5-0", evidence.to_bytes())
    assert await shelf.step(SCENE) == 2


async def test_a_step_committed_again_changes_nothing(store: Store) -> None:
    await store.add_scene(SCENE)
    lease = await store.acquire_lease(SCENE, STAGE, "test", 30.0)
    assert lease is not None
    shelf = Shelf(store)
    for _ in range(2):
        await shelf.save_answered(lease, 1, Answered(cut_of(two_rooms()), "7-0", 0))
    assert await store.length(SCENE, "regions") == 1


async def test_recompute_gives_up_where_nobody_follows(store: Store) -> None:
    await store.add_scene(SCENE)
    with pytest.raises(DeadlineExceeded, match="home"):
        await Regions(store, 0.2).recompute(SCENE)


async def test_wishes_are_counted(store: Store) -> None:
    await store.add_scene(SCENE)
    shelf = Shelf(store)
    assert await shelf.wish(SCENE) == 0
    assert [await shelf.make_wish(SCENE), await shelf.make_wish(SCENE)] == [1, 2]
    assert await shelf.answered_wish(SCENE) == 0


async def test_a_grid_blob_that_is_none_is_corrupt(store: Store) -> None:
    await store.add_scene(SCENE)
    ref = await store.blobs.put(b"no grid")
    with pytest.raises(Corrupt, match=ref):
        await Shelf(store)._grid(ref)
