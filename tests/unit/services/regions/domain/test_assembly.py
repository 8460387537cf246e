"""A scene cut into regions: floors, objects, frames, ids and names, from depth to partition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ovip.scene.types import F32, EdgeKind
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.partition import Growth, PartitionParams
from services.regions.domain.survey import storeys_of_objects, survey
from tests.unit.services.regions.rooms import plane, room, seen, two_rooms, without
from tests.unit.services.regions.stairways import HOLE, STRAIGHT, UPSTAIRS, home

OURS = PartitionParams(dilation=9, votes=2.0, growth=Growth.DISTANCE, min_part=4.0, merge_width=1.2)


def objects(*items: tuple[str, float, float, float]) -> PlacedObjects:
    return PlacedObjects(
        tuple(f"o{number}" for number in range(len(items))),
        tuple(item[0] for item in items),
        np.array([item[1:] for item in items], dtype=np.float64).reshape(-1, 3),
    )


KITCHEN_AND_BEDROOM = objects(("stove", 0.5, 0.5, 0.9), ("bed", 7.0, 3.0, 0.4))


def test_two_rooms_become_two_regions_joined_by_their_doorway() -> None:
    evidence = two_rooms()
    cut = assemble(survey(evidence), KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, Cut.none())
    kitchen, bedroom = cut.partition.regions
    assert (kitchen.region_id, kitchen.display_name, kitchen.object_ids, kitchen.frame_ids) == (
        "r1",
        "kitchen",
        ("o0",),
        ("f0",),
    )
    assert (bedroom.region_id, bedroom.function, bedroom.object_ids, bedroom.frame_ids) == (
        "r2",
        "bedroom",
        ("o1",),
        ("f1",),
    )
    assert kitchen.area == pytest.approx(16, rel=0.08)
    assert bedroom.area == pytest.approx(16, rel=0.08)
    assert kitchen.centroid == pytest.approx([2.0, 2.0, 0.0], abs=0.2)
    (edge,) = cut.partition.edges
    assert (edge.a, edge.b) == ("r1", "r2")
    assert edge.width == pytest.approx(0.9, abs=0.2)
    assert edge.position == pytest.approx([4.1, 2.05, 0.0], abs=0.25)
    assert edge.kind is EdgeKind.DOORWAY
    (floor,) = cut.partition.floors
    assert floor.z == pytest.approx(0.0, abs=0.02)
    assert floor.ceiling_z == pytest.approx(2.5, abs=0.02)


def test_the_grid_names_the_region_of_every_cell() -> None:
    evidence = two_rooms()
    cut = assemble(survey(evidence), KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, Cut.none())
    (grid,) = cut.grids
    assert grid.region_ids == ("r1", "r2")
    assert grid.revision == 1
    assert grid.regions[grid.cell_of(np.array([1.0, 1.0]))] == 1
    assert grid.regions[grid.cell_of(np.array([7.0, 1.0]))] == 2


def test_ids_survive_a_change_of_function_and_names_are_counted() -> None:
    evidence = two_rooms()
    surveyed = survey(evidence)
    first = assemble(surveyed, KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, Cut.none())
    swapped = replace(KITCHEN_AND_BEDROOM, centres=KITCHEN_AND_BEDROOM.centres[::-1])
    second = assemble(surveyed, swapped, ("bedroom", "kitchen"), evidence, first)
    functions = {region.region_id: region.function for region in second.partition.regions}
    assert functions == {"r1": "kitchen", "r2": "bedroom"}
    assert second.partition.revision == 2
    assert second.next_number == 3
    far = objects(("stove", 0.5, 0.5, 0.9), ("bed", 4.1, 2.0, 0.4), ("stove", 7.5, 3.5, 0.9))
    third = assemble(surveyed, far, ("kitchen", "bedroom", "kitchen"), evidence, first)
    assert sorted(region.display_name for region in third.partition.regions) == [
        "bedroom",
        "kitchen",
        "kitchen 2",
    ]


def test_each_floor_is_cut_on_its_own() -> None:
    below, above = room((0, 3), (0, 3), height=2.6), room((0, 3), (0, 3), floor=2.9, height=2.5)
    evidence = seen((below, (1.5, 1.5, 1.2)), (above, (1.5, 1.5, 4.1)))
    things = objects(("stove", 1, 1, 0.9), ("bed", 1, 1, 3.3))
    surveyed = survey(evidence)
    assert storeys_of_objects(surveyed, things.centres).tolist() == [0, 1]
    cut = assemble(surveyed, things, ("kitchen", "bedroom"), evidence, Cut.none())
    assert [(r.floor, r.function, r.object_ids, r.frame_ids) for r in cut.partition.regions] == [
        (0, "kitchen", ("o0",), ("f0",)),
        (1, "bedroom", ("o1",), ("f1",)),
    ]
    assert [r.region_id for r in cut.partition.regions] == ["r1", "r2"]
    assert len(cut.grids) == 2
    assert cut.partition.edges == ()


def test_a_floor_found_later_below_does_not_take_the_ids_of_the_one_above() -> None:
    above = seen((room((0, 3), (0, 3), floor=2.9), (1.5, 1.5, 4.1)))
    first = assemble(survey(above), PlacedObjects.none(), (), above, Cut.none())
    both = seen(
        (room((0, 3), (0, 3), floor=2.9), (1.5, 1.5, 4.1)),
        (room((0, 3), (0, 3), height=2.6), (1.5, 1.5, 1.2)),
    )
    second = assemble(survey(both), PlacedObjects.none(), (), both, first)
    assert {region.floor: region.region_id for region in second.partition.regions} == {0: "r2", 1: "r1"}


def test_a_scene_without_objects_is_unknown_and_one_without_frames_is_empty() -> None:
    evidence = seen((room((0, 3), (0, 3)), (1.5, 1.5, 1.2)))
    cut = assemble(survey(evidence), PlacedObjects.none(), (), evidence, Cut.none())
    assert [region.function for region in cut.partition.regions] == ["unknown"]
    empty = assemble(
        survey(FloorEvidence()), KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), FloorEvidence(), Cut.none()
    )
    assert empty.partition.regions == ()
    assert empty.grids == ()
    assert empty.partition.revision == 1


def test_a_view_of_nothing_but_a_table_is_still_one_region() -> None:
    rng = np.random.default_rng(3)
    table = np.stack([rng.uniform(0, 1.5, 900), rng.uniform(1, 2, 900), rng.normal(0.72, 0.01, 900)], axis=1)
    evidence = seen((table.astype(np.float32), (0.7, 0.2, 1.4)))
    cut = assemble(survey(evidence), objects(("cup", 0.7, 1.5, 0.8)), ("unknown",), evidence, Cut.none())
    (region,) = cut.partition.regions
    assert region.object_ids == ("o0",)
    assert region.frame_ids == ("f0",)


def test_a_floor_that_is_kept_keeps_its_regions_and_places_objects_anew() -> None:
    evidence = two_rooms()
    surveyed = survey(evidence)
    first = assemble(surveyed, KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, Cut.none())
    moved = objects(("stove", 7.5, 0.5, 0.9), ("bed", 7.0, 3.0, 0.4), ("cup", 0.5, 0.5, 0.9))
    kept = assemble(surveyed, moved, ("office",) * 3, evidence, first, kept=frozenset({0}))
    assert [(r.region_id, r.function, r.area) for r in kept.partition.regions] == [
        (r.region_id, r.function, r.area) for r in first.partition.regions
    ]
    assert [r.object_ids for r in kept.partition.regions] == [("o2",), ("o0", "o1")]
    assert (kept.grids[0].regions == first.grids[0].regions).all()
    assert kept.partition.revision == 2
    assert kept.partition.edges[0].kind is EdgeKind.DOORWAY


def test_a_kept_floor_stays_where_it_is_when_the_grid_grows() -> None:
    evidence = two_rooms()
    first = assemble(survey(evidence), KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, Cut.none())
    evidence.add("f9", room((-6, -3), (-6, -3)), np.array([-4.5, -4.5, 1.2]))
    grown = assemble(
        survey(evidence), KITCHEN_AND_BEDROOM, ("kitchen", "bedroom"), evidence, first, kept=frozenset({0})
    )
    assert grown.grids[0].regions.shape > first.grids[0].regions.shape
    for region in grown.partition.regions:
        assert grown.grids[0].regions[grown.grids[0].cell_of(region.centroid[:2])] > 0
    assert [r.area for r in grown.partition.regions] == [r.area for r in first.partition.regions]


def test_stairs_belong_to_both_floors_and_join_them() -> None:
    evidence = home(STRAIGHT, HOLE)
    cut = assemble(
        survey(evidence),
        objects(("stove", 7, 5, 0.9), ("bed", 7, 5, 3.3)),
        ("kitchen", "bedroom"),
        evidence,
        Cut.none(),
    )
    (edge,) = cut.partition.edges
    below, above = cut.partition.regions
    assert (edge.kind, edge.a, edge.b) == (EdgeKind.STAIRS, below.region_id, above.region_id)
    assert edge.position == pytest.approx([1.7, 3.0, 0.0], abs=0.25)
    assert edge.upper == pytest.approx([5.55, 3.0, UPSTAIRS], abs=0.25)
    for grid in cut.grids:
        for x in (2.5, 3.5, 4.5):  # on the flight
            assert grid.regions[grid.cell_of(np.array([x, 3.0]))] == 1
    for (
        frontier
    ) in cut.partition.frontiers:  # this home has no walls, but under its stairs there is nothing to find
        assert np.abs(frontier.position[:2] - (4.0, 3.0)).max() > 2.5


def test_new_floor_beside_a_kept_region_joins_it() -> None:
    evidence = seen((room((0, 3), (0, 3)), (1.5, 1.5, 1.2)))
    first = assemble(survey(evidence), objects(("stove", 1, 1, 0.9)), ("kitchen",), evidence, Cut.none())
    longer = seen((room((0, 3.5), (0, 3)), (1.5, 1.5, 1.2)))
    kept = assemble(
        survey(longer), objects(("stove", 1, 1, 0.9)), ("kitchen",), longer, first, kept=frozenset({0})
    )
    (before,), (after,) = first.partition.regions, kept.partition.regions
    assert after.region_id == before.region_id
    assert after.area - before.area == pytest.approx(1.5, abs=0.3)


def test_three_things_that_a_vlm_put_in_one_area_make_it_where_their_words_alone_would_not() -> None:
    evidence = seen((room((0, 8), (0, 4)), (4.0, 2.0, 1.2)))
    chairs = objects(
        *(("sofa", x, y, 0.5) for x in (1, 2) for y in (0.5, 1.5, 2.5, 3.5)),
        *(("chair", 6.5, 1, 0.5), ("chair", 6.5, 2, 0.5), ("chair", 6.5, 3, 0.5)),
    )
    functions = ("living room",) * 8 + ("balcony",) * 3
    for told, named in (((), ["living room"]), ((True,) * 11, ["balcony", "living room"])):
        cut = assemble(survey(evidence), chairs, functions, evidence, Cut.none(), OURS, told=told)
        assert sorted(region.function for region in cut.partition.regions) == named


def test_a_narrow_border_is_a_doorway_from_wall_to_wall_and_an_opening_from_wall_to_nowhere() -> None:
    params = replace(OURS, min_part=1.0)
    corridor = seen((room((0, 1.2), (0, 6)), (0.6, 3.0, 1.2)))
    ends = objects(
        ("stove", 0.6, 0.5, 0.9), ("fridge", 0.6, 1.0, 0.9), ("bed", 0.6, 5.5, 0.4), ("bed", 0.6, 5, 1)
    )
    functions = ("kitchen", "kitchen", "bedroom", "bedroom")
    (edge,) = assemble(survey(corridor), ends, functions, corridor, Cut.none(), params).partition.edges
    assert (edge.kind, round(edge.width, 1)) == (EdgeKind.DOORWAY, 1.2)
    small = seen((room((0, 2.2), (0, 2.2)), (1.1, 1.1, 1.2)))
    corners = objects(
        *(("stove", 0.3, 0.3, 0.9), ("fridge", 0.3, 0.4, 0.9)),
        *(("bed", 1.9, 0.3, 0.4), ("bed", 1.9, 0.4, 0.4)),
        *(("desk", 1.1, 1.9, 0.7), ("desk", 1.1, 1.8, 0.7)),
    )
    cut = assemble(survey(small), corners, (*functions, "office", "office"), small, Cut.none(), params)
    assert len(cut.partition.regions) == 3
    assert min(edge.width for edge in cut.partition.edges) < 1.3  # from a wall to the middle of the room
    assert {edge.kind for edge in cut.partition.edges} == {EdgeKind.OPENING}


def test_a_room_that_nothing_names_but_that_leads_to_three_others_is_a_hallway() -> None:
    evidence = seen(*_hall_and_three_rooms())
    things = objects(("bed", 1.5, 1.0, 0.4), ("stove", 4.5, 1.0, 0.9), ("desk", 7.5, 1.0, 0.7))
    cut = assemble(survey(evidence), things, ("bedroom", "kitchen", "office"), evidence, Cut.none(), OURS)
    assert sorted(region.function for region in cut.partition.regions) == [
        "bedroom",
        "hallway",
        "kitchen",
        "office",
    ]
    hall = next(r.region_id for r in cut.partition.regions if r.function == "hallway")
    assert all(edge.kind is EdgeKind.DOORWAY and hall in (edge.a, edge.b) for edge in cut.partition.edges)
    assert len(cut.partition.edges) == 3


def _hall_and_three_rooms() -> list[tuple[F32, tuple[float, float, float]]]:
    """Three rooms of 3 x 2 m in a row and a hall of 9 x 1.5 m along them, a doorway of 0.9 m from each."""
    views = []
    for number in range(3):
        x = (3.0 * number + 0.025, 3.0 * number + 2.925)
        middle = sum(x) / 2
        door = ((middle - 0.45, middle + 0.45), (1.9, 2.4), (-0.1, 2.0))
        through = plane(door[0], (1.95, 2.25), (0.0, 0.0))
        walls = np.concatenate([without(room(x, (0.025, 2.025)), *door), through])
        views.append((walls.astype(np.float32), (middle, 1.0, 1.2)))
    hall = room((0.025, 8.925), (2.175, 3.675))
    for number in range(3):
        middle = 3.0 * number + 1.475
        hall = without(hall, (middle - 0.45, middle + 0.45), (1.9, 2.4), (0.05, 2.0))
    return [*views, (hall, (4.5, 3.0, 1.2))]
