"""Ways through a building: inflated grids, the region of a place, and the shortest route around furniture and over
stairs (SPEC 3, 4)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ovip.scene.building import Building, Leg, Spot, check_radius, floor_of, joined
from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.no_way import why_no_way
from ovip.scene.types import F64, EdgeKind, Partition, RegionEdge
from ovip.scene.walking import cell_centres, path_length, traversable

_REACH = 2.0
"""Metres from start and goal within which there must be floor to stand on."""
_BRUSHED = 0.3
"""Metres walked in a region below which the way only brushes it."""


@dataclass(frozen=True, slots=True)
class Route:
    """The shortest way. path: `(N, 3)` its corners, metres, on the floors; length: metres walked. region_ids: in the
    order they are walked through; passages: doorways, openings and stairs in the order they are passed. why: why there
    is no way, "" where there is one."""

    path: F64
    length: float
    region_ids: tuple[str, ...]
    passages: tuple[RegionEdge, ...]
    why: str = ""
    revision: int = 0


def inflated(grid: FloorGrid, radius: float) -> FloorGrid:
    """The grid with every free cell occupied where a robot of `radius` metres does not fit; unknown stays unknown.

    InvalidInput for a radius that is negative, not finite or above 2 m.
    """
    fits = traversable(grid, check_radius(radius))
    occupancy = grid.occupancy.copy()
    occupancy[(occupancy == FREE) & ~fits] = OCCUPIED
    return replace(grid, occupancy=occupancy)


def plan_route(
    partition: Partition, grids: Mapping[int, FloorGrid], start: F64, goal: F64, radius: float
) -> Route:
    """The shortest way from `start` `(3,)` to `goal` `(3,)` for a robot of `radius` metres, over stairs where needed.

    An end that cannot be stood on snaps to floor at most 2 m away, both in the piece of floor where the two snaps
    together are shortest. No way is no error: `why` says what is missing. InvalidInput as `inflated`.
    """
    return route_in(Building(partition, grids, radius), start, goal)


def route_in(building: Building, start: F64, goal: F64) -> Route:
    """`plan_route` in a building that is kept for several questions."""
    revision = building.partition.revision
    starts, goals = _ends(building, start), _ends(building, goal)
    if missing := _missing(building, starts, goals):
        return Route(np.zeros((0, 3)), 0.0, (), (), missing, revision)
    joint = [piece for piece in starts if piece in goals]
    if not joint:
        why = why_no_way(building, _nearest(starts), _nearest(goals))
        return Route(np.zeros((0, 3)), 0.0, (), (), why, revision)
    piece = min(joint, key=lambda piece: starts[piece][0] + goals[piece][0])
    legs = building.legs(starts[piece][1], goals[piece][1])
    lines = [building.straight(leg) for leg in legs]
    path = joined(legs, lines)
    region_ids, passages = _walked_through(building, legs, lines)
    return Route(path, path_length(path), region_ids, passages, "", revision)


def region_at(partition: Partition, grids: Mapping[int, FloorGrid], position: F64) -> str:
    """The region of a place `(3,)`: the nearest one on its storey; "" where that has none."""
    floor = floor_of(float(position[2]), partition.floors)
    grid = grids.get(floor.floor) if floor is not None else None
    if grid is None or not grid.regions.any():
        return ""
    row, column = grid.cell_of(position)
    inside = 0 <= row < grid.regions.shape[0] and 0 <= column < grid.regions.shape[1]
    if inside and grid.regions[row, column]:
        return grid.region_ids[int(grid.regions[row, column]) - 1]
    cells = np.flatnonzero(grid.regions)
    away = np.linalg.norm(cell_centres(grid, cells) - position[:2], axis=1)
    return grid.region_ids[int(grid.regions.ravel()[cells[int(np.argmin(away))]]) - 1]


def _ends(building: Building, point: F64) -> dict[int, tuple[float, Spot]]:
    """Piece of floor -> (metres, cell): where an end of the way may be; its own cell alone where one can stand."""
    spot = building.spot_at(point)
    if spot is not None:
        return {int(building.pieces[spot[0]][spot[1:]]): (0.0, spot)}
    floor = building.floor_at(point)
    if floor is None:
        return {}
    cells = np.flatnonzero(building.standing[floor])
    away = np.linalg.norm(cell_centres(building.grids[floor], cells) - point[:2], axis=1)
    near = np.argsort(away, kind="stable")
    near = near[away[near] <= _REACH]
    pieces, first = np.unique(building.pieces[floor].ravel()[cells[near]], return_index=True)
    return {
        int(piece): (float(away[near[k]]), building.spot(floor, int(cells[near[k]])))
        for piece, k in zip(pieces, first, strict=True)
    }


def _nearest(ends: Mapping[int, tuple[float, Spot]]) -> Spot:
    return min(ends.values())[1]


def _missing(building: Building, starts: Mapping[int, object], goals: Mapping[int, object]) -> str:
    if not building.grids:
        return "the scene has no floor grid yet"
    for what, ends in (("start", starts), ("goal", goals)):
        if not ends:
            return (
                f"the {what} is not within {_REACH:g} m of floor that a robot of {building.radius:.2f} m radius "
                "can stand on"
            )
    return ""


def _walked_through(
    building: Building, legs: Sequence[Leg], lines: Sequence[F64]
) -> tuple[tuple[str, ...], tuple[RegionEdge, ...]]:
    """Regions and passages in walking order."""
    region_ids: list[str] = []
    passages: list[RegionEdge] = []
    for leg, line in zip(legs, lines, strict=True):
        for number, (name, entered) in enumerate(_visits(building.grids[leg.floor], line)):
            if number:
                passages += _passage(building.partition, region_ids[-1], name, entered)
            region_ids.append(name)
        if leg.flight is not None:
            passages.append(leg.flight.edge)
    return tuple(region_ids), tuple(passages)


def _visits(grid: FloorGrid, line: F64) -> list[tuple[str, F64]]:
    """The regions that a line `(N, 3)` on one storey leads through, and where it enters each `(3,)`.

    A region that it only brushes between two others does not count, nor does floor of no region.
    """
    points = _sampled(line, grid.resolution / 4)
    columns, rows = np.floor((points[:, :2] - np.asarray(grid.origin)) / grid.resolution).astype(np.int64).T
    labels = grid.regions[rows, columns].astype(np.int64)
    changes = np.flatnonzero(np.diff(labels)) + 1
    found: list[tuple[str, F64]] = []
    for begin, end in zip([0, *changes], [*changes, len(labels)], strict=True):
        between = begin > 0 and end < len(labels)
        if not labels[begin] or (between and path_length(points[begin:end]) < _BRUSHED):
            continue
        name = grid.region_ids[labels[begin] - 1]
        if not found or found[-1][0] != name:
            found.append((name, points[begin]))
    return found


def _sampled(line: F64, spacing: float) -> F64:
    """Points at most `spacing` metres apart along a polyline `(N, 3)` -> `(M, 3)`."""
    if len(line) < 2:
        return line
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / spacing)) + 1)
    return np.stack([np.interp(at, along, line[:, axis]) for axis in range(3)], axis=1)


def _passage(partition: Partition, one: str, other: str, at: F64) -> tuple[RegionEdge, ...]:
    """The doorway or opening between two regions that is nearest to where their border is crossed, if any."""
    between = [e for e in partition.edges if {e.a, e.b} == {one, other} and e.kind is not EdgeKind.STAIRS]
    return tuple(sorted(between, key=lambda edge: float(np.linalg.norm(edge.position - at)))[:1])
