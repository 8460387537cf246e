from __future__ import annotations

import numpy as np

from ovip.scene.navigation import plan_route
from tests.unit.ovip.scene.buildings import building, door, stairs, storey

# two rooms of 2.5 m x 2.5 m with a doorway of one cell, 0.5 m, between them
ROOMS = storey("hhhhh#kkkkk", "hhhhh#kkkkk", "hhhhhhkkkkk", "hhhhh#kkkkk", "hhhhh#kkkkk")
DOORWAY = door("h", "k", 3.0, 1.25)
UP = storey("bbbbb", "bbbbb", "bbbbb", floor=1)
IN_HALL, IN_KITCHEN, ABOVE = np.array([0.75, 1.25, 0]), np.array([5.25, 1.25, 0]), np.array([0.75, 0.75, 3])


def why(*grids, edges=(), ends=(IN_HALL, IN_KITCHEN), radius: float = 0.2) -> str:
    return plan_route(*building(grids, edges), *ends, radius).why


def test_a_doorway_that_is_too_narrow_is_named_with_its_width() -> None:
    assert why(ROOMS, edges=[DOORWAY], radius=0.25) == ""
    assert why(ROOMS, edges=[DOORWAY], radius=0.4) == (
        "the doorway between hall and kitchen (0.50 m wide) leaves 0.50 m; a robot of 0.40 m radius needs 0.80 m"
    )


def test_furniture_in_a_wide_opening_is_said_by_what_it_leaves() -> None:
    rows = ["##########", "hhhhhkkkkk", *["hhhhHkkkkk"] * 5, "hhhhhkkkkk", "##########"]
    ends = (np.array([0.75, 2.25, 0]), np.array([4.25, 2.25, 0]))
    said = why(storey(*rows), edges=[door("h", "k", 2.5, 2.25, width=3.5)], ends=ends, radius=0.6)
    assert said == (
        "the doorway between hall and kitchen (3.50 m wide) leaves 0.50 m; a robot of 0.60 m radius needs 1.20 m"
    )


def test_a_narrow_way_away_from_every_doorway_is_named_by_its_place() -> None:
    assert why(ROOMS, radius=0.4) == (
        "the way at 2.8, 1.2 in the hall leaves 0.50 m; a robot of 0.40 m radius needs 0.80 m"
    )


def test_the_widest_way_counts_where_there_are_several() -> None:
    rows = ["hhhhh#kkkkk"] * 9
    rows[1] = rows[5] = rows[6] = rows[7] = "hhhhhhkkkkk"
    both = [door("h", "k", 3.0, 0.75), door("h", "k", 3.0, 3.25, width=1.5)]
    said = why(
        storey(*rows), edges=both, ends=(np.array([1.25, 3.25, 0]), np.array([4.25, 3.25, 0])), radius=0.8
    )
    assert said.startswith("the doorway between hall and kitchen (1.50 m wide) leaves 1.50 m")


def test_unseen_floor_between_two_rooms_is_no_way() -> None:
    parted = storey(*["hhhhh?kkkkk"] * 5)
    assert why(parted) == "no floor that was seen leads from the hall to the kitchen"
    one = storey(*["hhh#hh"] * 3)
    ends = (np.array([0.75, 0.75, 0]), np.array([2.75, 0.75, 0]))
    assert why(one, ends=ends) == "no floor that was seen leads from the start to the goal"


def test_floors_without_stairs_are_not_joined() -> None:
    said = "no stairs that were seen lead from floor 0 to floor 1"
    assert why(ROOMS, UP, edges=[DOORWAY], ends=(IN_HALL, ABOVE)) == said


def test_stairs_narrower_than_the_robot_are_named_with_their_width() -> None:
    narrow = stairs("h", "b", (0.75, 0.75, 0.0), (0.75, 0.75, 3.0), width=0.6)
    assert why(ROOMS, UP, edges=[narrow], ends=(IN_HALL, ABOVE), radius=0.3) == ""
    assert why(ROOMS, UP, edges=[narrow], ends=(IN_HALL, ABOVE), radius=0.4) == (
        "the stairs between hall and bedroom are 0.60 m wide; a robot of 0.40 m radius needs 0.80 m"
    )


def test_stairs_of_unknown_width_stop_nobody() -> None:
    unknown = stairs("h", "b", (0.75, 0.75, 0.0), (0.75, 0.75, 3.0), width=0.0)
    assert why(ROOMS, UP, edges=[unknown], ends=(IN_HALL, ABOVE), radius=0.4) == ""


def test_stairs_whose_landing_is_too_small_are_named() -> None:
    cramped = storey("b####", "bb###", "#b###", "#bbbb", "##bbb", "##bbb", floor=1)
    flight = stairs("h", "b", (0.75, 0.75, 0.0), (0.25, 0.25, 3.0), width=1.0)
    ends = (IN_HALL, np.array([1.75, 2.25, 3.0]))
    assert why(ROOMS, cramped, edges=[flight], ends=ends, radius=0.2) == ""
    assert why(ROOMS, cramped, edges=[flight], ends=ends, radius=0.4) == (
        "a robot of 0.40 m radius cannot stand at both ends of the stairs between hall and bedroom"
    )


def test_stairs_beyond_a_wall_are_out_of_reach_in_words() -> None:
    parted = storey(*["hhhhh#kkkkk"] * 5)
    up = stairs("k", "b", (5.25, 0.75, 0.0), (0.75, 0.75, 3.0))
    assert why(parted, UP, edges=[up], ends=(IN_HALL, ABOVE)) == (
        "no floor that was seen leads from the hall to the bedroom"
    )


def test_what_is_left_is_never_rounded_up_to_what_is_needed() -> None:
    # two walls whose ends stand askew: the best cell between is 0.075 m and 0.025 m off a corner, so 0.158 m are left
    rows = [
        "h" * 10 + ("#" if k < 10 else "h") + "h" + ("#" if k >= 14 else "h") + "h" * 10 for k in range(24)
    ]
    ends = (np.array([0.2, 0.2, 0.0]), np.array([0.95, 0.95, 0.0]))
    said = why(storey(*rows, resolution=0.05), ends=ends, radius=0.08)
    assert said.endswith("leaves 0.15 m; a robot of 0.08 m radius needs 0.16 m")
