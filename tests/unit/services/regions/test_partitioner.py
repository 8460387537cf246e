"""One partition after another: what is cut anew, what is kept, what is told."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.types import RegionEventKind
from services.regions.domain.assembly import Cut
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.partition import PartitionParams
from services.regions.domain.staleness import StalenessParams
from services.regions.domain.survey import survey
from services.regions.grouping import FloorGrouping
from services.regions.map_view import MapView
from services.regions.partitioner import CutParams, Made, Partitioner
from services.regions.shelf import Answered, Gathered
from tests.unit.services.regions.homes import PlainMap, WordsAreFunctions, left_room, mapped, right_room
from tests.unit.services.regions.rooms import room, seen, two_rooms

KITCHEN, BED = mapped("a", "kitchen", 0.5, 0.5), mapped("b", "bedroom", 7.5, 3.5)
START = Answered(Cut.none(), "0-0", 0)


class Scene:
    """Partitions of a map and evidence, each from the one before."""

    def __init__(
        self, evidence: FloorEvidence, *objects: object, params: PartitionParams | None = None
    ) -> None:
        self.evidence = evidence
        self.map = PlainMap(*objects)  # type: ignore[arg-type]
        self.grouper = WordsAreFunctions()
        self.last = START
        self.restart(params)

    def restart(self, params: PartitionParams | None = None) -> None:
        cut = CutParams(params or PartitionParams(), StalenessParams())
        self._view = MapView("home", self.map, self.last.map_after)
        self.partitioner = Partitioner(self._view, FloorGrouping((self.grouper,)), cut)

    async def partition(self, *objects: object, wish: int = 0, gone: bool = False) -> Made:
        if objects or gone:
            self.map.objects = objects  # type: ignore[assignment]
            self.map.version += 1
            self.restart()
        made = await self.partitioner.partition(Gathered(self.evidence, "5-0"), self.last, wish)
        self.last = made.answered
        return made


def regions_of(made: Made) -> list[tuple[str, str, tuple[str, ...]]]:
    return [(r.region_id, r.function, r.object_ids) for r in made.answered.cut.partition.regions]


def shapes_of(made: Made) -> list[bytes]:
    return [grid.regions.tobytes() for grid in made.answered.cut.grids]


async def test_the_first_partition_cuts_every_floor_and_tells_what_appeared() -> None:
    made = await Scene(two_rooms(), KITCHEN, BED).partition()
    assert regions_of(made) == [("r1", "kitchen", ("a",)), ("r2", "bedroom", ("b",))]
    assert (made.stale, made.kept, made.differs) == (1, 0, True)
    partition = made.answered.cut.partition
    assert [(e.kind, e.region_id) for e in partition.events] == [
        (RegionEventKind.APPEARED, "r1"),
        (RegionEventKind.APPEARED, "r2"),
    ]
    assert (partition.map_version, made.answered.detections_after) == (1, "5-0")


async def test_what_changes_nothing_differs_in_nothing_but_the_maps_version() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    made = await scene.partition(KITCHEN, BED)
    assert (made.stale, made.kept, made.differs) == (0, 1, False)
    assert made.answered.cut.partition.map_version == 2
    assert made.answered.cut.partition.events == ()


async def test_an_object_that_stirs_within_its_region_keeps_the_floor_as_it_was() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    first = await scene.partition()
    made = await scene.partition(replace(KITCHEN, centroid=np.array([0.8, 0.7, 0.5])), BED)
    assert (made.stale, made.kept, made.differs) == (0, 1, False)
    assert shapes_of(made) == shapes_of(first)


async def test_small_moves_add_up_to_a_large_one() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    stale = []
    for step in (0.3, 0.6, 0.9):
        made = await scene.partition(replace(KITCHEN, centroid=np.array([0.5 + step, 0.5, 0.5])), BED)
        stale.append(made.stale)
    assert stale == [0, 1, 0]


async def test_an_object_that_comes_or_goes_cuts_its_floor_anew_and_the_rest_of_the_building_stays() -> None:
    below, above = room((0, 3), (0, 3), height=2.6), room((0, 3), (0, 3), floor=2.9, height=2.5)
    evidence = seen((below, (1.5, 1.5, 1.2)), (above, (1.5, 1.5, 4.1)))
    stove, bed = mapped("a", "kitchen", 1, 1), mapped("b", "bedroom", 1, 1, 3.4)
    scene = Scene(evidence, stove, bed)
    first = await scene.partition()
    assert (first.stale, first.kept) == (2, 0)
    came = await scene.partition(stove, bed, mapped("c", "bedroom", 2, 2, 3.4))
    assert (came.stale, came.kept, came.differs) == (1, 1, True)
    assert regions_of(came) == [("r1", "kitchen", ("a",)), ("r2", "bedroom", ("b", "c"))]
    went = await scene.partition(bed, mapped("c", "bedroom", 2, 2, 3.4))
    assert (went.stale, went.kept) == (1, 1)
    assert regions_of(went) == [("r1", "unknown", ()), ("r2", "bedroom", ("b", "c"))]
    assert [(e.kind, e.region_id, e.floor) for e in went.answered.cut.partition.events] == [
        (RegionEventKind.RETYPED, "r1", 0)
    ]


async def test_a_frame_that_shows_nothing_new_is_placed_in_a_floor_that_is_kept() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    first = await scene.partition()
    scene.evidence.add("f9", room((0.5, 3.5), (0.5, 3.5), height=2.5)[:50], np.array([2.0, 1.0, 1.2]))
    made = await scene.partition()
    assert (made.kept, made.differs) == (1, True)
    assert shapes_of(made) == shapes_of(first)
    assert made.answered.cut.partition.regions[0].frame_ids == ("f0", "f9")
    assert made.answered.cut.partition.events == ()


async def test_a_frame_that_shows_another_room_cuts_the_floor_anew() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    scene.evidence.add("f9", room((8.4, 12.0), (0.025, 4.025)), np.array([10.0, 2.0, 1.2]))
    made = await scene.partition()
    assert (made.stale, made.kept) == (1, 0)
    assert {r.region_id for r in made.answered.cut.partition.regions} > {"r1", "r2"}


async def test_a_new_wish_cuts_everything_anew_and_asks_everything_again() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    made = await scene.partition(wish=1)
    assert (made.stale, made.kept, made.differs) == (1, 0, False)
    assert made.answered.wish == 1


async def test_other_settings_cut_everything_anew() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    assert not scene.partitioner.would_cut_otherwise(scene.last)
    scene.restart(PartitionParams(marker_radius=0.5))
    assert scene.partitioner.would_cut_otherwise(scene.last)
    made = await scene.partition()
    assert (made.stale, made.kept) == (1, 0)


async def test_a_floor_found_below_is_cut_and_the_one_above_keeps_its_ids_and_shapes() -> None:
    above = room((0, 3), (0, 3), floor=2.9, height=2.5)
    bed = mapped("b", "bedroom", 1, 1, 3.4)
    scene = Scene(seen((above, (1.5, 1.5, 4.1))), bed)
    first = await scene.partition()
    scene.evidence.add("f9", room((0, 3), (0, 3), height=2.6), np.array([1.5, 1.5, 1.2]))
    made = await scene.partition(mapped("a", "kitchen", 1, 1), bed)
    assert [(r.floor, r.region_id) for r in made.answered.cut.partition.regions] == [(0, "r2"), (1, "r1")]
    assert (made.stale, made.kept) == (1, 1)
    assert shapes_of(made)[1:] == shapes_of(first)
    assert [(e.kind, e.region_id) for e in made.answered.cut.partition.events] == [
        (RegionEventKind.APPEARED, "r2")
    ]


async def test_a_floor_of_which_a_region_lost_its_last_cell_is_cut_anew() -> None:
    scene = Scene(two_rooms(), KITCHEN, BED)
    await scene.partition()
    cut = scene.last.cut
    less = replace(cut.partition, regions=cut.partition.regions[:1])
    scene.last = replace(scene.last, cut=replace(cut, partition=less))
    made = await scene.partition()
    assert (made.stale, made.kept) == (1, 0)
    assert len(made.answered.cut.partition.regions) == 2


async def test_objects_without_any_frame_are_on_no_floor_yet() -> None:
    made = await Scene(FloorEvidence(), KITCHEN).partition()
    assert (made.answered.cut.partition.floors, made.stale, made.kept) == ((), 0, 0)


async def test_frames_that_saw_no_floor_make_no_trouble() -> None:
    evidence = FloorEvidence()
    evidence.add("f0", np.zeros((0, 3), np.float32), np.array([0.0, 0.0, 1.2]))
    evidence.add("f1", np.array([[1.0, 0.0, 2.4]], np.float32), np.array([0.0, 0.0, 1.2]))
    made = await Scene(evidence, KITCHEN).partition()
    placed = [name for r in made.answered.cut.partition.regions for name in (*r.object_ids, *r.frame_ids)]
    assert len(made.answered.cut.partition.floors) == 1
    assert placed in ([], ["a", "f0", "f1"])


THINGS = (
    mapped("a", "kitchen", 0.5, 0.5),
    mapped("b", "kitchen", 3.5, 3.6),
    mapped("c", "bedroom", 7.5, 3.5),
    mapped("d", "bedroom", 5.0, 0.5),
)
PARTS = [(left_room()[part::5], (2.0, 2.0, 1.2)) for part in range(5)]
PARTS += [(right_room()[part::5], (6.0, 2.0, 1.2)) for part in range(5)]


@settings(max_examples=12)
@given(st.permutations(range(10)), st.lists(st.integers(0, 15), min_size=10, max_size=10))
def test_in_the_middle_of_exploration_everything_seen_has_its_one_region(
    order: list[int], known: list[int]
) -> None:
    asyncio.run(_explored(order, known))


async def _explored(order: list[int], known: list[int]) -> None:
    scene = Scene(FloorEvidence())
    ever: set[str] = set()
    alive: set[str] = set()
    for part, which in zip(order, known, strict=True):
        points, camera = PARTS[part]
        scene.evidence.add(f"f{part}", points, np.array(camera))
        made = await scene.partition(*(THINGS[k] for k in range(4) if which >> k & 1), gone=not which)
        partition, grids = made.answered.cut.partition, made.answered.cut.grids
        objects = sorted(name for r in partition.regions for name in r.object_ids)
        assert objects == [THINGS[k].object_id for k in range(4) if which >> k & 1]
        assert sorted(name for r in partition.regions for name in r.frame_ids) == sorted(
            scene.evidence.cameras
        )
        for grid, storey in zip(grids, survey(scene.evidence), strict=True):
            free, left = storey.space.free, storey.space.free & (grid.regions == 0)
            assert left.sum() <= 200 + 0.03 * free.sum()  # half a square metre may wait for more
        appeared = {e.region_id for e in partition.events if e.kind is RegionEventKind.APPEARED}
        assert not appeared & ever
        ever |= appeared
        alive = (alive | appeared) - {
            e.region_id for e in partition.events if e.kind is RegionEventKind.VANISHED
        }
        assert alive == {r.region_id for r in partition.regions}
