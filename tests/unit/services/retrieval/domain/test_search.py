from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.scene.answers import Answer, Outcome, Query
from ovip.scene.building import Building
from ovip.scene.navigation import region_at
from ovip.scene.types import Partition
from services.retrieval.domain.coverage import View
from services.retrieval.domain.goals import NO_PATH
from services.retrieval.domain.schedule import ScheduleParams
from services.retrieval.domain.search import (
    Phase,
    Search,
    find_step,
    gave_up,
    give_up_rest,
    is_done,
    looked,
    next_step,
    plan,
    viewpoint_id,
)
from tests.unit.ovip.scene.buildings import building, stairs, storey
from tests.unit.services.retrieval.builders import grid_of, region, standing_in

# two rooms of 4 x 4 m side by side, a door between them, and a third one that is walled off
GRID = grid_of(
    "\n".join(
        [
            *["aaaaaaaa#bbbbbbbb#cccccccc"] * 3,
            *["aaaaaaaa.bbbbbbbb#cccccccc"] * 2,
            *["aaaaaaaa#bbbbbbbb#cccccccc"] * 3,
        ]
    ),
    0.5,
    {"a": "r1", "b": "r2", "c": "r3"},
)
REGIONS = (
    region("r1", "kitchen", (2.0, 2.0)),
    region("r2", "bedroom", (6.5, 2.0)),
    region("r3", "office", (11.0, 2.0)),
)
FLAT = standing_in(GRID)
PRIORS = {"r1": 0.1, "r2": 0.9, "r3": 0.5}
HOME = np.array([1.0, 1.0, 0.0])
NOTHING = Answer(Outcome.UNRESOLVED, 4, None, None, NO_PATH, ())


def started(regions=REGIONS, **changes) -> Search:
    waypoints = plan(regions, FLAT, HOME, 0)
    search = Search(
        "s1", Query("home", "mug"), Phase.SEARCHING, NOTHING, 0, PRIORS, waypoints, place=HOME, budget=999
    )
    return replace(search, **changes)


def view_at(search: Search, step) -> View:
    x, y = step.waypoint.position[:2]
    return View(0, float(x), float(y), 0.0, 1.0)


def walk(search: Search, steps: int, balance: float = 0.5) -> list[str]:
    visited = []
    for k in range(steps):
        step = next_step(search, REGIONS, FLAT, ScheduleParams(balance=balance))
        if step is None:
            break
        visited.append(viewpoint_id(step.waypoint, step.heading))
        search = looked(search, step, f"f{k:03d}", view_at(search, step), ())
    return visited


def region_of(search: Search, viewpoint: str) -> str:
    return find_step(search, viewpoint).waypoint.region_id


def test_the_plan_holds_only_places_that_the_robot_can_walk_to() -> None:
    search = started()
    assert {waypoint.region_id for waypoint in search.waypoints} == {"r1", "r2"}
    assert search.planned == 6 * len(search.waypoints)
    assert len({waypoint.waypoint_id for waypoint in search.waypoints}) == len(search.waypoints)


def test_without_a_known_place_every_region_is_planned() -> None:
    waypoints = plan(REGIONS, FLAT, None, 0)
    assert {waypoint.region_id for waypoint in waypoints} == {"r1", "r2", "r3"}


def test_no_grid_or_no_regions_no_plan() -> None:
    assert plan(REGIONS, Building(Partition(0, 0), {}, 0.25), HOME, 0) == ()
    assert plan((), FLAT, HOME, 0) == ()


def test_all_six_headings_are_taken_before_moving_on() -> None:
    search = started()
    order = walk(search, 12)
    assert [v.split(".")[1] for v in order] == ["0", "1", "2", "3", "4", "5"] * 2
    assert len({v.split(".")[0] for v in order[:6]}) == 1


def test_a_region_is_finished_before_the_next_one_begins() -> None:
    search = started()
    order = [region_of(search, v) for v in walk(search, search.planned)]
    assert len(order) == search.planned
    assert sum(a != b for a, b in pairwise(order)) == 1


def test_likelihood_or_distance_decides_the_first_region() -> None:
    search = started()
    assert region_of(search, walk(search, 1, balance=1.0)[0]) == "r2"
    assert region_of(search, walk(search, 1, balance=0.0)[0]) == "r1"


def test_inside_a_region_the_nearest_waypoint_comes_first() -> None:
    search = started()
    first = find_step(search, walk(search, 1, balance=0.0)[0]).waypoint
    inside = [w for w in search.waypoints if w.region_id == "r1"]
    nearest = min(inside, key=lambda w: float(np.linalg.norm(w.position - HOME)))
    assert np.linalg.norm(first.position - HOME) <= np.linalg.norm(nearest.position - HOME) + 0.5


def test_a_smaller_budget_is_a_prefix_of_a_larger_one() -> None:
    search = started()
    assert walk(replace(search, budget=7), 7) == walk(search, search.planned)[:7]


def test_an_observation_made_twice_changes_nothing() -> None:
    search = started()
    step = next_step(search, REGIONS, FLAT)
    assert step is not None
    once = looked(search, step, "f000", view_at(search, step), ())
    assert looked(once, step, "f001", view_at(search, step), ()) is once
    assert is_done(once, viewpoint_id(step.waypoint, step.heading))


def test_an_unreachable_place_loses_all_its_open_headings() -> None:
    search = started()
    step = next_step(search, REGIONS, FLAT)
    assert step is not None
    seen = looked(search, step, "f000", view_at(search, step), ())
    lost = gave_up(seen, step)
    assert len(lost.unreachable) == 5
    assert lost.visited == 1
    following = next_step(lost, REGIONS, FLAT)
    assert following is not None
    assert following.waypoint.waypoint_id != step.waypoint.waypoint_id


def test_giving_up_the_rest_leaves_nothing_open() -> None:
    done = give_up_rest(started())
    assert len(done.unreachable) == done.planned
    assert next_step(done, REGIONS, FLAT) is None


def test_another_floor_cannot_be_walked_to() -> None:
    assert next_step(started(floor=1), REGIONS, FLAT) is None


# a kitchen of 4.5 m x 1.5 m below, a bedroom as large above
TWO_FLOORS, GRIDS = building(
    [storey(*["kkkkkkkkk"] * 3), storey(*["bbbbbbbbb"] * 3, floor=1)],
    [stairs("k", "b", (0.25, 0.75, 0.0), (0.75, 0.75, 3.0))],
)


def upstairs_and_down(partition: Partition, place: np.ndarray) -> tuple[Search, Building]:
    home = Building(partition, GRIDS, 0.2)
    waypoints = plan(partition.regions, home, place, 0)
    search = started(waypoints=waypoints, place=place, priors={"rk": 0.1, "rb": 0.9})
    return search, home


def test_a_likelier_region_upstairs_is_searched_before_a_near_one() -> None:
    search, home = upstairs_and_down(TWO_FLOORS, np.array([0.75, 0.75, 0.0]))
    assert {waypoint.floor for waypoint in search.waypoints} == {0, 1}
    step = next_step(search, TWO_FLOORS.regions, home, ScheduleParams(balance=1.0))
    assert step is not None
    assert (step.waypoint.region_id, step.waypoint.position[2]) == ("rb", 3.0)
    near = next_step(search, TWO_FLOORS.regions, home, ScheduleParams(balance=0.0))
    assert near is not None
    assert near.waypoint.region_id == "rk"


def test_a_search_walks_through_both_storeys_and_back_needs_no_third_way() -> None:
    search, home = upstairs_and_down(TWO_FLOORS, np.array([0.75, 0.75, 0.0]))
    floors = []
    for k in range(search.planned):
        step = next_step(search, TWO_FLOORS.regions, home)
        assert step is not None
        floors.append(step.waypoint.floor)
        search = looked(search, step, f"f{k:03d}", view_at(search, step), ())
    assert next_step(search, TWO_FLOORS.regions, home) is None
    assert set(floors) == {0, 1}
    assert sum(a != b for a, b in pairwise(floors)) == 1


def test_a_storey_that_no_stairs_lead_to_is_planned_and_cannot_be_reached() -> None:
    parted = replace(TWO_FLOORS, edges=())
    search, home = upstairs_and_down(parted, np.array([0.75, 0.75, 0.0]))
    assert {waypoint.floor for waypoint in search.waypoints} == {0, 1}
    for k in range(search.planned):
        step = next_step(search, parted.regions, home)
        if step is None:
            break
        assert step.waypoint.floor == 0
        search = looked(search, step, f"f{k:03d}", view_at(search, step), ())
    assert {w.floor for w in search.waypoints if search.open_at(w)} == {1}


def test_every_waypoint_lies_in_the_region_that_it_names() -> None:
    search, _ = upstairs_and_down(TWO_FLOORS, np.array([0.75, 0.75, 0.0]))
    named = [waypoint.region_id for waypoint in search.waypoints]
    assert named == [region_at(TWO_FLOORS, GRIDS, waypoint.position) for waypoint in search.waypoints]


def test_a_viewpoint_that_was_not_given_out_is_refused() -> None:
    with pytest.raises(InvalidInput, match="w999"):
        find_step(started(), "w999.0")
