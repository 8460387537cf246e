"""Where to stand to be at an object, facing it, and the furniture-aware way there (SPEC 4: standoff pose,
path).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.answers import Goal
from ovip.scene.building import Building, Spot, joined
from ovip.scene.grid import FloorGrid
from ovip.scene.no_way import why_no_way
from ovip.scene.types import F64, Bools
from ovip.scene.walking import path_length

NO_PATH: F64 = np.zeros((0, 3))


@dataclass(frozen=True, slots=True)
class GoalParams:
    """near, far: metres from the object's footprint at which to stand, so that one is within a metre of it even where
    the mapped box is a few decimetres off; farthest: where nothing nearer can be reached.

    start_reach: how far the start may be from floor that can be stood on (a hand-held camera over a table).
    """

    near: float = 0.3
    far: float = 0.6
    farthest: float = 3.0
    start_reach: float = 2.0


@dataclass(frozen=True, slots=True)
class Way:
    """A standoff pose and the path to it `(N, 3)`; `why` says what is missing where one is."""

    goal: Goal | None
    path: F64
    why: str = ""


def way_to(
    box: F64, start: F64 | None, building: Building, floor: int | None, params: GoalParams | None = None
) -> Way:
    """The standoff pose for a box `(6,)` on a storey, with the shortest way from `start` `(3,)`, over stairs where
    the robot is on another storey.

    Without a start the place nearest to the box is taken. No grid, no floor to stand on and no way are no
    errors.
    """
    params = params or GoalParams()
    grid = None if floor is None else building.grids.get(floor)
    if floor is None or grid is None:
        return Way(None, NO_PATH, "no path: the scene has no floor grid yet")
    standing, floor_z = building.standing[floor], building.heights.get(floor, 0.0)
    if not standing.any():
        return Way(
            None,
            NO_PATH,
            f"no path: the floor grid has no place where a robot of {building.radius:.2f} m can stand",
        )
    away = footprint_distance(grid, box)
    begin = None if start is None else _begin(building, start, params)
    if begin is None:
        cell = _nearest_place(standing, away, params)
        missing = (
            "no start position is known" if start is None else "the robot is not near floor it can stand on"
        )
        return _without_path(grid, cell, box, floor_z, f"no path: {missing}")
    walked = building.distances(begin)[floor]
    cell = _standoff(standing & np.isfinite(walked), away, walked, params)
    if cell is None:
        return _out_of_reach(building, begin, floor, away, box, params)
    legs = building.legs(begin, (floor, *cell))
    path = joined(legs, [building.centres(leg) for leg in legs])
    apart = float(away[cell])
    why = "" if apart <= params.far else f"the nearest place that can be reached is {apart:.1f} m from it"
    return Way(_facing(grid, cell, box, floor_z), path, why)


def footprint_distance(grid: FloorGrid, box: F64) -> F64:
    """Metres from every cell's centre to the box's footprint -> `(R, C)`; 0 inside it."""
    rows, columns = grid.occupancy.shape
    x = grid.origin[0] + (np.arange(columns) + 0.5) * grid.resolution
    y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution
    dx = np.maximum(np.maximum(box[0] - x, x - box[3]), 0.0)
    dy = np.maximum(np.maximum(box[1] - y, y - box[4]), 0.0)
    return np.asarray(np.hypot(dx[None, :], dy[:, None]))


def length(path: F64) -> float:
    """Metres along the path."""
    return path_length(path)


def _begin(building: Building, start: F64, params: GoalParams) -> Spot | None:
    floor = building.floor_at(start)
    return None if floor is None else building.nearest(start, floor, params.start_reach)


def _standoff(reachable: Bools, away: F64, walked: F64, params: GoalParams) -> tuple[int, int] | None:
    """Nearest on foot of the reachable cells at standing distance; else the one nearest to the object."""
    good = reachable & (away >= params.near) & (away <= params.far)
    if good.any():
        return _argmin(np.where(good, walked, np.inf))
    return _nearest_place(reachable, away, params)


def _nearest_place(standing: Bools, away: F64, params: GoalParams) -> tuple[int, int] | None:
    cost = np.where(standing & (away <= params.farthest), np.abs(away - params.near), np.inf)
    return _argmin(cost) if np.isfinite(cost).any() else None


def _argmin(cost: F64) -> tuple[int, int]:
    row, column = np.unravel_index(int(np.argmin(cost)), cost.shape)
    return int(row), int(column)


def _out_of_reach(
    building: Building, begin: Spot, floor: int, away: F64, box: F64, params: GoalParams
) -> Way:
    """The place nearest to the box, and why it cannot be walked to."""
    cell = _nearest_place(building.standing[floor], away, params)
    why = "no path: no floor near it can be reached from the robot"
    if cell is not None:
        why += f": {why_no_way(building, begin, (floor, *cell))}"
    return _without_path(building.grids[floor], cell, box, building.heights.get(floor, 0.0), why)


def _without_path(grid: FloorGrid, cell: tuple[int, int] | None, box: F64, floor_z: float, why: str) -> Way:
    return Way(None if cell is None else _facing(grid, cell, box, floor_z), NO_PATH, why)


def _facing(grid: FloorGrid, cell: tuple[int, int], box: F64, floor_z: float) -> Goal:
    x, y = grid.xy_of(*cell)
    toward = (box[:2] + box[3:5]) / 2 - (x, y)
    return Goal(np.array([x, y, floor_z]), float(np.arctan2(toward[1], toward[0])))
