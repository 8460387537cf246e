"""How things are placed: what meets what, what carries what, and that a robot still gets everywhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.catalogue import Model, open_catalogue
from lab.simulation.furnishing.footprints import Footprint, gap_between, meeting
from lab.simulation.furnishing.placing import Carrier, Stead
from lab.simulation.furnishing.resting import Surfaces
from lab.simulation.furnishing.seating import chairs_around
from lab.simulation.furnishing.sides import sides_of
from lab.simulation.furnishing.site import Site
from lab.simulation.furnishing.surfaces import boards, hollow, top_surface
from lab.simulation.furnishing.wares import Posture, Wares
from lab.simulation.home import Material, RelationKind, joined
from lab.simulation.plans import FloorPlan, make_plan
from lab.simulation.plans.faces import box_faces, faces_mesh

WOOD = Material(np.array([120, 90, 60], np.uint8))
CATALOGUE = open_catalogue(Path("no furniture here"))

sizes = st.floats(0.1, 2.0)
places = st.floats(-2.0, 2.0)
footprints = st.builds(
    Footprint, places, places, sizes, sizes, st.floats(-3.1, 3.1), st.just(0.0), st.just(1.0)
)


def model_of(
    *boxes: tuple[tuple[float, float, float], tuple[float, float, float]], top: float | None
) -> Model:
    """A model of boxes, low and high corners given in its own frame."""
    mesh = joined(faces_mesh([box_faces(*box)], [WOOD], np.zeros(6, np.int32), 0) for box in boxes)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    size = (float(high[0] - low[0]), float(high[1] - low[1]), float(high[2]))
    return Model(mesh, size, top, "made here")


@pytest.fixture
def site() -> Site:
    """The living room of an empty walled home."""
    rng = np.random.default_rng(0)
    plan = make_plan(rng, "walled-compact").floors[0]
    area = next(area for area in plan.areas if area.function == "living room")
    return Site(area, Stead(plan), Wares(CATALOGUE, rng), Surfaces(), rng)


def test_boxes_that_touch_do_not_meet_and_turned_ones_do_when_they_reach() -> None:
    one = Footprint(0, 0, 1, 1, 0.0, 0, 1)
    beside = Footprint(1.0, 0, 1, 1, 0.0, 0, 1)
    turned = Footprint(1.1, 0, 1, 1, np.pi / 4, 0, 1)  # its corner reaches 0.707 towards the first
    above = Footprint(0, 0, 1, 1, 0.0, 1.0, 2)
    on_rug = Footprint(0, 0, 1, 1, 0.0, 0.0, 0.008)
    rows = np.array([other.row() for other in (beside, turned, above, on_rug)])
    assert meeting(one, rows).tolist() == [False, True, False, False]


@given(footprints, footprints)
def test_meeting_is_mutual_and_boxes_that_meet_have_no_gap(one: Footprint, other: Footprint) -> None:
    meets = bool(meeting(one, other.row()[None])[0])
    assert meets == bool(meeting(other, one.row()[None])[0])
    assert (gap_between(one, other) == 0.0) >= meets


def test_the_gap_between_boxes_is_measured_from_corner_to_side() -> None:
    one = Footprint(0, 0, 1, 1, 0.0, 0, 1)
    assert gap_between(one, Footprint(1.5, 0, 1, 1, 0.0, 0, 1)) == pytest.approx(0.5)
    assert gap_between(one, Footprint(1.3, 1.4, 1, 1, 0.0, 5, 6)) == pytest.approx(0.5)  # 0.3 and 0.4


def test_things_stand_on_a_top_but_not_under_what_rises_from_it() -> None:
    # a desk whose back half carries a cupboard
    desk = model_of(((-0.6, -0.4, 0.7), (0.6, 0.4, 0.75)), ((-0.6, 0, 0.75), (0.6, 0.4, 1.2)), top=0.75)
    surface = top_surface(desk, 0.012)
    assert surface is not None
    spots, feet = surface.spots(0.2, 0.2, 0.3, 0.012)
    assert len(spots) > 0
    assert np.allclose(feet, 0.75, atol=1e-4)
    assert spots[:, 1].max() <= -0.1 + 0.021  # half its depth off the cupboard, to the cell
    assert np.abs(spots[:, 0]).max() <= 0.5 + 0.021


def test_what_carries_nothing_has_no_top() -> None:
    assert top_surface(model_of(((0, 0, 0), (1, 1, 1)), top=None), 0.01) is None


def test_boards_of_a_shelf_take_what_is_low_enough() -> None:
    sides = [((x, -0.15, 0.0), (x + 0.02, 0.15, 1.0)) for x in (-0.42, 0.4)]
    levels = [((-0.4, -0.15, z), (0.4, 0.15, z + 0.02)) for z in (0.0, 0.3, 0.6, 0.98)]
    shelf = model_of(*sides, *levels, top=1.0)
    found = boards(shelf)
    assert [round(surface.level, 2) for surface in found] == [0.02, 0.32, 0.62]
    low_ones = [surface.spots(0.1, 0.2, 0.25, 0.006) for surface in found]
    assert all(len(spots) > 0 for spots, _ in low_ones)
    assert np.allclose(low_ones[1][1], 0.32, atol=1e-4)
    assert len(found[0].spots(0.1, 0.2, 0.29, 0.006)[0]) == 0  # 0.28 m under the next board


def test_what_lies_in_a_box_lies_on_its_bottom() -> None:
    bottom = ((-0.2, -0.2, 0.0), (0.2, 0.2, 0.02))
    rims = [((-0.2, -0.2, 0.0), (-0.18, 0.2, 0.3)), ((0.18, -0.2, 0.0), (0.2, 0.2, 0.3))]
    inside = hollow(model_of(bottom, *rims, top=None))
    spots, feet = inside.spots(0.1, 0.1, 0.1, 9.0)
    middle = np.linalg.norm(spots, axis=1).argmin()
    assert feet[middle] == pytest.approx(0.02, abs=1e-4)


def test_a_standing_book_is_as_thick_as_it_is_wide() -> None:
    wares = Wares(CATALOGUE, np.random.default_rng(0))
    book = wares.pick("book", posture=Posture.UPRIGHT)
    assert book is not None
    low, high = book.model.mesh.vertices.min(axis=0), book.model.mesh.vertices.max(axis=0)
    assert np.allclose(high - low, [book.width, book.depth, book.height], atol=1e-3)
    assert low[2] == pytest.approx(0.0, abs=1e-6)
    assert book.width < 0.1 < book.height


def test_things_of_one_label_and_place_differ_in_colour_as_long_as_there_are_colours() -> None:
    wares = Wares(CATALOGUE, np.random.default_rng(0))
    bottles = [wares.pick("bottle", place=3, colored=1.0) for _ in range(5)]
    attributes = [bottle.attributes for bottle in bottles if bottle]
    assert len(attributes) == 5 and len(set(attributes)) == 5


def test_a_label_that_the_catalogue_lacks_or_that_is_too_large_gives_nothing() -> None:
    wares = Wares(CATALOGUE, np.random.default_rng(0))
    assert wares.pick("steam engine") is None
    assert wares.pick("bed", most=(0.3, 0.3, 0.3)) is None


def test_the_sides_of_a_room_are_its_walls_seen_from_inside(site: Site) -> None:
    low, high = site.area.polygon.min(axis=0), site.area.polygon.max(axis=0)
    around = sum(side.length for side in sides_of(site.area, site.stead.plan))
    assert around == pytest.approx(2 * (high - low).sum(), abs=0.01)
    for side in site.sides:
        x, y = side.point((side.low + side.high) / 2, 0.05)
        assert low[0] < x < high[0] and low[1] < y < high[1]


def test_furniture_against_a_wall_has_its_back_to_it_and_its_front_to_the_room(site: Site) -> None:
    stand = site.stand(site.pick("tv stand"), access=0.6)
    assert stand is not None
    x, y = stand.world(np.array([0.0, stand.ware.depth / 2 + 0.02]))
    faces = (
        [side.face for side in site.sides if side.axis == 0],
        [side.face for side in site.sides if side.axis],
    )
    assert min(min(abs(y - face) for face in faces[0]), min(abs(x - face) for face in faces[1])) < 1e-6
    assert site.stead.free_of_things(
        Footprint(
            *map(float, stand.world(np.array([0.0, -stand.ware.depth / 2 - 0.3]))),
            0.5,
            0.5,
            stand.yaw,
            0.1,
            1,
        )
    )


def test_chairs_look_at_their_table_and_stay_clear_of_it(site: Site) -> None:
    table = site.middle(site.pick("dining table", most=(1.6, 1.0, 0.9)), 0.7)
    chairs = chairs_around(site, table, "chair", 4)
    assert table is not None and len(chairs) == 4
    for chair in chairs:
        look = np.array([np.sin(chair.yaw), -np.cos(chair.yaw)])
        to_table = np.array([table.x - chair.x, table.y - chair.y])
        assert (np.cross(look, to_table) if abs(look @ to_table) < 0.1 else look @ to_table) > 0
        assert not meeting(chair.footprint, table.footprint.row()[None])[0]


def test_what_is_put_on_a_table_stands_on_its_top_and_beside_what_is_there(site: Site) -> None:
    table = site.middle(site.pick("dining table", most=(1.6, 1.0, 0.9)), 0.7)
    assert table is not None
    mugs = [mug for _ in range(6) if (mug := site.put(site.pick("mug"), table))]
    assert len(mugs) == 6
    for mug in mugs:
        assert mug.kind is RelationKind.ON and mug.by is table
        assert mug.z == pytest.approx(table.ware.height, abs=0.01)
        others = np.array([other.footprint.row() for other in mugs if other is not mug])
        assert not meeting(mug.footprint, others).any()


def test_a_wardrobe_is_not_put_where_it_would_shut_a_room_off() -> None:
    plan = make_plan(np.random.default_rng(2), "walled-elongated").floors[0]
    stead = Stead(plan)
    hall = next(area for area in plan.areas if area.function == "hallway")
    low, high = hall.polygon.min(axis=0), hall.polygon.max(axis=0)
    middle, size = (low + high) / 2, high - low
    across = Footprint(*map(float, middle), min(0.6, size[0]), min(0.6, size[1]), 0.0, 0.0, 2.0)
    wall_to_wall = Footprint(
        *map(float, middle), *(float(s) if s == size.min() else 0.6 for s in size), 0.0, 0.0, 2.0
    )
    assert stead.walkway.keeps([])
    assert not stead.walkway.keeps([wall_to_wall])
    assert not stead.keeps_ways(across, [])  # less than 0.7 m is left beside it


def test_nothing_stands_in_a_doorway_but_a_mat_lies_there() -> None:
    plan = make_plan(np.random.default_rng(2), "walled-compact").floors[0]
    stead = Stead(plan)
    wall, door = next(
        (wall, opening) for wall in plan.walls for opening in wall.openings if opening.kind == "doorway"
    )
    x0, y0, x1, y1 = wall.rect_between(door.low, door.high, 0.3)
    spot = ((x0 + x1) / 2, (y0 + y1) / 2)
    before = (spot[0], spot[1] + 0.5) if wall.axis == 0 else (spot[0] + 0.5, spot[1])
    assert not stead.fits(Footprint(*before, 0.3, 0.3, 0.0, 0.0, 1.0), Carrier.FLOOR)
    assert stead.fits(Footprint(*before, 0.3, 0.3, 0.0, 0.0, 0.008), Carrier.FLOOR)


def test_what_was_taken_back_leaves_no_trace(site: Site) -> None:
    ware = site.pick("tv stand")
    stand = site.stand(ware, access=0.6)
    assert stand is not None
    assert site.settle(stand, 0.6) is None
    site.stead.take_back([stand])
    assert site.stead.placed == []
    assert site.settle(stand, 0.6) is stand


def test_walls_part_rooms_on_the_walkway() -> None:
    plan = make_plan(np.random.default_rng(2), "walled-compact").floors[0]
    walkway = Stead(plan).walkway
    for wall in plan.walls:
        for opening in wall.openings:
            if opening.kind == "doorway":
                x0, y0, x1, y1 = wall.rect_between(opening.low, opening.high, wall.thickness)
                stopper = Footprint((x0 + x1) / 2, (y0 + y1) / 2, x1 - x0, y1 - y0, 0.0, 0.0, 1.0)
                cut_off = (
                    min(wall.sides) >= 0 and sum(set(wall.sides) == set(w.sides) for w in plan.walls) == 1
                )
                if cut_off and sum(_doors_of(plan, side) == 1 for side in wall.sides):
                    assert not walkway.keeps([stopper])


def _doors_of(plan: FloorPlan, room: int) -> int:
    return sum(o.kind == "doorway" for wall in plan.walls if room in wall.sides for o in wall.openings)
