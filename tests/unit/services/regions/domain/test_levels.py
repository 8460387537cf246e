"""Levels: floors, table tops and ceilings among what was hit."""

from __future__ import annotations

import numpy as np
import pytest

from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.levels import Surfaces, count_near, find_levels, read_hit, tops, undersides
from tests.unit.services.regions.rooms import plane, room, seen

ROOM = seen((np.concatenate([room((0, 3), (0, 3)), plane((1, 2), (1, 2), (0.72, 0.72))]), (0.5, 0.5, 1.2)))


def layers(surfaces: Surfaces) -> set[int]:
    """The heights of the surfaces over the table's middle, in layers."""
    cubes = surfaces.between(-100, 200)
    return set(cubes[(cubes[:, 0] == 30) & (cubes[:, 1] == 30), 2].tolist())


def test_tops_have_room_for_a_person_above_them_and_undersides_below() -> None:
    hit = read_hit(ROOM.hits)
    assert layers(tops(hit)) == {14, 50}  # the table and the ceiling; the floor under the table is no top
    assert layers(undersides(hit)) == {0, 50}


def test_levels_are_the_floor_and_the_table_but_not_the_walls() -> None:
    levels = find_levels(tops(read_hit(ROOM.hits)), ROOM.heights_below)
    assert [level.z for level in levels[:2]] == pytest.approx([0.0, 0.72], abs=0.02)
    assert [level.area for level in levels[:2]] == pytest.approx([8.0, 1.0], abs=0.5)
    assert len(levels) == 3


def test_a_slope_is_no_level() -> None:
    slope = plane((0, 12), (0, 3), (0, 0)).copy()
    slope[:, 2] = slope[:, 0] / 8
    evidence = seen(*((slope, (x, 1.5, x / 8 + 1.3)) for x in (2.0, 6.0, 10.0)))
    assert find_levels(tops(read_hit(evidence.hits)), evidence.heights_below) == ()


def test_a_part_of_the_heights_gives_the_tops_of_that_part() -> None:
    whole, part = tops(read_hit(ROOM.hits)), tops(read_hit(ROOM.hits, 10, 20))
    assert part.between(10, 20).tolist() == whole.between(10, 20).tolist() != []


def test_a_surface_tells_which_cubes_are_its_own() -> None:
    found = tops(read_hit(ROOM.hits))
    assert found.at(np.array([[30, 30, 14], [30, 30, 13], [30, 30, 0], [900, 0, 0]])).tolist() == [
        True,
        False,
        False,
        False,
    ]
    low, counts = found.by_layer()
    assert counts.sum() == len(found.between(-100, 200))
    assert counts[14 - low] == np.count_nonzero(found.between(14, 15)[:, 2] == 14)


def test_nothing_hit_has_no_levels() -> None:
    empty = FloorEvidence()
    assert find_levels(tops(read_hit(empty.hits)), empty.heights_below) == ()
    assert not tops(read_hit(empty.hits)).at(np.zeros((1, 3), np.int64)).any()


def test_points_near_a_height_are_counted_on_both_sides() -> None:
    assert count_near(ROOM.heights_below, 0.72, CELL) >= 625  # a metre of points 4 cm apart, and some wall
    assert count_near(ROOM.heights_above, 0.72, CELL) == 0
