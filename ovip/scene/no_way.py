"""Why there is no way for a robot, in words: floor never seen, no stairs, a doorway too narrow for it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.scene.building import Building, Leg, Spot
from ovip.scene.types import F64, EdgeKind, RegionEdge
from ovip.scene.walking import cell_centres, clearance

_BESIDE = 0.3
"""Metres beside the opening of a passage that still belong to it."""
_SLIGHTLY = 0.01
"""Metres of radius between a robot that fits and one that does not."""


def why_no_way(building: Building, start: Spot, goal: Spot) -> str:
    """What keeps the robot from getting from one cell where it can stand to another one.

    Looked for on the way of the widest robot that gets there: where that one just fits, this one does not.
    """
    if not _fits(_for(building, 0.0), start, goal):
        return _no_floor_between(building, start, goal)
    fitting, stuck = _bracketed(building, start, goal)
    legs = fitting.legs(start, goal)
    for leg in legs:
        if leg.flight is not None and not any(leg.flight.edge is f.edge for f in stuck.flights):
            return _blocked_stairs(building, leg.flight.edge)
    return _too_narrow(building, legs, stuck)


def _for(building: Building, radius: float) -> Building:
    return Building(building.partition, building.grids, radius)


def _fits(building: Building, start: Spot, goal: Spot) -> bool:
    return bool(building.pieces[start[0]][start[1:]] == building.pieces[goal[0]][goal[1:]])


def _bracketed(building: Building, start: Spot, goal: Spot) -> tuple[Building, Building]:
    """The building for a robot that gets from start to goal, and for one hardly wider that does not."""
    fitting, stuck = _for(building, 0.0), building
    while stuck.radius - fitting.radius > _SLIGHTLY:
        middle = _for(building, (fitting.radius + stuck.radius) / 2)
        if _fits(middle, start, goal):
            fitting = middle
        else:
            stuck = middle
    return fitting, stuck


def _no_floor_between(building: Building, start: Spot, goal: Spot) -> str:
    if start[0] != goal[0] and goal[0] not in _joined_floors(building, start[0]):
        return f"no stairs that were seen lead from floor {start[0]} to floor {goal[0]}"
    ends = [_place(building, spot) for spot in (start, goal)]
    between = "from the start to the goal" if ends[0] == ends[1] else f"from {ends[0]} to {ends[1]}"
    return f"no floor that was seen leads {between}"


def _joined_floors(building: Building, floor: int) -> set[int]:
    """The storeys that stairs join to this one, whoever fits on them."""
    of = {region.region_id: region.floor for region in building.partition.regions}
    stairs = [{of.get(e.a), of.get(e.b)} for e in building.partition.edges if e.kind is EdgeKind.STAIRS]
    joined: set[int | None] = {floor}
    for _ in stairs:
        joined |= {other for pair in stairs if pair & joined for other in pair}
    return {level for level in joined if level is not None}


def _blocked_stairs(building: Building, edge: RegionEdge) -> str:
    name = _named(building, edge)
    if 0.0 < edge.width < 2 * building.radius:
        return f"{name} are {edge.width:.2f} m wide; {_needs(building)}"
    return f"a robot of {building.radius:.2f} m radius cannot stand at both ends of {name}"


def _too_narrow(building: Building, legs: Sequence[Leg], stuck: Building) -> str:
    """Names the narrowest place of a way, where the robot of `stuck` cannot stand; one in a doorway, if any is."""
    places = [(leg.floor, cell) for leg in legs for cell in _cells_beside(building, leg)]
    blocked = [(floor, cell) for floor, cell in places if not stuck.standing[floor].ravel()[cell]]
    space = {floor: clearance(building.grids[floor]).ravel() for floor in {leg.floor for leg in legs}}
    floor, cell = min(blocked, key=lambda place: space[place[0]][place[1]])
    least = float(space[floor][cell])
    passages = [_passage_at(building, *place) for place in blocked]
    passage = next((edge for edge in passages if edge is not None), None)
    if passage is not None:
        name = f"{_named(building, passage)} ({passage.width:.2f} m wide)"
    else:
        xy = cell_centres(building.grids[floor], np.array([cell]))[0]
        name = f"the way at {xy[0]:.1f}, {xy[1]:.1f} in {_region_name(building, floor, xy)}"
    return f"{name} leaves {np.floor(200 * least + 1e-6) / 100:.2f} m; {_needs(building)}"


def _cells_beside(building: Building, leg: Leg) -> list[int]:
    """The cells of a leg, and those beside its diagonal steps, which must be as free, by flat index."""
    rows, columns = np.unravel_index(leg.cells, building.grids[leg.floor].occupancy.shape)
    wide = building.grids[leg.floor].occupancy.shape[1]
    turned = (rows[:-1] * wide + columns[1:], rows[1:] * wide + columns[:-1])
    cells: list[int] = np.unique(np.concatenate([leg.cells, *turned])).tolist()
    return cells


def _needs(building: Building) -> str:
    return f"a robot of {building.radius:.2f} m radius needs {2 * building.radius:.2f} m"


def _passage_at(building: Building, floor: int, cell: int) -> RegionEdge | None:
    """The doorway or opening that a cell of a storey lies in: it is near its middle, and both regions are at hand."""
    grid = building.grids[floor]
    xy = cell_centres(grid, np.array([cell]))[0]
    row, column = grid.cell_of(xy)
    around = int(np.ceil(_BESIDE / grid.resolution))
    near = grid.regions[
        max(0, row - around) : row + around + 1, max(0, column - around) : column + around + 1
    ]
    at_hand = {grid.region_ids[int(label) - 1] for label in np.unique(near[near > 0])}
    found = [
        (float(np.linalg.norm(edge.position[:2] - xy)) - edge.width / 2, number, edge)
        for number, edge in enumerate(building.partition.edges)
        if edge.kind is not EdgeKind.STAIRS and {edge.a, edge.b} <= at_hand
    ]
    beyond, _, edge = min(found, default=(np.inf, 0, None))
    return edge if beyond <= _BESIDE else None


def _named(building: Building, edge: RegionEdge) -> str:
    names = {region.region_id: region.display_name for region in building.partition.regions}
    return f"the {edge.kind.value} between {names.get(edge.a, edge.a)} and {names.get(edge.b, edge.b)}"


def _place(building: Building, spot: Spot) -> str:
    return _region_name(building, spot[0], building.position(spot)[:2])


def _region_name(building: Building, floor: int, xy: F64) -> str:
    """The display name of the region of a cell, else its floor."""
    grid = building.grids[floor]
    label = int(grid.regions[grid.cell_of(xy)])
    names = {region.region_id: region.display_name for region in building.partition.regions}
    if not label:
        return f"floor {floor}"
    region_id = grid.region_ids[label - 1]
    return f"the {names.get(region_id, region_id)}"
