"""Floor plans: areas tile rooms, rooms are joined by doors, storeys by stairs, and structure is solid."""

from __future__ import annotations

import numpy as np
import pytest

from lab.simulation.home import Mesh, inside_polygon, polygon_area
from lab.simulation.plans import STYLES, Plan, make_plan
from lab.simulation.plans.finishes import finishes
from lab.simulation.plans.layout import Cell, Layout, Stair, mirrored, shifted, transposed
from lab.simulation.plans.rectilinear import clipped, region
from lab.simulation.plans.structure import structure_of
from lab.simulation.plans.walls import OpeningKind, walls_of
from services.regions.domain.function_names import function_name
from services.regions.domain.function_table import FUNCTION_WORDS

SEEDS = range(20)


@pytest.fixture(scope="module")
def plans() -> list[Plan]:
    return [make_plan(np.random.default_rng(seed), style) for style in STYLES for seed in SEEDS]


def test_a_ring_has_the_corners_of_an_l_and_its_area() -> None:
    l_shape = region([(0, 0, 4, 3)], remove=[(2, 1, 4, 3)])
    expected = {(0, 0), (4, 0), (4, 1), (2, 1), (2, 3), (0, 3)}
    ring = l_shape.ring()
    assert {(float(x), float(y)) for x, y in ring} == expected
    assert len(ring) == 6
    assert l_shape.area == pytest.approx(4 * 3 - 2 * 2)
    assert polygon_area(ring) == pytest.approx(8)


@pytest.mark.parametrize(
    "parts", [region([(0, 0, 3, 3)], [(1, 1, 2, 2)]), region([(0, 0, 1, 1), (2, 2, 3, 3)]), region([])]
)
def test_a_region_with_a_hole_or_in_parts_has_no_ring(parts: object) -> None:
    with pytest.raises(ValueError):
        parts.ring()  # type: ignore[attr-defined]


def test_rectangles_that_only_touch_share_nothing() -> None:
    assert clipped((0, 0, 1, 1), (1, 0, 2, 1)) is None
    assert clipped((0, 0, 2, 2), (1, 1, 3, 3)) == (1, 1, 2, 2)


def test_two_rooms_have_seven_walls_and_the_one_between_them_ends_at_the_others() -> None:
    layout = Layout((Cell((0, 0, 3, 4), 0, "kitchen"), Cell((3, 0, 5, 4), 1, "bathroom")))
    walls = walls_of(layout, thickness=0.1, height=2.5, parapet=1.0)
    between = [wall for wall in walls if wall.sides == (0, 1)]
    assert len(walls) == 7
    assert [(wall.at, wall.low, wall.high) for wall in between] == [(3.0, 0.05, 3.95)]
    # no two walls share floor
    assert sum(region([wall.rect]).area for wall in walls) == pytest.approx(
        region([w.rect for w in walls]).area
    )


def test_a_stair_turns_with_its_storey() -> None:
    layout = Layout((Cell((0, 0, 6, 2), 0, "hallway"),), rising=Stair((1, 1, 4, 2), (1, 0)))
    turned = transposed(mirrored(layout, 0)).rising
    moved = shifted(layout, (2, 3)).rising
    assert turned == Stair((1, -4, 2, -1), (0, -1))
    assert moved == Stair((3, 4, 6, 5), (1, 0))


def test_areas_tile_their_rooms_exactly(plans: list[Plan]) -> None:
    for plan in plans:
        for room in plan.rooms:
            own = [area for area in plan.areas if area.room_id == room.room_id]
            assert sum(polygon_area(area.polygon) for area in own) == pytest.approx(
                polygon_area(room.polygon), abs=1e-9
            )
            low, high = room.polygon.min(axis=0), room.polygon.max(axis=0)
            points = np.random.default_rng(0).uniform(low, high, (200, 2))
            inside = sum(inside_polygon(area.polygon, points).astype(int) for area in own)
            assert np.array_equal(inside, inside_polygon(room.polygon, points).astype(int))


def test_every_home_has_four_to_twelve_areas_of_known_functions(plans: list[Plan]) -> None:
    for plan in plans:
        functions = [area.function for area in plan.areas]
        assert 4 <= len(functions) <= 12
        assert {"kitchen", "living room", "bedroom", "bathroom"} <= set(functions)
        assert {function_name(function) for function in functions} <= set(FUNCTION_WORDS)
        assert len({area.area_id for area in (*plan.areas, *plan.rooms)}) == len(plan.areas) + len(plan.rooms)


def test_styles_are_what_they_say(plans: list[Plan]) -> None:
    for plan in plans:
        ground = plan.floors[0]
        width, depth = ground.layout.size
        assert (max(width, depth) / min(width, depth) > 1.6) == ("elongated" in plan.style)
        assert (len(plan.floors) == 2) == plan.style.startswith("two-floors")
        day = {area.function: area.room_id for area in ground.areas}
        assert (day["kitchen"] == day["living room"]) == ("open" in plan.style)


def test_every_room_of_a_storey_is_reached_through_doorways(plans: list[Plan]) -> None:
    for plan in plans:
        for floor in plan.floors:
            group = list(range(len(floor.rooms)))
            for wall in floor.walls:
                if any(opening.kind is OpeningKind.DOORWAY for opening in wall.openings):
                    a, b = (group[side] for side in wall.sides)
                    group = [a if of == b else of for of in group]
            assert len(set(group)) == 1


def test_doors_are_as_wide_and_high_as_doors_and_lie_within_their_wall(plans: list[Plan]) -> None:
    for plan in plans:
        entrances = 0
        for wall in (wall for floor in plan.floors for wall in floor.walls):
            for opening in wall.openings:
                assert wall.inner[0] <= opening.low < opening.high <= wall.inner[1]
                if opening.kind is OpeningKind.WINDOW:
                    assert opening.bottom > 0.9 and -1 in wall.sides
                else:
                    assert 0.8 - 1e-6 <= opening.high - opening.low <= 0.9 + 1e-6
                    assert opening.top == pytest.approx(2.0)
                entrances += opening.kind is OpeningKind.ENTRANCE
        assert entrances == 1


def test_heights_are_those_of_homes(plans: list[Plan]) -> None:
    for plan in plans:
        for floor in plan.floors:
            assert 2.5 <= floor.storey.ceiling_z - floor.storey.z <= 2.7
            assert all(0.1 <= wall.thickness <= 0.151 for wall in floor.walls)
        assert all(2.8 <= floor.storey.z <= 3.0 for floor in plan.floors[1:])


def test_a_flight_climbs_in_steps_into_a_hole_of_its_size(plans: list[Plan]) -> None:
    for plan in (plan for plan in plans if len(plan.floors) == 2):
        ground, upper = plan.floors
        assert ground.flight is not None and upper.hole is not None
        assert np.allclose(ground.flight.rect, upper.hole)
        stairs = next(
            part for part in structure_of(plan, finishes(np.random.default_rng(0))) if part.label == "stairs"
        )
        treads = np.unique(stairs.mesh.vertices[:, 2].round(4))
        rises = np.diff([*treads, upper.storey.z])
        assert rises.max() < 0.2 and np.ptp(rises) < 1e-3
        assert not any(
            inside_polygon(room.polygon, np.array([_middle(upper.hole)]))[0] for room in upper.rooms
        )


@pytest.mark.parametrize("style", ["walled-compact", "two-floors-open"])
def test_each_piece_of_structure_is_closed_and_looks_outward(style: str) -> None:
    plan = make_plan(np.random.default_rng(3), style)
    walls = [(floor, wall) for floor in plan.floors for wall in floor.walls]
    seen = 0
    for part in structure_of(plan, finishes(np.random.default_rng(0))):
        assert _volume(part.mesh) > 0
        if part.label == "wall" and part.number >= 0:
            wall = walls[seen][1]
            gaps = sum((o.high - o.low) * (o.top - o.bottom) for o in wall.openings)
            solid = ((wall.high - wall.low) * wall.height - gaps) * wall.thickness
            assert _volume(part.mesh) == pytest.approx(solid, rel=1e-3)
            seen += 1
    assert seen == len(walls)


def test_the_same_seed_draws_the_same_plan_and_another_seed_another() -> None:
    one, same, other = (make_plan(np.random.default_rng(seed), "open-compact") for seed in (5, 5, 6))
    assert [floor.walls for floor in one.floors] == [floor.walls for floor in same.floors]
    assert [floor.walls for floor in one.floors] != [floor.walls for floor in other.floors]


def _volume(mesh: Mesh) -> float:
    """Of a closed mesh, by the divergence theorem; positive where its triangles look outward."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles].astype(np.float64), 1, 0)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), mesh.normals[:, 0]) > 0).all()
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def _middle(rect: tuple[float, float, float, float]) -> tuple[float, float]:
    return (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2
