"""Floors: which levels are storeys."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.types import F32
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.floors import find_storeys, storey_of
from tests.unit.services.regions.rooms import plane, room, seen


def test_one_room_is_one_storey_with_its_ceiling() -> None:
    (storey,) = find_storeys(seen((room((0, 3), (0, 3)), (1.5, 1.5, 1.2))))
    assert storey.z == pytest.approx(0.0, abs=0.02)
    assert storey.ceiling_z == pytest.approx(2.5, abs=0.02)
    assert (storey.low, storey.high) == (-np.inf, np.inf)


def test_a_table_seen_more_than_the_floor_is_not_the_floor() -> None:
    table = plane((0, 3), (0, 2), (0.72, 0.72))
    little_floor = plane((0, 0.6), (2, 2.6), (-0.005, -0.005))
    (storey,) = find_storeys(seen((np.concatenate([table, little_floor]), (1.0, 1.0, 1.4))))
    assert storey.z == pytest.approx(0.0, abs=0.02)


def test_a_ceiling_and_the_floor_above_it_are_told_apart() -> None:
    below = room((0, 3), (0, 3), height=2.6)
    above = room((0, 3), (0, 3), floor=2.9, height=2.5)
    storeys = find_storeys(seen((below, (1.5, 1.5, 1.2)), (above, (1.5, 1.5, 4.1))))
    assert [round(s.z, 1) for s in storeys] == [0.0, 2.9]
    assert [round(s.ceiling_z or 0, 1) for s in storeys] == [2.6, 5.4]
    assert storeys[0].high == storeys[1].low == pytest.approx(2.6, abs=0.02)


def test_a_level_that_nobody_stood_on_is_no_storey() -> None:
    gallery = plane((0, 3), (0, 3), (2.6, 2.6))
    storeys = find_storeys(
        seen((np.concatenate([room((0, 3), (0, 3), height=6.0), gallery]), (1.5, 1.5, 1.2)))
    )
    assert len(storeys) == 1


def test_nothing_seen_is_no_storey_and_a_lone_camera_is_one() -> None:
    assert find_storeys(FloorEvidence()) == ()
    (storey,) = find_storeys(seen((np.zeros((0, 3), np.float32), (0, 0, 1.2))))
    assert storey.z == pytest.approx(1.2)
    assert storey.ceiling_z is None


def test_scattered_heights_give_one_storey_near_the_lowest() -> None:
    heights = np.linspace(0.0, 1.0, 101)
    points = np.stack([np.ones(101), np.zeros(101), heights], axis=1).astype(np.float32)
    (storey,) = find_storeys(seen((points, (0, 0, 1.5))))
    assert storey.z < 0.3


def test_what_lies_between_two_floors_belongs_to_the_lower_one_until_close_under_the_upper() -> None:
    below, above = room((0, 3), (0, 3), height=2.6), room((0, 3), (0, 3), floor=2.9, height=2.5)
    storeys = find_storeys(seen((below, (1.5, 1.5, 1.2)), (above, (1.5, 1.5, 4.1))))
    assert storey_of(storeys, np.array([-5.0, 0.0, 2.5, 2.7, 9.0])).tolist() == [0, 0, 0, 1, 1]
    with pytest.raises(ValueError):
        storey_of((), np.zeros(1))


def floors(*views: tuple[F32, tuple[float, float, float]]) -> list[float]:
    """The heights of the storeys' floors, to a decimetre."""
    return [round(storey.z, 1) + 0.0 for storey in find_storeys(seen(*views))]


def raised(x: float, y: float, z: float, side: tuple[float, float]) -> F32:
    """A level piece of floor with one corner at x, y."""
    return plane((x, x + side[0]), (y, y + side[1]), (z, z))


HALL = room((0, 6), (0, 6), height=6.0)
GROUND = (HALL, (1.0, 1.0, 1.3))


def test_a_landing_half_way_up_is_no_storey_though_one_stands_on_it() -> None:
    landing = raised(4, 4, 1.4, (2, 1.0))
    upstairs = raised(0, 3, 2.8, (3, 3))
    assert floors(GROUND, (landing, (5, 4.5, 2.7)), (upstairs, (1.5, 4.5, 4.1))) == [0.0, 2.8]


def test_half_a_storey_of_a_floors_size_is_one_where_somebody_stood_on_it() -> None:
    half = raised(3, 3, 1.4, (3, 2.0))
    upstairs = raised(0, 3, 2.8, (3, 3))
    stood = ((half, (4, 4, 2.7)), (upstairs, (1.5, 4.5, 4.1)))
    assert floors(GROUND, *stood) == [0.0, 1.4, 2.8]
    assert floors(GROUND, (half, (1.0, 4, 2.7))) == [0.0]


def test_a_mezzanine_is_a_storey_and_a_large_landing_two_metres_up_is_what_its_area_says() -> None:
    assert floors(GROUND, (raised(2, 0, 2.4, (4, 2)), (3, 1, 3.7))) == [0.0, 2.4]
    assert floors(GROUND, (raised(4, 4, 2.1, (2, 1.5)), (5, 5, 3.4))) == [0.0]


def test_upstairs_is_a_storey_as_soon_as_eyes_on_the_stairs_are_above_its_floor() -> None:
    below = (room((0, 4), (0, 4), height=2.6), (1.0, 1.0, 1.3))
    little = raised(2, 4, 2.9, (1.2, 1.2))
    assert floors(below, (little, (2, 3, 3.2))) == [0.0, 2.9]
    assert floors(below, (little, (2, 3, 2.95))) == [0.0]


def test_the_ceiling_over_the_stairs_is_no_storey_to_who_stays_below() -> None:
    well = plane((4, 5), (0, 4), (5.4, 5.4))
    assert floors((np.concatenate([room((0, 4), (0, 4), height=2.6), well]), (2.0, 2.0, 1.3))) == [0.0]


def test_the_floor_below_a_gallery_is_a_storey_where_enough_of_it_was_seen_from_above() -> None:
    gallery = (raised(0, 0, 3.0, (4, 3)), (2.0, 1.0, 4.3))
    assert floors(gallery, (raised(4, 0, 0.0, (3, 3)), (2.0, 1.0, 4.3))) == [0.0, 3.0]
    assert floors(gallery, (raised(4, 0, 0.0, (1, 3)), (2.0, 1.0, 4.3))) == [3.0]


def test_a_ramp_is_no_storey() -> None:
    slope = plane((0, 24), (0, 3), (0, 0)).copy()
    slope[:, 2] = slope[:, 0] * 2.8 / 24
    ways = [(slope, (x, 1.5, x * 2.8 / 24 + 1.3)) for x in np.arange(1.0, 24.0, 3.0)]
    below = (raised(-6, 0, 0.0, (6, 3)), (-3.0, 1.5, 1.3))
    above = (raised(24, 0, 2.8, (6, 3)), (27.0, 1.5, 4.1))
    assert floors(below, *ways, above) == [0.0, 2.8]


def test_floors_may_lie_below_zero() -> None:
    cellar = (room((0, 3), (0, 3), floor=-2.7, height=2.4), (1.5, 1.5, -1.4))
    assert floors(cellar, (room((0, 3), (0, 3)), (1.5, 1.5, 1.2))) == [-2.7, 0.0]


@pytest.mark.parametrize("depth", [0.4, 0.2])
def test_a_sunken_living_room_is_part_of_its_storey_whose_floor_is_the_larger_one(depth: float) -> None:
    main, sunken = raised(0, 0, 0.0, (5, 4)), raised(5, 0, -depth, (3, 4))
    storeys = find_storeys(seen((main, (2.0, 2.0, 1.3)), (sunken, (6.5, 2.0, 1.3 - depth))))
    assert [storey.z for storey in storeys] == pytest.approx([0.0], abs=0.02)


def test_a_bed_seen_before_much_of_the_floor_is_not_the_floor() -> None:
    assert floors(
        (np.concatenate([raised(1, 0, 0.5, (2, 2)), raised(0, 0, 0.0, (1, 1))]), (-1.0, 0, 1.3))
    ) == [0.0]


def test_where_no_ceiling_was_seen_the_tops_of_walls_are_none() -> None:
    walls = [plane((0, 4), (0, 0), (0, 2.3)), plane((0, 0), (0, 4), (0, 2.3))]
    (storey,) = find_storeys(seen((np.concatenate([raised(0, 0, 0.0, (4, 4)), *walls]), (2.0, 2.0, 1.3))))
    assert storey.ceiling_z is None


def test_on_the_stairs_each_thing_goes_by_its_own_height() -> None:
    below, above = room((0, 3), (0, 3), height=2.6), room((0, 3), (0, 3), floor=2.9, height=2.5)
    storeys = find_storeys(seen((below, (1.5, 1.5, 1.2)), (above, (1.5, 1.5, 4.1))))
    treads = np.array([0.4, 1.4, 2.4])
    assert storey_of(storeys, treads).tolist() == [0, 0, 0]
    assert storey_of(storeys, treads + 1.3).tolist() == [0, 1, 1]


@settings(max_examples=15, deadline=None)
@given(st.integers(-90, 90), st.permutations(range(3)))
def test_the_order_of_frames_changes_nothing_and_whole_cells_of_shift_move_the_floors(
    cells: int, order: list[int]
) -> None:
    views = [
        GROUND,
        (raised(3, 3, 1.43, (3, 2.0)), (4, 4, 2.7)),
        (raised(0, 3, 2.83, (3, 3)), (1.5, 4.5, 4.1)),
    ]
    shift = np.array([0.0, 0.0, cells * CELL], np.float32)
    moved = [(views[at][0] + shift, tuple(np.array(views[at][1]) + shift)) for at in order]
    here, there = find_storeys(seen(*views)), find_storeys(seen(*moved))
    assert [round(storey.z, 2) for storey in here] == pytest.approx([0.0, 1.43, 2.83], abs=0.02)
    assert [s.z - cells * CELL for s in there] == pytest.approx([s.z for s in here], abs=0.011)
