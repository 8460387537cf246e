from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.errors import InvalidInput
from ovip.scene.building import Building
from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.navigation import inflated, plan_route, region_at
from ovip.scene.walking import distance_field, path_length, traversable
from tests.unit.ovip.scene.buildings import building, door, stairs, storey

OCCUPANCIES = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 8), st.integers(1, 8)),
    elements=st.sampled_from([UNKNOWN, FREE, FREE, FREE, OCCUPIED]),
)
# a hall and a kitchen with a doorway between them, 2 m x 1.5 m each; a bedroom 4.5 m long above
DOWN = storey("hhhh#kkkk", "hhhhhkkkk", "hhhh#kkkk")
UP = storey("bbbbbbbbb", floor=1)
DOORWAY = door("h", "k", 2.5, 0.75)
STEEP = stairs("h", "b", (0.25, 1.25, 0.0), (0.25, 0.25, 3.0))
GENTLE = stairs("h", "b", (0.25, 0.25, 0.0), (4.25, 0.25, 3.0))


def at(x: float, y: float, z: float = 0.0) -> np.ndarray:
    return np.array([x, y, z])


def test_inflation_closes_what_is_nearer_than_the_radius_and_leaves_unknown_alone() -> None:
    grid = inflated(storey("#...?"), 0.75)
    assert grid.occupancy.tolist() == [[OCCUPIED, OCCUPIED, FREE, FREE, UNKNOWN]]
    assert inflated(DOWN, 0.0).occupancy.tolist() == DOWN.occupancy.tolist()
    assert grid.regions.tolist() == [[0, 0, 0, 0, 0]]


@pytest.mark.parametrize("radius", [-0.1, np.nan, np.inf, 2.01])
def test_no_robot_has_such_a_radius(radius: float) -> None:
    with pytest.raises(InvalidInput, match="0 to 2 metres"):
        inflated(DOWN, radius)
    with pytest.raises(InvalidInput, match="0 to 2 metres"):
        plan_route(*building([DOWN]), at(0, 0), at(1, 1), radius)


@settings(max_examples=60, deadline=None)
@given(OCCUPANCIES, st.floats(0.0, 1.0))
def test_a_point_may_stand_on_the_inflated_grid_where_the_robot_may_on_the_grid(
    occupancy: np.ndarray, radius: float
) -> None:
    grid = FloorGrid(0, (0.0, 0.0), 0.25, occupancy, np.zeros(occupancy.shape, np.uint16))
    point = traversable(inflated(grid, radius), 0.0)
    assert point.tolist() == traversable(grid, radius).tolist()


def test_the_way_through_the_doorway_names_both_rooms_and_the_doorway() -> None:
    route = plan_route(*building([DOWN], [DOORWAY]), at(0.25, 0.75), at(4.25, 0.75), 0.2)
    assert route.path.tolist() == [[0.25, 0.75, 0.0], [4.25, 0.75, 0.0]]
    assert route.length == pytest.approx(4.0)
    assert route.region_ids == ("rh", "rk")
    assert [passage.kind for passage in route.passages] == ["doorway"]
    assert (route.why, route.revision) == ("", 3)


def test_a_region_that_is_only_brushed_is_not_walked_through() -> None:
    brushed = storey("hhhhhhhhhhhhkhhhhhhhhhhh", "kkkkkkkkkkkkkkkkkkkkkkkk", resolution=0.1)
    route = plan_route(*building([brushed]), at(0.05, 0.05), at(2.35, 0.05), 0.0)
    assert route.region_ids == ("rh",)


def test_a_way_around_furniture_turns_at_its_corners() -> None:
    table = storey("kkkkk", "kkKkk", "kkKkk", resolution=1.0)
    route = plan_route(*building([table]), at(0.5, 2.5), at(4.5, 2.5), 0.0)
    assert route.path.tolist() == [[0.5, 2.5, 0], [1.5, 0.5, 0], [3.5, 0.5, 0], [4.5, 2.5, 0]]
    assert route.length == pytest.approx(2.0 + 2 * np.sqrt(5.0))


def test_another_floor_is_reached_over_the_stairs() -> None:
    route = plan_route(*building([DOWN, UP], [DOORWAY, GENTLE]), at(1.75, 0.25), at(0.25, 0.25, 3.0), 0.0)
    assert route.length == pytest.approx(1.5 + 5.0 + 4.0)
    assert route.path[[0, -1]].tolist() == [[1.75, 0.25, 0.0], [0.25, 0.25, 3.0]]
    assert GENTLE.position.tolist() in route.path.tolist()
    assert route.region_ids == ("rh", "rb")
    assert [passage.kind for passage in route.passages] == ["stairs"]


def test_of_several_stairs_those_of_the_shortest_whole_way_are_taken() -> None:
    partition, grids = building([DOWN, UP], [GENTLE, STEEP])
    near_foot = plan_route(partition, grids, at(1.75, 0.25), at(0.25, 0.25, 3.0), 0.0)
    assert [p is STEEP for p in near_foot.passages] == [True]
    assert near_foot.length == pytest.approx(np.hypot(1.5, 1.0) + np.hypot(1.0, 3.0))
    near_head = plan_route(partition, grids, at(0.25, 0.25), at(4.25, 0.25, 3.0), 0.0)
    assert [p is GENTLE for p in near_head.passages] == [True]
    assert near_head.length == pytest.approx(5.0)


def test_the_way_down_leads_through_the_same_places_as_the_way_up() -> None:
    partition, grids = building([DOWN, UP], [DOORWAY, GENTLE])
    up = plan_route(partition, grids, at(4.25, 0.75), at(0.25, 0.25, 3.0), 0.0)
    down = plan_route(partition, grids, at(0.25, 0.25, 3.0), at(4.25, 0.75), 0.0)
    home = Building(partition, grids, 0.0)
    assert home.distances((0, 1, 8))[1][0, 0] == pytest.approx(home.distances((1, 0, 0))[0][1, 8])
    assert (up.region_ids, down.region_ids) == (("rk", "rh", "rb"), ("rb", "rh", "rk"))
    assert [p.kind for p in down.passages] == ["stairs", "doorway"]


def test_rooms_parted_on_one_floor_are_joined_over_another() -> None:
    parted = storey("hhhh#kkkk", "hhhh#kkkk")
    other = stairs("k", "b", (4.25, 0.25, 0.0), (4.25, 0.25, 3.0))
    over = stairs("h", "b", (0.25, 0.25, 0.0), (0.25, 0.25, 3.0))
    route = plan_route(*building([parted, UP], [over, other]), at(0.25, 0.25), at(4.25, 0.25), 0.0)
    assert route.region_ids == ("rh", "rb", "rk")
    assert route.length == pytest.approx(3.0 + 4.0 + 3.0)


def test_ends_on_furniture_move_beside_it() -> None:
    table = storey("kkkkKKk")
    route = plan_route(*building([table]), at(0.25, 0.25), at(2.25, 0.25), 0.0)
    assert route.path[-1].tolist() == [1.75, 0.25, 0.0]


def test_a_goal_that_can_be_stood_on_does_not_move_to_this_side_of_a_wall() -> None:
    route = plan_route(*building([storey("hhh#kkk")]), at(0.25, 0.25), at(2.25, 0.25), 0.0)
    assert not len(route.path)
    assert route.why == "no floor that was seen leads from the hall to the kitchen"


def test_without_a_grid_there_is_no_way() -> None:
    partition, _ = building([DOWN])
    assert plan_route(partition, {}, at(0, 0), at(1, 1), 0.2).why == "the scene has no floor grid yet"


@pytest.mark.parametrize(("far", "what"), [(at(9.0, 0.0), "start"), (at(0.0, -5.0), "goal")])
def test_an_end_far_from_any_floor_is_named(far: np.ndarray, what: str) -> None:
    ends = (far, at(0.25, 0.25)) if what == "start" else (at(0.25, 0.25), far)
    route = plan_route(*building([DOWN]), *ends, 0.2)
    assert route.why.startswith(f"the {what} is not within 2 m of floor")
    assert (route.length, route.region_ids, route.passages) == (0.0, (), ())


def test_a_place_belongs_to_the_nearest_region_of_its_storey() -> None:
    partition, grids = building([DOWN, UP])
    assert region_at(partition, grids, at(0.3, 0.3, 1.2)) == "rh"
    assert region_at(partition, grids, at(3.9, 0.3, 1.2)) == "rk"
    assert region_at(partition, grids, at(2.3, 0.1, 0.0)) in ("rh", "rk")
    assert region_at(partition, grids, at(-7.0, 0.3, 0.0)) == "rh"
    assert region_at(partition, grids, at(0.3, 0.3, 4.2)) == "rb"
    assert region_at(*building([storey("..")]), at(0.3, 0.3)) == ""
    assert region_at(partition, {}, at(0.3, 0.3)) == ""


@settings(max_examples=60, deadline=None)
@given(OCCUPANCIES, OCCUPANCIES, st.floats(0.0, 0.6), st.data())
def test_a_way_is_no_longer_than_the_fields_say_and_no_shorter_than_a_straight_line(
    lower: np.ndarray, upper: np.ndarray, radius: float, data: st.DataObject
) -> None:
    grids = [
        FloorGrid(k, (-1.0, 2.0), 0.5, cells, np.zeros(cells.shape, np.uint16))
        for k, cells in enumerate((lower, upper))
    ]
    ends = [
        np.append(
            grids[floor].xy_of(data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1))),
            3.0 * floor,
        )
        for floor, (rows, columns) in ((0, lower.shape), (data.draw(st.integers(0, 1)), (1, 1)))
    ]
    flight = stairs("x", "y", (-0.75, 2.25, 0.0), (-0.75, 2.25, 3.0), width=9.0)
    partition, by_floor = building(grids, [flight])
    route = plan_route(partition, by_floor, *ends, radius)
    assert bool(route.why) == (not len(route.path))
    if route.why:
        assert route.length == 0.0
        return
    home = Building(partition, by_floor, radius)
    first, last = home.spot_at(route.path[0]), home.spot_at(route.path[-1])
    assert first is not None
    assert last is not None
    walked = home.distances(first)[last[0]][last[1:]]
    assert route.length == pytest.approx(path_length(route.path))
    assert route.length <= walked + 1e-9
    assert route.length >= float(np.linalg.norm(route.path[0] - route.path[-1])) - 1e-9
    if first[0] == last[0] and not route.passages:
        own = distance_field(home.standing[first[0]], first[1:], 0.5)
        assert walked == pytest.approx(own[last[1:]])
