"""Floor plans: what colour a place gets, where it lies, and that no words cover each other or leave the picture."""

from __future__ import annotations

import io
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from PIL import Image

from ovip.errors import InvalidInput
from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.types import (
    U8,
    EdgeKind,
    Floor,
    Frontier,
    MapObject,
    Partition,
    Region,
    RegionEdge,
    SceneMap,
)
from services.api.domain.floorplan import PlanParams, draw_floorplans
from services.api.domain.labels import Label, overlap
from services.api.domain.palette import DOOR, FRONTIER, PAPER, STAIRS, WALL, region_colors
from services.api.domain.plan_drawing import floor_color
from services.api.domain.plan_sheet import PlanFrame, PlanSheet, plan_sheets
from services.api.domain.plan_words import PlanWords, words_of
from tests.unit.services.api.flat import SCENE, Flat, attic_grid, flat, grid, thing

SCALE = 40.0


def sheets(home: Flat) -> tuple[PlanSheet, ...]:
    scene_map = SceneMap(SCENE, 12, tuple(home.objects), "ab", 12, 140, "12-0")
    return plan_sheets(scene_map, home.partition(), (grid(), attic_grid()) if home.upstairs else (grid(),))


def drawn(sheet: PlanSheet, scale: float = SCALE) -> U8:
    """The plan below its heading, as pixels."""
    page = np.asarray(Image.open(io.BytesIO(draw_floorplans([sheet], PlanParams(pixels_per_metre=scale)))))
    frame = PlanFrame.around(sheet.grid, scale)
    top = next(y for y in range(len(page)) if (page[y] == WALL).all(axis=1).sum() > 50) - round(0.6 * scale)
    left = (page.shape[1] - frame.size[0]) // 2
    plan: U8 = page[top : top + frame.size[1], left : left + frame.size[0]]
    return plan


def at(plan: U8, sheet: PlanSheet, x: float, y: float) -> tuple[int, ...]:
    column, row = PlanFrame.around(sheet.grid, SCALE).pixel(np.array([x, y]))
    return tuple(int(value) for value in plan[round(row), round(column)])


def near(color: tuple[int, ...], other: tuple[int, int, int], apart: int = 4) -> bool:
    return max(abs(a - b) for a, b in zip(color, other, strict=True)) <= apart


def test_walls_unseen_and_the_floors_of_regions_have_their_colours_with_larger_y_up() -> None:
    home = flat()
    home.objects = []
    (sheet,) = sheets(home)
    plan = drawn(sheet)
    colors = region_colors(home.regions)

    assert near(at(plan, sheet, 4.95, 3.0), WALL)
    assert near(at(plan, sheet, -0.4, 6.4), PAPER)
    assert near(at(plan, sheet, 5.3, 5.8), floor_color(colors["r-kitchen"]))
    assert near(at(plan, sheet, 7.7, 2.6), floor_color(colors["r-bath"]))


def test_furniture_is_a_darker_floor_and_an_object_has_its_own_colour() -> None:
    home = flat()
    home.objects = [thing("o-001", "v", (0.5, 3.0, 0.0, 1.0, 3.5, 1.0), (200, 10, 10))]
    (sheet,) = sheets(home)
    plan = drawn(sheet)
    living = floor_color(region_colors(home.regions)["r-living"])
    sofa, vase = at(plan, sheet, 2.8, 0.6), at(plan, sheet, 0.6, 3.1)

    assert not near(sofa, WALL, 60)
    assert sum(living) - 75 < sum(sofa) < sum(living)
    assert vase[0] > vase[1] + 60


def test_a_doorway_a_flight_of_stairs_and_a_frontier_are_marked() -> None:
    home = flat()
    home.upstairs = True
    home.objects = []
    home.frontiers = (Frontier(0, "r-bath", np.array([8.0, 1.0, 0.0]), 1.2),)
    sheet = sheets(home)[0]
    plan = drawn(sheet).reshape(-1, 3).astype(int)

    for ink in (DOOR, STAIRS, FRONTIER):
        assert (np.abs(plan - ink).max(axis=1) < 30).sum() > 8


def test_a_hole_in_a_region_shows_what_is_in_it_and_never_a_region_drawn_over() -> None:
    labels = np.ones((80, 80), np.uint16)
    labels[20:60, 20:60] = 2
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    hole = (square / 2 + 1.0)[::-1]
    ring = Region("r1", 0, "hallway", "hallway", 12.0, np.array([0.5, 0.5, 0.0]), (square,), (hole,), (), ())
    core = Region(
        "r2", 0, "kitchen", "kitchen", 4.0, np.array([2.0, 2.0, 0.0]), (square / 2 + 1.0,), (), (), ()
    )
    cells = FloorGrid(0, (0.0, 0.0), 0.05, np.full((80, 80), FREE, np.uint8), labels, ("r1", "r2"))
    for regions in ((ring, core), (core, ring)):
        sheet = PlanSheet("x", Partition(1, 1, (Floor(0, 0.0, None, 16.0),), regions), *_of(cells))
        page = np.asarray(Image.open(io.BytesIO(draw_floorplans([sheet]))))
        kitchen = floor_color(region_colors(regions)["r2"])
        assert (np.abs(page.astype(int) - kitchen).max(axis=2) < 4).sum() > 0.8 * 160 * 160


def _of(cells: FloorGrid) -> tuple[Floor, FloorGrid, tuple[MapObject, ...]]:
    return Floor(0, 0.0, None, 16.0), cells, ()


def test_floors_stand_side_by_side_to_one_scale() -> None:
    home = flat()
    home.upstairs = True
    both = sheets(home)
    sizes = [Image.open(io.BytesIO(draw_floorplans(chosen))).size for chosen in ([both[0]], [both[1]], both)]

    assert sizes[2] == (sizes[0][0] + sizes[1][0], max(sizes[0][1], sizes[1][1]))


def test_a_floor_of_which_nothing_is_known_is_drawn_whole() -> None:
    blank = replace(
        grid(), occupancy=np.zeros((20, 30), np.uint8), regions=np.zeros((20, 30), np.uint16), region_ids=()
    )
    sheet = PlanSheet("x", Partition(1, 1, (Floor(0, 0.0, None, 0.0),)), Floor(0, 0.0, None, 0.0), blank, ())

    assert PlanFrame.around(blank, 20.0).size == (30, 20)
    assert Image.open(io.BytesIO(draw_floorplans([sheet]))).size[0] > 30


def test_a_scale_that_makes_too_large_a_picture_is_refused_and_a_large_floor_gets_a_smaller_one() -> None:
    (sheet,) = sheets(flat())
    with pytest.raises(InvalidInput, match="expected at most 6000"):
        draw_floorplans([sheet], PlanParams(pixels_per_metre=2000))
    occupancy = np.zeros((10, 2000), np.uint8)
    occupancy[5] = OCCUPIED
    hall = replace(grid(), occupancy=occupancy, regions=np.zeros_like(occupancy, np.uint16), region_ids=())

    page = Image.open(io.BytesIO(draw_floorplans([replace_grid(sheet, hall)])))

    assert 2700 < page.width <= 2800


def replace_grid(sheet: PlanSheet, cells: FloorGrid) -> PlanSheet:
    return PlanSheet(sheet.scene, Partition(1, 1, (sheet.floor,)), sheet.floor, cells, ())


def test_the_same_floor_gives_the_same_picture() -> None:
    (sheet,) = sheets(flat())
    assert draw_floorplans([sheet]) == draw_floorplans([sheet])


# Words


def boxes(words: PlanWords) -> list[Label]:
    return [*words.regions, *words.marks, *words.objects]


def check(words: PlanWords, frame: PlanFrame) -> None:
    for label in boxes(words):
        assert label.box[0] >= 0 and label.box[1] >= 0
        assert label.box[2] <= frame.size[0] and label.box[3] <= frame.size[1]
    for one, other in combinations(boxes(words), 2):
        assert not overlap(one.box, other.box)


@pytest.mark.parametrize("scale", [15.0, 30.0, 80.0, 160.0])
def test_words_never_cover_each_other_nor_leave_the_picture(scale: float) -> None:
    home = flat()
    home.upstairs = True
    home.frontiers = (Frontier(0, "r-bath", np.array([8.0, 1.0, 0.0]), 1.2),)
    for sheet in sheets(home):
        frame = PlanFrame.around(sheet.grid, scale)
        words = words_of(sheet, frame)
        check(words, frame)
        assert len(words.regions) == len(sheet.regions)


def test_a_name_with_its_area_stands_within_its_region_where_there_is_room() -> None:
    (sheet,) = sheets(flat())
    frame = PlanFrame.around(sheet.grid, 80.0)
    words = {label.lines[0].text: label for label in words_of(sheet, frame).regions}

    assert [line.text for line in words["kitchen"].lines] == ["kitchen", "9.0 m²"]
    assert [line.text for line in words["living room"].lines] == ["living room", "29 m²"]
    for region in sheet.regions:
        label = words[region.display_name]
        (ring,) = region.outlines
        low, high = frame.pixel(ring.min(axis=0)), frame.pixel(ring.max(axis=0))
        assert label.leader is None
        assert low[0] <= label.box[0] and label.box[2] <= high[0]
        assert high[1] <= label.box[1] and label.box[3] <= low[1]


def test_a_name_keeps_off_the_furniture_where_it_can() -> None:
    (sheet,) = sheets(flat())
    frame = PlanFrame.around(sheet.grid, 80.0)
    living = next(w for w in words_of(sheet, frame).regions if w.lines[0].text == "living room")

    for obj in sheet.objects:
        (x0, y1), (x1, y0) = frame.pixel(obj.box[:2]), frame.pixel(obj.box[3:5])
        assert not overlap(living.box, (x0, y0, x1, y1))


def test_a_region_too_small_for_its_name_is_named_beside_it_with_a_leader() -> None:
    cells = attic_grid()
    labels = cells.regions.copy()
    labels[40:46, 50:56] = 2
    ring = np.array([[2.4, 1.9], [2.7, 1.9], [2.7, 2.2], [2.4, 2.2]])
    closet = Region("r2", 1, "closet", "closet", 0.09, np.array([2.55, 2.05, 2.7]), (ring,), (), (), ())
    home = flat()
    home.upstairs = True
    partition = replace(home.partition(), regions=(*home.partition().regions, closet))
    sheet = PlanSheet(
        SCENE,
        partition,
        partition.floors[1],
        replace(cells, regions=labels, region_ids=("r-attic", "r2")),
        (),
    )
    frame = PlanFrame.around(sheet.grid, 80.0)
    words = words_of(sheet, frame)
    named = next(label for label in words.regions if label.lines[0].text.startswith("closet"))

    check(words, frame)
    assert named.lines[0].text == "closet, 0.1 m²"
    assert named.leader == pytest.approx(frame.pixel(np.array([2.55, 2.05])), abs=12)


def test_marks_say_how_wide_a_doorway_is_and_where_stairs_lead() -> None:
    home = flat()
    home.upstairs = True
    below, above = sheets(home)
    said = [
        {label.lines[0].text for label in words_of(s, PlanFrame.around(s.grid, 80.0)).marks}
        for s in (below, above)
    ]

    assert said == [{"0.9 m", "up to floor 1"}, {"down to floor 0"}]


def test_a_doorway_of_another_kind_has_no_mark() -> None:
    home = flat()
    (sheet,) = sheets(home)
    border = RegionEdge("r-living", "r-bath", 0.9, np.array([4.95, 1.65, 0.0]), EdgeKind.OPENING)
    opened = replace_partition(sheet, (border,))

    assert words_of(opened, PlanFrame.around(sheet.grid, 80.0)).marks == ()


def replace_partition(sheet: PlanSheet, edges: tuple[RegionEdge, ...]) -> PlanSheet:
    return PlanSheet(
        sheet.scene, replace(sheet.partition, edges=edges), sheet.floor, sheet.grid, sheet.objects
    )


def test_objects_stand_on_the_floor_of_their_region_or_the_next_below_them() -> None:
    home = flat()
    home.upstairs = True
    lamp = thing("o-901", "lamp", (1.0, 1.0, 3.0, 1.2, 1.2, 3.4), (9, 9, 9))
    cellar = thing("o-902", "crate", (1.0, 1.0, -1.0, 1.2, 1.2, -0.8), (9, 9, 9))
    home.objects = [*home.objects, lamp, cellar]
    below, above = sheets(home)

    assert [obj.object_id for obj in above.objects] == ["o-901"]
    assert len(below.objects) == 18
