"""The graph of a building's passages: doorways, openings and stairs, with the metres walked between those of one
region (SPEC 3)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.sparse import csgraph

from ovip.scene.building import Building, Spot
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F64, I64, Bools, EdgeKind, Partition, RegionEdge
from ovip.scene.walking import cell_centres, walk_graph

_BESIDE = 0.3
"""Metres beside the opening of a passage that still belong to it."""
_AT_ONCE = 4_000_000
"""Distances held at one time."""


@dataclass(frozen=True, slots=True)
class RouteNode:
    """Where a robot can stand in a passage. Stairs have a node on each of their two floors. position: `(3,)` metres."""

    node: int
    passage: RegionEdge
    floor: int
    position: F64


@dataclass(frozen=True, slots=True)
class RouteLink:
    """A walk of `length` metres between two nodes, a < b, inside the region that both border; of stairs, over them:
    region_id is ""."""

    a: int
    b: int
    region_id: str
    length: float


@dataclass(frozen=True, slots=True)
class RouteGraph:
    """Passages that the robot fits through, and the walks between them, by (a, b, region)."""

    nodes: tuple[RouteNode, ...] = ()
    links: tuple[RouteLink, ...] = ()
    revision: int = 0


@dataclass(frozen=True, slots=True)
class _Stop:
    """A node with its cell and the regions it borders."""

    passage: RegionEdge
    spot: Spot
    region_ids: tuple[str, ...]


def route_graph(partition: Partition, grids: Mapping[int, FloorGrid], radius: float) -> RouteGraph:
    """The passages that a robot of `radius` metres fits through, and the shortest walks between them.

    A walk keeps to the region and the two nodes' own cells. Nodes that cannot be walked between inside a region have
    no link there. InvalidInput for a radius that is negative, not finite or above 2 m.
    """
    return graph_of(Building(partition, grids, radius))


def graph_of(building: Building) -> RouteGraph:
    """`route_graph` of a building that is kept for several questions."""
    stops = [stop for floor in building.grids for stop in _passages(building, floor)]
    links: list[RouteLink] = []
    for flight in building.flights:
        first = len(stops)
        stops += [_landing(building, flight.edge, spot) for spot in (flight.lower, flight.upper)]
        links.append(RouteLink(first, first + 1, "", flight.length))
    for floor in building.grids:
        links += _walks(building, floor, stops)
    return RouteGraph(
        nodes=tuple(
            RouteNode(number, stop.passage, stop.spot[0], building.position(stop.spot))
            for number, stop in enumerate(stops)
        ),
        links=tuple(sorted(links, key=lambda link: (link.a, link.b, link.region_id))),
        revision=building.partition.revision,
    )


def _passages(building: Building, floor: int) -> Iterator[_Stop]:
    """Doorways and openings of a storey, each at the crossable cell nearest to its middle."""
    grid = building.grids[floor]
    number = {region_id: k + 1 for k, region_id in enumerate(grid.region_ids)}
    cells, pairs = _crossings(grid, building.standing[floor])
    middles = cell_centres(grid, cells.ravel()).reshape(-1, 2, 2).mean(axis=1)
    for edge in building.partition.edges:
        if edge.kind is EdgeKind.STAIRS or edge.a not in number or edge.b not in number:
            continue
        mine = np.flatnonzero((pairs == sorted((number[edge.a], number[edge.b]))).all(axis=1))
        away = np.linalg.norm(middles[mine] - edge.position[:2], axis=1)
        if len(mine) and away.min() <= edge.width / 2 + _BESIDE:
            cell = int(cells[mine[int(np.argmin(away))], 0])
            yield _Stop(edge, building.spot(floor, cell), (edge.a, edge.b))


def _crossings(grid: FloorGrid, standing: Bools) -> tuple[I64, I64]:
    """Steps over a border of two regions: flat indices of the two cells `(K, 2)`, the regions' numbers `(K, 2)`
    rising; the first cell is the one of the smaller number."""
    flat = np.arange(grid.regions.size).reshape(grid.regions.shape)
    cells, pairs = [], []
    for one, other in (
        (np.s_[:, :-1], np.s_[:, 1:]),
        (np.s_[:-1], np.s_[1:]),
    ):
        a, b = grid.regions[one].astype(np.int64), grid.regions[other].astype(np.int64)
        crossed = (a != b) & (a > 0) & (b > 0) & standing[one] & standing[other]
        pair = np.stack([a[crossed], b[crossed]], axis=1)
        cell = np.stack([flat[one][crossed], flat[other][crossed]], axis=1)
        rising = np.argsort(pair, axis=1)
        cells.append(np.take_along_axis(cell, rising, axis=1))
        pairs.append(np.take_along_axis(pair, rising, axis=1))
    return np.concatenate(cells), np.concatenate(pairs)


def _landing(building: Building, edge: RegionEdge, spot: Spot) -> _Stop:
    """An end of stairs borders the region that it lies in; where it lies in none, the one the stairs name."""
    grid = building.grids[spot[0]]
    label = int(grid.regions[spot[1:]])
    named = tuple(region_id for region_id in (edge.a, edge.b) if region_id in grid.region_ids)
    return _Stop(edge, spot, (grid.region_ids[label - 1],) if label else named)


def _walks(building: Building, floor: int, stops: Sequence[_Stop]) -> Iterator[RouteLink]:
    """The links of a storey, region by region."""
    grid = building.grids[floor]
    boxes = ndimage.find_objects(grid.regions.astype(np.int32), max_label=len(grid.region_ids))
    for number, (region_id, box) in enumerate(zip(grid.region_ids, boxes, strict=True), start=1):
        mine = [k for k, stop in enumerate(stops) if region_id in stop.region_ids and stop.spot[0] == floor]
        if box is None or len(mine) < 2:
            continue
        for (one, other), length in _apart(building, floor, number, box, [stops[k].spot for k in mine]):
            yield RouteLink(mine[one], mine[other], region_id, length)


def _apart(
    building: Building, floor: int, region: int, box: tuple[slice, slice], spots: Sequence[Spot]
) -> Iterator[tuple[tuple[int, int], float]]:
    """Metres walked inside a region between each two of its cells or such as border it; only where there is a way."""
    rows, columns = np.array([spot[1:] for spot in spots]).T
    top, left = min(box[0].start, rows.min()), min(box[1].start, columns.min())
    crop = np.s_[top : max(box[0].stop, rows.max() + 1), left : max(box[1].stop, columns.max() + 1)]
    inside = building.standing[floor][crop] & (building.grids[floor].regions[crop] == region)
    inside[rows - top, columns - left] = True
    graph, nodes = walk_graph(inside, building.grids[floor].resolution, building.standing[floor][crop])
    at = np.searchsorted(nodes, np.ravel_multi_index((rows - top, columns - left), inside.shape))
    chunk = max(1, _AT_ONCE // len(nodes))
    for begin in range(0, len(at) - 1, chunk):
        sources = at[begin : min(begin + chunk, len(at) - 1)]
        walked = csgraph.dijkstra(graph, directed=False, indices=sources)[:, at]
        for one, row in enumerate(walked.tolist(), start=begin):
            for other in range(one + 1, len(at)):
                if np.isfinite(row[other]):
                    yield (one, other), row[other]
