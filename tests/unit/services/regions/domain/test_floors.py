"""Floors: which levels are storeys."""

from __future__ import annotations

import numpy as np
import pytest

from services.regions.domain.evidence import FloorEvidence
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
