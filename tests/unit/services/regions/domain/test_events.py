"""Region events: what became of each region."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ovip.scene.grid import FREE, FloorGrid
from ovip.scene.types import Floor, Partition, Region, RegionEvent, RegionEventKind
from services.regions.domain.events import events_between

APPEARED, VANISHED = RegionEventKind.APPEARED, RegionEventKind.VANISHED
RETYPED, RESHAPED = RegionEventKind.RETYPED, RegionEventKind.RESHAPED
Scene = tuple[Partition, tuple[FloorGrid, ...]]
NOTHING: Scene = (Partition(0, 0), ())


def scene(*floors: tuple[float, str], **functions: str) -> Scene:
    """Floors by height, each one row of cells with a letter for each region, "." for none, and functions other
    than the letter."""
    grids, regions = [], []
    for number, (_, row) in enumerate(floors):
        ids = tuple(sorted(set(row) - {"."}))
        labels = np.array([[ids.index(c) + 1 if c != "." else 0 for c in row]], np.uint16)
        grids.append(FloorGrid(number, (0.0, 0.0), 1.0, np.full(labels.shape, FREE, np.uint8), labels, ids))
        regions += [region(name, number, functions.get(name, name)) for name in ids]
    heights = tuple(Floor(number, z, None, 1.0) for number, (z, _) in enumerate(floors))
    return Partition(0, 1, heights, tuple(regions)), tuple(grids)


def region(name: str, floor: int, function: str) -> Region:
    return Region(name, floor, function, f"{function}!", 1.0, np.zeros(3), (), (), (), ())


def between(before: Scene, after: Scene) -> list[tuple[RegionEventKind, str, str]]:
    return [(e.kind, e.region_id, e.other) for e in events_between(*before, *after)]


def test_the_first_regions_appear_from_nowhere() -> None:
    assert between(NOTHING, scene((0.0, "aab"))) == [(APPEARED, "a", ""), (APPEARED, "b", "")]


def test_what_stays_as_it_was_is_no_event() -> None:
    assert between(scene((0.0, "aab.")), scene((0.0, "aab."))) == []


def test_an_event_tells_floor_and_display_name() -> None:
    (event,) = events_between(*scene((0.0, "a")), *scene((0.0, "a"), a="den"))
    assert event == RegionEvent(RETYPED, "a", 0, "den!", "")


def test_a_split_tells_where_the_new_part_came_from() -> None:
    assert between(scene((0.0, "aaaaa")), scene((0.0, "aaabb"))) == [
        (APPEARED, "b", "a"),
        (RESHAPED, "a", ""),
    ]


def test_a_merge_tells_where_the_old_part_went() -> None:
    assert between(scene((0.0, "aaabb")), scene((0.0, "aaaaa"))) == [
        (RESHAPED, "a", ""),
        (VANISHED, "b", "a"),
    ]


def test_a_region_on_floor_that_was_in_none_came_from_none_though_it_touches_another() -> None:
    assert between(scene((0.0, "aaaaaaaaaa....")), scene((0.0, "aaaaaaaaabbb..")))[0] == (APPEARED, "b", "")


def test_where_as_much_came_from_a_region_as_from_none_it_came_from_the_region() -> None:
    assert between(scene((0.0, "aaaaaaaaaa....")), scene((0.0, "aaaaaaaaabb...")))[0] == (APPEARED, "b", "a")


def test_a_region_whose_floor_is_gone_went_nowhere() -> None:
    assert between(scene((0.0, "aabbb")), scene((0.0, "aa..a")))[-1] == (VANISHED, "b", "")


def test_a_tenth_of_its_floor_come_or_gone_does_not_reshape_a_region_and_more_does() -> None:
    ten = scene((0.0, "aaaaaaaaaa."))
    assert between(ten, scene((0.0, "aaaaaaaaaaa"))) == []
    assert between(ten, scene((0.0, "aaaaaaaaa.."))) == []
    assert between(ten, scene((0.0, "aaaaaaaaa.a"))) == [(RESHAPED, "a", "")]


def test_a_region_may_be_given_another_function_and_another_shape_at_once() -> None:
    assert between(scene((0.0, "a.")), scene((0.0, "aa"), a="den")) == [
        (RETYPED, "a", ""),
        (RESHAPED, "a", ""),
    ]


def test_floors_are_compared_by_height_when_one_is_found_below() -> None:
    before = scene((0.0, "aab"))
    assert between(before, scene((-2.8, "ccc"), (0.02, "aab"))) == [(APPEARED, "c", "")]


def test_a_floor_that_goes_takes_its_regions_with_it() -> None:
    assert between(scene((0.0, "aa"), (2.9, "b")), scene((0.0, "aa"))) == [(VANISHED, "b", "")]


ROW = st.text(alphabet="abcd.", min_size=12, max_size=12)


@given(ROW, ROW)
def test_every_region_that_comes_or_goes_is_told_of_once_and_the_way_back_mirrors_it(
    one: str, two: str
) -> None:
    there, back = between(scene((0.0, one)), scene((0.0, two))), between(scene((0.0, two)), scene((0.0, one)))
    appeared, vanished = set(two) - set(one) - {"."}, set(one) - set(two) - {"."}
    assert sorted(name for kind, name, _ in there if kind is APPEARED) == sorted(appeared)
    assert sorted(name for kind, name, _ in there if kind is VANISHED) == sorted(vanished)
    assert [(name, other) for kind, name, other in there if kind is APPEARED] == [
        (name, other) for kind, name, other in back if kind is VANISHED
    ]
    assert between(scene((0.0, one)), scene((0.0, one))) == []
