"""Relations between things made of faces by hand: each cloud holds only what a camera could have seen of it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.boxes import box_of
from ovip.scene.types import F32, RelationKind
from services.mapper.domain.relations import Body, RelationParams, reach, relations_of

ON, IN, NEXT_TO, ATTACHED_TO = (
    RelationKind.ON,
    RelationKind.IN,
    RelationKind.NEXT_TO,
    RelationKind.ATTACHED_TO,
)
Corners = tuple[float, float, float, float, float, float]
VOXEL = 0.02


def block(*corners: float, faces: str = "xXyYzZ") -> F32:
    """Points every 2 cm on faces of a box: low x y z, then high; a small letter is a low face."""
    low, high = np.array(corners[:3]), np.array(corners[3:])
    axes = [
        np.linspace(lo, hi, max(2, round((hi - lo) / VOXEL) + 1)) for lo, hi in zip(low, high, strict=True)
    ]
    parts = []
    for face in faces:
        axis = "xyz".index(face.lower())
        at = [[(low if face.islower() else high)[axis]] if i == axis else axes[i] for i in range(3)]
        parts.append(np.stack(np.meshgrid(*at, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.concatenate(parts).astype(np.float32)


def body(name: str, *parts: F32) -> Body:
    points = np.concatenate(parts)
    return Body(name, name, box_of(points) if len(points) else np.zeros(6), points)


def without(points: F32, *corners: float) -> F32:
    """What a box does not hide."""
    hidden = (points > np.array(corners[:3])) & (points < np.array(corners[3:]))
    return points[~hidden.all(axis=1)]


def turned(one: Body, degrees: float) -> Body:
    """Turned about the z axis, its cloud and the box around it."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    points = (one.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])).astype(np.float32)
    return replace(one, box=box_of(points), points=points)


def told(one: Body, *others: Body, params: RelationParams | None = None) -> set[tuple[RelationKind, str]]:
    return {(relation.kind, relation.other_id) for relation in relations_of(one, others, params)}


def evidence(one: Body, kind: RelationKind, *others: Body) -> dict[str, float]:
    (found,) = [relation.evidence for relation in relations_of(one, others) if relation.kind is kind]
    return found


FLOOR = body("floor", block(-3, -3, 0, 3, 3, 0, faces="Z"))
TABLE = body(
    "table",
    without(block(0, 0, 0.75, 1.2, 0.8, 0.75, faces="Z"), 0.4, 0.3, 0.7, 0.5, 0.4, 0.8),
    block(0, 0, 0, 0.04, 0.04, 0.74, faces="xy"),
    block(1.16, 0, 0, 1.2, 0.04, 0.74, faces="Xy"),
)
CUP = body("cup", block(0.4, 0.3, 0.77, 0.5, 0.4, 0.87, faces="xyZ"))
SHELF = body(
    "shelf",
    block(0, 0, 0, 0.02, 0.3, 1.6, faces="xy"),
    block(0.98, 0, 0, 1.0, 0.3, 1.6, faces="Xy"),
    *(block(0, 0, z, 1.0, 0.08, z, faces="Z") for z in (0.1, 0.6, 1.1, 1.6)),
)
BOOK = body("book", block(0.4, 0.06, 0.61, 0.44, 0.26, 0.85, faces="xyZ"))
WALL = body("wall", block(-2, 3, 0, 2, 3, 2.5, faces="y"))
CEILING = body("ceiling", block(-2, -2, 2.5, 2, 2, 2.5, faces="z"))


def test_a_cup_is_on_the_table_around_it_though_the_table_beneath_was_never_seen() -> None:
    assert told(CUP, TABLE) == {(ON, "table")}
    found = evidence(CUP, ON, TABLE)
    assert found["gap"] == pytest.approx(0.02, abs=1e-6)
    assert found["support"] == 1.0


def test_a_cup_on_a_table_is_not_in_it_and_the_table_is_not_on_the_cup() -> None:
    assert told(TABLE, CUP) == set()


@pytest.mark.parametrize(("air", "is_on"), [(-0.04, True), (0.0, True), (0.07, True), (0.1, False)])
def test_a_bottom_may_hover_or_sink_a_little(air: float, is_on: bool) -> None:
    cup = body("cup", CUP.points + np.array([0, 0, air - 0.02], np.float32))
    assert ((ON, "table") in told(cup, TABLE)) is is_on


def test_a_cup_is_on_a_table_and_not_in_it_where_the_table_swallowed_its_points() -> None:
    swallowing = body("table", TABLE.points, CUP.points)
    assert told(CUP, swallowing) == {(ON, "table")}


def test_a_cup_is_not_on_the_plate_beside_it() -> None:
    plate = body("plate", block(0.51, 0.25, 0.79, 0.75, 0.45, 0.79, faces="Z"))
    assert told(CUP, plate) == {(NEXT_TO, "plate")}


def test_a_cup_on_a_table_is_not_next_to_the_drawer_under_it() -> None:
    drawer = body("drawer", block(0.45, 0, 0.55, 0.85, 0.04, 0.73, faces="yY"))
    cup = body("cup", CUP.points + np.array([0, -0.28, 0], np.float32))
    assert told(cup, TABLE, drawer) == {(ON, "table")}


def test_a_cup_on_a_tray_is_on_the_tray_alone() -> None:
    tray = body(
        "tray", without(block(0.3, 0.2, 0.77, 0.6, 0.5, 0.77, faces="Z"), 0.4, 0.3, 0.7, 0.5, 0.4, 0.8)
    )
    cup = body("cup", block(0.4, 0.3, 0.78, 0.5, 0.4, 0.88, faces="xyZ"))
    assert told(cup, TABLE, tray) == {(ON, "tray")}
    assert told(tray, TABLE, cup) == {(ON, "table")}


def test_a_box_stands_on_the_floor_before_a_wall_though_only_the_floor_in_front_shows() -> None:
    sofa = body("sofa", block(-1, 2.1, 0.02, 1, 2.98, 0.8, faces="yZ"))
    floor = body("floor", without(FLOOR.points, -1, 2.1, -1, 1, 3.1, 1))
    assert told(sofa, floor, WALL) == {(ON, "floor")}


def test_a_sofa_at_a_wall_is_not_attached_to_it_where_the_floor_is_not_mapped_either() -> None:
    assert told(body("sofa", block(-1, 2.1, 0.02, 1, 2.98, 0.8, faces="yZ")), WALL) == set()


def test_a_book_on_a_middle_board_is_on_the_shelf_and_in_it() -> None:
    assert told(BOOK, SHELF) == {(ON, "shelf"), (IN, "shelf")}
    assert evidence(BOOK, IN, SHELF)["inside"] == 1.0


def test_a_fruit_is_in_the_bowl_around_it() -> None:
    bowl = body("bowl", block(0, 0, 0, 0.3, 0.3, 0.1, faces="xXyY"), block(0.06, 0.06, 0, 0.24, 0.24, 0))
    fruit = body("fruit", block(0.1, 0.1, 0.05, 0.18, 0.18, 0.12, faces="xyZ"))
    assert (IN, "bowl") in told(fruit, bowl)
    assert evidence(fruit, IN, bowl)["sides"] == 5.0


def test_a_cushion_on_a_sofa_is_not_in_it() -> None:
    sofa = body(
        "sofa",
        block(0, 0, 0, 2, 0.9, 0.4, faces="yZ"),
        block(0, 0, 0.4, 0.2, 0.9, 0.6),
        block(1.8, 0, 0.4, 2, 0.9, 0.6),
        block(0, 0.7, 0.4, 2, 0.9, 0.9, faces="yZ"),
    )
    cushion = body("cushion", block(0.3, 0.4, 0.41, 0.7, 0.6, 0.75, faces="xXyZ"))
    assert told(cushion, sofa) == {(ON, "sofa")}


@pytest.mark.parametrize("depth", [0.2, 0.5])
def test_a_chair_half_under_a_table_is_next_to_it(depth: float) -> None:
    chair = body(
        "chair",
        block(0.3, depth - 0.5, 0.45, 0.8, depth, 0.45, faces="Z"),
        block(0.3, depth - 0.5, 0.45, 0.8, depth - 0.46, 0.95, faces="yY"),
        block(0.3, depth - 0.5, 0, 0.34, depth - 0.46, 0.45, faces="xy"),
        block(0.76, depth - 0.5, 0, 0.8, depth - 0.46, 0.45, faces="Xy"),
    )
    assert told(chair, TABLE) == {(NEXT_TO, "table")}
    assert told(TABLE, chair) == {(NEXT_TO, "chair")}


@pytest.mark.parametrize("degrees", [0, 30, 45, 200])
def test_a_picture_hangs_on_a_wall_that_shows_around_it_whichever_way_it_faces(degrees: float) -> None:
    wall = turned(body("wall", without(WALL.points, -0.3, 2, 1.2, 0.3, 4, 1.7)), degrees)
    picture = turned(body("picture", block(-0.3, 2.96, 1.2, 0.3, 2.98, 1.7, faces="yzZ")), degrees)
    assert told(picture, wall) == {(ATTACHED_TO, "wall")}
    assert evidence(picture, ATTACHED_TO, wall)["gap"] == pytest.approx(0.02, abs=0.005)
    assert evidence(picture, ATTACHED_TO, wall)["facing"] == 1.0
    assert told(wall, picture) == set()


def test_a_picture_that_leans_on_a_wall_from_a_sideboard_is_on_the_sideboard() -> None:
    sideboard = body("sideboard", block(-0.6, 2.6, 0, 0.6, 2.98, 0.8, faces="yZ"))
    picture = body("picture", block(-0.3, 2.94, 0.8, 0.3, 2.98, 1.3, faces="yZ"))
    assert told(picture, sideboard, WALL) == {(ON, "sideboard")}


def test_a_switch_is_attached_to_a_piece_of_wall_seen_from_both_sides_and_not_in_it() -> None:
    wall = body("wall", block(0, 3.01, 0, 1.2, 3.12, 2.0, faces="yY"))
    switch = body("switch", block(0.5, 3.0, 1.1, 0.58, 3.02, 1.18, faces="yzZ"))
    assert told(switch, wall) == {(ATTACHED_TO, "wall")}


def test_a_cupboard_that_hides_the_wall_below_it_may_stand_and_is_not_attached() -> None:
    cupboard = body("cupboard", block(-0.5, 2.6, 0.5, 0.5, 2.98, 1.2, faces="yZ"))
    assert told(cupboard, WALL) == {(ATTACHED_TO, "wall")}
    hidden = body("wall", without(WALL.points, -0.6, 2, -1, 0.6, 4, 1.2))
    assert told(cupboard, hidden) == set()


def test_a_lamp_hangs_from_the_ceiling() -> None:
    lamp = body("lamp", block(-0.2, -0.2, 2.2, 0.2, 0.2, 2.46, faces="xyz"))
    assert told(lamp, CEILING) == {(ATTACHED_TO, "ceiling")}
    assert evidence(lamp, ATTACHED_TO, CEILING)["gap"] == pytest.approx(0.04, abs=1e-6)
    assert told(body("lamp", lamp.points - np.array([0, 0, 0.3], np.float32)), CEILING) == set()


def test_a_bench_across_two_blocks_is_on_both_but_a_box_on_twice_mapped_ground_only_on_one() -> None:
    left = body("left", block(0, 0, 0, 0.5, 0.4, 0.4, faces="yZ"))
    right = body("right", block(0.7, 0, 0, 1.2, 0.4, 0.4, faces="yZ"))
    bench = body("bench", block(0, 0, 0.41, 1.2, 0.4, 0.41, faces="Z"))
    assert told(bench, left, right) == {(ON, "left"), (ON, "right")}
    again = replace(TABLE, object_id="table again")
    assert told(CUP, TABLE, again) == {(ON, "table")}
    assert told(CUP, again, TABLE) == {(ON, "table")}


def test_two_cups_on_a_table_are_next_to_each_other_and_not_to_the_table() -> None:
    other = body("other", CUP.points + np.array([0.3, 0, 0], np.float32))
    assert told(CUP, other, TABLE) == {(ON, "table"), (NEXT_TO, "other")}
    assert evidence(CUP, NEXT_TO, other, TABLE)["gap"] == pytest.approx(0.2, abs=1e-6)
    assert evidence(CUP, NEXT_TO, other, TABLE)["overlap"] == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize(("gap", "near"), [(0.0, True), (0.29, True), (0.31, False)])
def test_neighbours_are_as_near_as_the_limit(gap: float, near: bool) -> None:
    one = body("one", block(0, 0, 0, 0.5, 0.5, 0.5))
    other = body("other", block(0.5 + gap, 0, 0, 1.0 + gap, 0.5, 0.5))
    assert ((NEXT_TO, "other") in told(one, other)) is near


def test_a_cup_on_a_table_is_not_next_to_the_chair_beside_the_table() -> None:
    chair = body("chair", block(0.3, -0.5, 0, 0.8, -0.1, 0.9, faces="xXyZ"))
    cup = body("cup", block(0.5, 0.02, 0.77, 0.6, 0.1, 0.87, faces="xyZ"))
    assert told(cup, TABLE, chair) == {(ON, "table")}


def test_nothing_is_next_to_floor_wall_or_ceiling() -> None:
    box = body("box", block(0.5, 2.5, 0.01, 1.2, 2.9, 0.6, faces="xyZ"))
    assert told(box, FLOOR, WALL, CEILING) == {(ON, "floor")}
    for structure in (FLOOR, WALL, CEILING):
        assert told(structure, FLOOR, WALL, CEILING, box) == set()


def test_turned_things_are_apart_by_their_outlines_not_their_boxes() -> None:
    one = body("one", block(-1, 0, 0, 1, 0.3, 0.5))
    other = body("other", block(-1, 1.0, 0, 1, 1.3, 0.5))
    assert told(one, other) == set()
    assert told(turned(one, 45), turned(other, 45)) == set()
    close = body("other", block(-1, 0.5, 0, 1, 0.8, 0.5))
    assert told(turned(one, 45), turned(close, 45)) == {(NEXT_TO, "other")}
    assert evidence(turned(one, 45), NEXT_TO, turned(close, 45))["gap"] == pytest.approx(0.2, abs=0.05)


def test_two_copies_of_a_thing_neither_hold_one_another_nor_differ_in_what_they_say() -> None:
    for thing in (TABLE, CUP, SHELF, BOOK):
        copy = replace(thing, object_id="copy")
        assert told(thing, copy) <= {(NEXT_TO, "copy")}
        assert told(copy, thing) <= {(NEXT_TO, thing.object_id)}
        assert len(told(thing, copy)) == len(told(copy, thing))


def test_a_single_point_and_no_points_are_no_trouble() -> None:
    nothing = body("nothing", np.zeros((0, 3), np.float32))
    point = body("point", np.array([[0.2, 0.6, 0.76]], np.float32))
    assert told(nothing, TABLE) == set()
    assert told(CUP, nothing, TABLE) == {(ON, "table")}
    assert relations_of(CUP, ()) == ()
    assert relations_of(CUP, (CUP,)) == ()
    assert told(point, TABLE) == {(ON, "table")}


def test_others_out_of_reach_do_not_matter() -> None:
    limit = reach()
    assert limit == pytest.approx(0.3)
    far = body("far", block(0.5 + limit + 0.01, 0, 0, 1.5, 0.5, 0.5))
    assert told(body("one", block(0, 0, 0, 0.5, 0.5, 0.5)), far) == set()
    assert reach(RelationParams(beside=0.01, gap=0.5)) == 0.5


MADE: dict[str, Callable[[float], list[F32]]] = {
    "box": lambda size: [block(0, 0, 0, size, size, size, faces="xyZ")],
    "slab": lambda size: [block(0, 0, 0, 2 * size, size, 0.02, faces="Z")],
    "panel": lambda size: [block(0, 0, 0, 2 * size, 0.02, 3 * size, faces="y")],
    "tub": lambda size: [block(0, 0, 0, 2 * size, 2 * size, size, faces="xXyYz")],
    "cabinet": lambda size: [block(0, 0, 0, 2 * size, size, 2 * size, faces="xXYzZ")],
}
STEPS = st.integers(0, 6).map(lambda step: 0.1 * step)
THINGS = st.tuples(
    st.sampled_from(sorted(MADE)), st.sampled_from([0.1, 0.3, 0.5]), STEPS, STEPS, STEPS, st.integers(0, 3)
)


@st.composite
def scenes(draw: st.DrawFn) -> list[Body]:
    """Up to six things of every kind, turned by 0, 20, 40 or 60 degrees, touching, overlapping, equal or apart."""
    made = draw(st.lists(THINGS, min_size=2, max_size=6))
    return [
        body(
            str(i),
            turned(body("", *MADE[kind](size)), 20 * turn).points + np.array([x, y, z], np.float32),
        )
        for i, (kind, size, x, y, z, turn) in enumerate(made)
    ]


def all_told(things: Sequence[Body]) -> dict[tuple[str, str], set[RelationKind]]:
    found: dict[tuple[str, str], set[RelationKind]] = {}
    for thing in things:
        for relation in relations_of(thing, things):
            found.setdefault((thing.object_id, relation.other_id), set()).add(relation.kind)
    return found


@settings(max_examples=100, deadline=None)
@given(scenes())
def test_next_to_is_mutual_and_holding_is_not(things: list[Body]) -> None:
    found = all_told(things)
    for one, other in itertools.permutations([thing.object_id for thing in things], 2):
        here, there = found.get((one, other), set()), found.get((other, one), set())
        assert (NEXT_TO in here) == (NEXT_TO in there)
        assert not (here & {ON, IN} and there & {ON, IN})
        assert not (ATTACHED_TO in here and ATTACHED_TO in there)
        assert not (NEXT_TO in here and here & {ON, IN, ATTACHED_TO})
    assert all(one != other for one, other in found)


@settings(max_examples=40, deadline=None)
@given(scenes(), st.randoms())
def test_the_order_of_others_does_not_matter(things: list[Body], random: Random) -> None:
    mixed = list(things)
    random.shuffle(mixed)
    for thing in things:
        assert relations_of(thing, mixed) == relations_of(thing, things)


@settings(max_examples=40, deadline=None)
@given(scenes())
def test_others_within_reach_are_all_that_is_needed(things: list[Body]) -> None:
    for thing in things:
        low, high = thing.box[:3] - reach(), thing.box[3:] + reach()
        near = [other for other in things if (other.box[:3] <= high).all() and (other.box[3:] >= low).all()]
        assert relations_of(thing, near) == relations_of(thing, things)
