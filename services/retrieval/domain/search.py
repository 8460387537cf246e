"""Tier 4's search as a value: its plan, what has been looked at, and the next viewpoint (CARA, SPEC 4).

Everything that a replica needs to go on is in `Search`; every step makes a new one. The order of viewpoints
depends on the plan and on where the robot has been, never on the budget, so half a budget is an exact prefix
of the whole.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.answers import Answer, Query
from ovip.scene.building import Building
from ovip.scene.types import F64, Bools, Region
from services.retrieval.domain.coverage import View, region_cells
from services.retrieval.domain.schedule import ScheduleParams, nearest, next_region
from services.retrieval.domain.viewpoints import HEADINGS, ViewpointParams, plan_waypoints, snap
from services.retrieval.domain.votes import Sighting

SNAP_METRES = 2.0
"""Metres within which a robot's place must be near floor to stand on."""


class Phase(StrEnum):
    """CASCADE: tiers 1 to 3 are still to run. SEARCHING: viewpoints are being visited. DONE: there is an
    answer.
    """

    CASCADE = "cascade"
    SEARCHING = "searching"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A place to stand. position: `(3,)` on the floor, metres."""

    waypoint_id: str
    region_id: str
    floor: int
    position: F64


@dataclass(frozen=True, slots=True)
class Search:
    """A search in all that is needed to go on with it.

    account: the answer so far (reports, rejected candidates, fallbacks, versions). seen: viewpoint id ->
    frame id. blind: frames whose grounder may have no way to see the target. place: `(3,)` where the robot
    is, floor position. budget: viewpoints that may be visited.
    """

    search_id: str
    query: Query
    phase: Phase
    account: Answer
    vlm_calls: int = 0
    priors: Mapping[str, float] | None = None
    waypoints: tuple[Waypoint, ...] = ()
    seen: Mapping[str, str] | None = None
    unreachable: frozenset[str] = frozenset()
    views: tuple[View, ...] = ()
    sightings: tuple[Sighting, ...] = ()
    blind: int = 0
    place: F64 | None = None
    floor: int = 0
    budget: int = 0

    @property
    def planned(self) -> int:
        """Number of viewpoints of the plan."""
        return len(self.waypoints) * len(HEADINGS)

    @property
    def visited(self) -> int:
        """Number of viewpoints looked from."""
        return len(self.seen or {})

    @property
    def remaining(self) -> int:
        """Number of viewpoints neither looked from nor given up."""
        return self.planned - self.visited - len(self.unreachable)

    def open_at(self, waypoint: Waypoint) -> tuple[int, ...]:
        """Headings of a waypoint that are neither seen nor unreachable."""
        done = (self.seen or {}).keys() | self.unreachable
        return tuple(k for k in range(len(HEADINGS)) if viewpoint_id(waypoint, k) not in done)


@dataclass(frozen=True, slots=True)
class Step:
    """The next viewpoint: a waypoint and the index of a heading."""

    waypoint: Waypoint
    heading: int


def viewpoint_id(waypoint: Waypoint, heading: int) -> str:
    """`w007.2`: third heading of the eighth waypoint."""
    return f"{waypoint.waypoint_id}.{heading}"


def plan(
    regions: Sequence[Region],
    building: Building,
    place: F64 | None,
    floor: int,
    params: ViewpointParams | None = None,
) -> tuple[Waypoint, ...]:
    """Waypoints that cover the regions, region by region.

    On the robot's own floor, and on those that it gets to over stairs, only places that it can walk to count; on
    others every place where it could stand.
    """
    standing = reachable(building, place, floor)
    waypoints: list[Waypoint] = []
    for region in regions:
        grid = building.grids.get(region.floor)
        if grid is None:
            continue
        cells = plan_waypoints(grid, region_cells(grid, region.region_id), standing[region.floor], params)
        for row, column in cells:
            position = building.position((region.floor, row, column))
            waypoints.append(Waypoint(f"w{len(waypoints):03d}", region.region_id, region.floor, position))
    return tuple(waypoints)


def reachable(building: Building, place: F64 | None, floor: int) -> dict[int, Bools]:
    """By storey, cells where the robot can stand and, where there is a way to the storey, walk to -> `(R, C)`."""
    fields = walked(building, place, floor)
    if fields is None:
        return dict(building.standing)
    cells = {level: np.isfinite(field) for level, field in fields.items()}
    return {level: mask if mask.any() else building.standing[level] for level, mask in cells.items()}


def walked(building: Building, place: F64 | None, floor: int) -> dict[int, F64] | None:
    """Metres walked from a place to every cell, by storey; None where it is not known or nowhere near floor."""
    if place is None or floor not in building.grids:
        return None
    start = building.nearest(place, floor, SNAP_METRES)
    return None if start is None else building.distances(start)


def next_step(
    search: Search,
    regions: Sequence[Region],
    building: Building,
    params: ScheduleParams | None = None,
) -> Step | None:
    """The next heading at this waypoint, else the nearest waypoint of this region, else of the next region
    (Eq. 7).

    None where nothing that is left can be reached.
    """
    left = [waypoint for waypoint in search.waypoints if search.open_at(waypoint)]
    if not left:
        return None
    here = _last_waypoint(search)
    if here is not None and here in left:
        return Step(here, search.open_at(here)[0])
    walk = _Walk(search.floor, building, walked(building, search.place, search.floor))
    if here is not None and (step := _nearest_of(search, left, here.region_id, walk)) is not None:
        return step
    return _in_next_region(search, left, regions, walk, params)


def find_step(search: Search, wanted: str) -> Step:
    """The planned viewpoint of that id; InvalidInput where the plan has none."""
    for waypoint in search.waypoints:
        for heading in range(len(HEADINGS)):
            if viewpoint_id(waypoint, heading) == wanted:
                return Step(waypoint, heading)
    raise InvalidInput(f"viewpoint_id: expected one that search {search.search_id} gave out, got {wanted!r}")


def is_done(search: Search, wanted: str) -> bool:
    """Whether a viewpoint has been looked from or given up."""
    return wanted in (search.seen or {}) or wanted in search.unreachable


def looked(
    search: Search, step: Step, frame_id: str, view: View, sightings: Sequence[Sighting], blind: int = 0
) -> Search:
    """The search after a frame was taken; the same search where that viewpoint was already done."""
    wanted = viewpoint_id(step.waypoint, step.heading)
    if is_done(search, wanted):
        return search
    return replace(
        search,
        seen={**(search.seen or {}), wanted: frame_id},
        views=(*search.views, view),
        sightings=(*search.sightings, *sightings),
        blind=search.blind + blind,
        place=np.array([view.x, view.y, step.waypoint.position[2]]),
        floor=step.waypoint.floor,
    )


def gave_up(search: Search, step: Step) -> Search:
    """The search after a place turned out unreachable: all its open headings are given up."""
    lost = {viewpoint_id(step.waypoint, heading) for heading in search.open_at(step.waypoint)}
    return replace(search, unreachable=search.unreachable | lost)


def give_up_rest(search: Search) -> Search:
    """The search with every viewpoint that is left given up as unreachable."""
    lost = {viewpoint_id(w, heading) for w in search.waypoints for heading in search.open_at(w)}
    return replace(search, unreachable=search.unreachable | lost)


def _last_waypoint(search: Search) -> Waypoint | None:
    """The waypoint of the viewpoint seen last; None before the first."""
    if not search.seen:
        return None
    *_, last = search.seen
    return next((w for w in search.waypoints if last.startswith(f"{w.waypoint_id}.")), None)


@dataclass(frozen=True, slots=True)
class _Walk:
    """Metres walked from where the robot is, over stairs too; without fields every place of its floor counts as
    near.
    """

    floor: int
    building: Building
    fields: Mapping[int, F64] | None

    def to(self, xy: F64, floor: int, slack: float = 0.0) -> float:
        """Metres to a place; infinite without a way. slack: metres it may be off."""
        if self.fields is None:
            return 0.0 if floor == self.floor else float("inf")
        if floor not in self.fields:
            return float("inf")
        grid, field = self.building.grids[floor], self.fields[floor]
        row, column = grid.cell_of(xy)
        inside = 0 <= row < field.shape[0] and 0 <= column < field.shape[1]
        if inside and (np.isfinite(field[row, column]) or not slack):
            return float(field[row, column])
        near = snap(np.isfinite(field), (row, column), slack / grid.resolution)
        return float("inf") if near is None else float(field[near])


def _nearest_of(search: Search, left: Sequence[Waypoint], region_id: str, walk: _Walk) -> Step | None:
    inside = [waypoint for waypoint in left if waypoint.region_id == region_id]
    k = nearest([walk.to(waypoint.position[:2], waypoint.floor, 0.5) for waypoint in inside])
    return None if k is None else Step(inside[k], search.open_at(inside[k])[0])


def _in_next_region(
    search: Search,
    left: Sequence[Waypoint],
    regions: Sequence[Region],
    walk: _Walk,
    params: ScheduleParams | None,
) -> Step | None:
    waiting = {waypoint.region_id for waypoint in left}
    options = [region for region in regions if region.region_id in waiting]
    while options:
        # a region whose waypoints cannot be reached is as far as its own nearest waypoint
        away = [_region_distance(region, left, walk) for region in options]
        k = next_region([(search.priors or {}).get(r.region_id, 0.0) for r in options], away, params)
        if k is None:
            return None
        if (step := _nearest_of(search, left, options[k].region_id, walk)) is not None:
            return step
        options.pop(k)
    return None


def _region_distance(region: Region, left: Sequence[Waypoint], walk: _Walk) -> float:
    """g(p_cur, c_r): metres to the region's centroid, snapped to floor that can be walked to, if any waypoint
    can.
    """
    places = [w for w in left if w.region_id == region.region_id]
    nearest_waypoint = min(walk.to(w.position[:2], w.floor, 0.5) for w in places)
    if not np.isfinite(nearest_waypoint):
        return float("inf")
    g = walk.to(region.centroid[:2], region.floor, SNAP_METRES)
    return g if np.isfinite(g) else nearest_waypoint
