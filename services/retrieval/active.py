"""Tier 4 on one question: the plan, the next viewpoint, what a frame from it says, and the account of
absence.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ovip.scene.answers import Coverage, FrameRecord, TierResult, Viewpoint
from ovip.scene.building import Building, floor_of, joined
from ovip.scene.types import F64, Intrinsics
from services.retrieval.case import Case, Ruling, choice
from services.retrieval.domain.coverage import CoverageParams, View, assess
from services.retrieval.domain.goals import NO_PATH
from services.retrieval.domain.query import ANYTHING
from services.retrieval.domain.search import (
    SNAP_METRES,
    Search,
    Step,
    Waypoint,
    next_step,
    plan,
    viewpoint_id,
)
from services.retrieval.domain.viewpoints import HEADINGS, yaw_of
from services.retrieval.tiers import is_unseeable


@dataclass(frozen=True, slots=True)
class Ground:
    """What an active search stands on: the storeys with what joins them, and where the robot is."""

    building: Building
    place: F64 | None
    floor: int


async def survey(case: Case) -> Ground:
    """The building, and the robot's place in it."""
    floors = case.evidence.partition.floors
    start = await case.evidence.start(case.query.robot_pose)
    storey = floor_of(float(start[2]), floors) if start is not None else None
    return Ground(
        building=await case.evidence.building(case.radius),
        place=start,
        floor=storey.floor if storey else (floors[0].floor if floors else 0),
    )


async def lay_out(case: Case, ground: Ground, search: Search) -> Search:
    """The search with waypoints, priors and budget; without waypoints where there is nothing to plan on."""
    if case.priors is None:
        case.priors = await case.judge.priors(case.target, case.regions())
    await is_unseeable(case)
    waypoints = await asyncio.to_thread(
        plan,
        case.regions(),
        ground.building,
        ground.place,
        ground.floor,
        case.limits.viewpoint,
    )
    return replace(
        search,
        priors=dict(case.priors.by_region),
        waypoints=waypoints,
        place=ground.place,
        floor=ground.floor,
        budget=case.query.max_viewpoints or case.limits.viewpoints,
    )


def planned(case: Case, search: Search) -> Ruling:
    """What tier 4 says of its plan while no robot carries it out."""
    if case.target.noun == ANYTHING:
        return Ruling(TierResult.SKIPPED, "the question names no class that a robot could look for")
    if not search.waypoints:
        return Ruling(TierResult.SKIPPED, f"nothing to plan on: {_no_plan(case)}")
    return Ruling(TierResult.WAITING, f"planned {_itinerary(search)}; no robot in the loop")


def needs(case: Case, search: Search) -> str:
    """What deciding the question would take, in words."""
    if case.target.noun == ANYTHING:
        return "a question that names what to look for"
    wants = []
    if search.waypoints:
        wants.append(f"a robot to visit {_itinerary(search)}, likeliest first: {_likeliest(case, search)}")
    else:
        wants.append(f"a floor to plan on ({_no_plan(case)})")
    if case.unseeable:
        wants.append(f"a grounder that can see {case.target.noun!r}, which this one cannot")
    return ", and ".join(wants)


async def next_viewpoint(case: Case, ground: Ground, search: Search) -> Viewpoint | None:
    """The next viewpoint with the way to it; None where the plan is carried out or nothing left can be
    reached.
    """
    step = await asyncio.to_thread(next_step, search, case.regions(), ground.building, case.limits.schedule)
    if step is None:
        return None
    return await asyncio.to_thread(_viewpoint, ground, search, step)


def view_from(record: FrameRecord, floor: int) -> View:
    """The frame's camera as a view of a floor."""
    x, y = record.world_from_camera[:2, 3]
    return View(floor, float(x), float(y), yaw_of(record.world_from_camera), field_of_view(record.intrinsics))


def field_of_view(k: Intrinsics) -> float:
    """Horizontal field of view, radians."""
    return float(np.arctan2(k.cx + 0.5, k.fx) + np.arctan2(k.width - 0.5 - k.cx, k.fx))


async def account(case: Case, ground: Ground, search: Search) -> Coverage:
    """What an absence would rest on."""
    priors = search.priors or {}
    regions = [region for region in case.regions() if region.region_id in priors]
    return await asyncio.to_thread(
        assess,
        regions,
        priors,
        ground.building.grids,
        search.views,
        (search.planned, search.visited, len(search.unreachable)),
        case.limits.viewpoint.reach,
        CoverageParams(detection_rate=case.limits.detection_rate),
    )


def _viewpoint(ground: Ground, search: Search, step: Step) -> Viewpoint:
    done = search.visited + len(search.unreachable)
    return Viewpoint(
        viewpoint_id=viewpoint_id(step.waypoint, step.heading),
        position=step.waypoint.position,
        yaw=float(HEADINGS[step.heading]),
        region_id=step.waypoint.region_id,
        index=done + 1,
        total=search.planned,
        path=_path(ground.building, search, step.waypoint),
    )


def _path(building: Building, search: Search, waypoint: Waypoint) -> F64:
    """The way from where the robot is, over stairs where it is on another storey."""
    if search.place is None or search.floor not in building.grids or waypoint.floor not in building.grids:
        return NO_PATH
    start = building.nearest(search.place, search.floor, SNAP_METRES)
    goal = building.nearest(waypoint.position, waypoint.floor, SNAP_METRES)
    legs = building.legs(start, goal) if start is not None and goal is not None else ()
    return joined(legs, [building.centres(leg) for leg in legs])


def _itinerary(search: Search) -> str:
    regions = len({waypoint.region_id for waypoint in search.waypoints})
    places = len(search.waypoints)
    within = f" (budget {search.budget})" if search.budget < search.planned else ""
    return (
        f"{search.planned} viewpoints{within} at {places} place{'s' * (places > 1)} "
        f"in {regions} region{'s' * (regions > 1)}"
    )


def _likeliest(case: Case, search: Search) -> str:
    priors = search.priors or {}
    inside = {waypoint.region_id for waypoint in search.waypoints}
    ranked = sorted(
        (region for region in case.regions() if region.region_id in inside),
        key=lambda region: -priors.get(region.region_id, 0.0),
    )
    return _first_few(
        [f"{r.display_name or r.region_id} ({priors.get(r.region_id, 0.0):.2f})" for r in ranked]
    )


def _first_few(names: Sequence[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")


def _no_plan(case: Case) -> str:
    if not case.evidence.partition.regions:
        return "the scene has no regions yet"
    return "no floor grid shows a place where the robot could stand and look"


def still_needs(case: Case, search: Search, ruling: Ruling) -> str:
    """What an active search that ended without a decision would need."""
    if not search.waypoints or case.unseeable:
        return needs(case, search)
    if ruling.result is TierResult.EXHAUSTED and search.visited:
        return f"a budget for the other {search.remaining} viewpoints"
    if ruling.doubtful:
        return f"a better look, or {choice(ruling.doubtful)}"
    if search.visited and search.blind == search.visited:
        return f"a grounder that is known to see {case.target.noun!r}"
    if ruling.result is TierResult.EXHAUSTED:
        return "a robot that can reach some of the viewpoints"
    return "the search to be started again"
