"""Where to stand to be at an object, facing it, and the furniture-aware way there (SPEC 4: standoff pose,
path).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.answers import Goal
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F64, Bools, Floor
from ovip.scene.walking import distance_field, path_length, shortest_path, traversable
from services.retrieval.domain.viewpoints import snap

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
    box: F64,
    start: F64 | None,
    grid: FloorGrid | None,
    floor_z: float,
    radius: float,
    params: GoalParams | None = None,
) -> Way:
    """The standoff pose for a box `(6,)` with the shortest way from `start` `(3,)`, for a robot of `radius`
    metres.

    Without a start the place nearest to the box is taken. No grid, no floor to stand on and no way are no
    errors.
    """
    params = params or GoalParams()
    if grid is None:
        return Way(None, NO_PATH, "no path: the scene has no floor grid yet")
    standing = traversable(grid, radius)
    if not standing.any():
        return Way(
            None, NO_PATH, f"no path: the floor grid has no place where a robot of {radius:.2f} m can stand"
        )
    away = footprint_distance(grid, box)
    begin = None if start is None else _start_cell(grid, standing, start, params)
    if begin is None:
        cell = _nearest_place(standing, away, params)
        missing = (
            "no start position is known" if start is None else "the robot is not near floor it can stand on"
        )
        return _without_path(grid, cell, box, floor_z, f"no path: {missing}")
    walked = distance_field(standing, begin, grid.resolution)
    cell = _standoff(standing & np.isfinite(walked), away, walked, params)
    if cell is None:
        cell = _nearest_place(standing, away, params)
        return _without_path(
            grid, cell, box, floor_z, "no path: no floor near it can be reached from the robot"
        )
    goal = _facing(grid, cell, box, floor_z)
    path = shortest_path(grid, grid.xy_of(*begin), goal.position[:2], radius)
    if not len(path):
        path = goal.position[None, :2]
    apart = float(away[cell])
    why = "" if apart <= params.far else f"the nearest place that can be reached is {apart:.1f} m from it"
    return Way(goal, np.column_stack([path, np.full(len(path), floor_z)]), why)


def footprint_distance(grid: FloorGrid, box: F64) -> F64:
    """Metres from every cell's centre to the box's footprint -> `(R, C)`; 0 inside it."""
    rows, columns = grid.occupancy.shape
    x = grid.origin[0] + (np.arange(columns) + 0.5) * grid.resolution
    y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution
    dx = np.maximum(np.maximum(box[0] - x, x - box[3]), 0.0)
    dy = np.maximum(np.maximum(box[1] - y, y - box[4]), 0.0)
    return np.asarray(np.hypot(dx[None, :], dy[:, None]))


def floor_of(z: float, floors: Sequence[Floor], slack: float = 0.3) -> Floor | None:
    """The storey whose floor is the highest at or below height `z` (within `slack`); the lowest where all are
    above.
    """
    if not floors:
        return None
    below = [floor for floor in floors if floor.z <= z + slack]
    return max(below, key=lambda floor: floor.z) if below else min(floors, key=lambda floor: floor.z)


def length(path: F64) -> float:
    """Metres along the path."""
    return path_length(path)


def _start_cell(grid: FloorGrid, standing: Bools, start: F64, params: GoalParams) -> tuple[int, int] | None:
    return snap(standing, grid.cell_of(start[:2]), params.start_reach / grid.resolution)


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


def _without_path(grid: FloorGrid, cell: tuple[int, int] | None, box: F64, floor_z: float, why: str) -> Way:
    return Way(None if cell is None else _facing(grid, cell, box, floor_z), NO_PATH, why)


def _facing(grid: FloorGrid, cell: tuple[int, int], box: F64, floor_z: float) -> Goal:
    x, y = grid.xy_of(*cell)
    toward = (box[:2] + box[3:5]) / 2 - (x, y)
    return Goal(np.array([x, y, floor_z]), float(np.arctan2(toward[1], toward[0])))
