"""What a search leaves unseen, in words: floor that nobody explored, and places that the robot cannot get to."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

import numpy as np

from ovip.scene.building import Building
from ovip.scene.navigation import route_in
from ovip.scene.types import Frontier, Partition
from services.retrieval.case import Case
from services.retrieval.domain.search import Search, walked

_BESIDE = 1.0
"""Metres from a frontier within which a robot that can stand there has it in reach."""


async def unexplored(case: Case, search: Search) -> str:
    """Where floor that the robot can get to ends at what was never seen, by the regions as they stand by now:
    `beyond the kitchen (1.2 m wide)`; "" where it nowhere does. A question about some regions is concerned with
    theirs alone.
    """
    newest = await case.evidence.with_newest_regions()
    frontiers = _concerned(case, newest.partition)
    if not frontiers:
        return ""
    building = await newest.building(case.radius)
    in_reach = await asyncio.to_thread(_in_reach, building, search, frontiers)
    return _listed(newest.partition, in_reach)


async def out_of_reach(case: Case, building: Building, search: Search) -> str:
    """Why the robot cannot get to what is left of the plan; "" where nothing is or nothing keeps it."""
    place = search.place
    left = [waypoint for waypoint in search.waypoints if search.open_at(waypoint)]
    if not left or place is None:
        return ""
    names = {region.region_id: region.display_name for region in case.regions()}
    reasons: dict[str, str] = {}
    for waypoint in left:
        if waypoint.region_id not in reasons:
            route = await asyncio.to_thread(route_in, building, place, waypoint.position)
            reasons[waypoint.region_id] = route.why
    told = {why: names.get(region, region) for region, why in reversed(reasons.items()) if why}
    return "; ".join(f"no way to the {name}: {why}" for why, name in reversed(told.items()))


def _concerned(case: Case, partition: Partition) -> tuple[Frontier, ...]:
    inside = {region.region_id for region in case.places}
    return tuple(f for f in partition.frontiers if not inside or f.region_id in inside)


def _in_reach(building: Building, search: Search, frontiers: Sequence[Frontier]) -> list[Frontier]:
    """Those beside floor that the robot can walk to, or stand on where its place is not known."""
    fields = walked(building, search.place, search.floor)
    found = []
    for frontier in frontiers:
        spot = frontier.floor in building.grids and building.nearest(
            frontier.position, frontier.floor, _BESIDE
        )
        if spot and (fields is None or np.isfinite(fields[frontier.floor][spot[1:]])):
            found.append(frontier)
    return found


def _listed(partition: Partition, frontiers: Sequence[Frontier]) -> str:
    """`beyond the kitchen (1.2 m wide) and beyond the hall (2 places, up to 0.8 m wide)`; "" for none."""
    names = {region.region_id: f"the {region.display_name}" for region in partition.regions}
    by_name: dict[str, list[float]] = {}
    for frontier in frontiers:
        by_name.setdefault(names.get(frontier.region_id, f"floor {frontier.floor}"), []).append(
            frontier.width
        )
    return " and ".join(f"beyond {name} ({_wide(widths)})" for name, widths in by_name.items())


def _wide(widths: Sequence[float]) -> str:
    if len(widths) == 1:
        return f"{widths[0]:.1f} m wide"
    return f"{len(widths)} places, up to {max(widths):.1f} m wide"
