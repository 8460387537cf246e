"""A building to walk in: every storey's floor that a robot can stand on, and the stairs between them, as one graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from ovip.errors import InvalidInput
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F64, I32, I64, Bools, EdgeKind, Floor, Partition, RegionEdge
from ovip.scene.walking import (
    cell_centres,
    chain_back,
    path_length,
    pull_straight,
    traversable,
    walk_graph,
    walk_pieces,
)

MOST_RADIUS = 2.0
"""Metres: no robot that goes through a home is wider."""
_STAIRS_REACH = 1.0
"""Metres from the foot or head of stairs within which there must be floor to stand on."""

Spot = tuple[int, int, int]
"""Floor, row and column of a cell."""


@dataclass(frozen=True, slots=True)
class Flight:
    """Stairs that a robot fits on. lower, upper: where it stands before and behind them. length: metres walked from
    one to the other. climb: `(2, 3)` foot and head."""

    edge: RegionEdge
    lower: Spot
    upper: Spot
    length: float
    climb: F64


@dataclass(frozen=True, slots=True)
class Leg:
    """A walk on one storey. cells: `(N,)` flat indices, neighbour by neighbour. flight: what it is left by, if any."""

    floor: int
    cells: I64
    flight: Flight | None = None


class Building:
    """Where a robot of one radius can stand and walk; each part is made when first asked for, and kept.

    grids: storeys by number, without those that have no cells. standing: their cells `(R, C)` to stand on.
    """

    def __init__(self, partition: Partition, grids: Mapping[int, FloorGrid], radius: float) -> None:
        self.partition = partition
        self.radius = check_radius(radius)
        self.grids = {floor: grid for floor, grid in sorted(grids.items()) if grid.occupancy.size}
        self.heights = {floor.floor: floor.z for floor in partition.floors}
        self.standing: dict[int, Bools] = {f: traversable(grid, radius) for f, grid in self.grids.items()}

    def floor_at(self, point: F64) -> int | None:
        """The storey that a point `(3,)` is on, if it has a grid."""
        floor = floor_of(float(point[2]), [f for f in self.partition.floors if f.floor in self.grids])
        return None if floor is None else floor.floor

    def spot_at(self, point: F64) -> Spot | None:
        """The cell of a point `(3,)`, where one can stand in it."""
        floor = self.floor_at(point)
        if floor is None:
            return None
        row, column = self.grids[floor].cell_of(point)
        rows, columns = self.standing[floor].shape
        inside = 0 <= row < rows and 0 <= column < columns
        return (floor, row, column) if inside and self.standing[floor][row, column] else None

    def node(self, spot: Spot) -> int:
        """The number of a cell that can be stood on in the graph of the building."""
        first, nodes = self._nodes[spot[0]]
        flat = np.ravel_multi_index(spot[1:], self.standing[spot[0]].shape)
        return first + int(np.searchsorted(nodes, flat))

    def spot(self, floor: int, flat: int) -> Spot:
        """The cell of a storey with that flat index."""
        row, column = np.unravel_index(flat, self.standing[floor].shape)
        return floor, int(row), int(column)

    def nearest(self, point: F64, floor: int, reach: float) -> Spot | None:
        """The cell of a storey to stand on nearest to a point, at most `reach` metres away; ties go to the first."""
        nodes = np.flatnonzero(self.standing[floor])
        if not len(nodes):
            return None
        away = np.linalg.norm(cell_centres(self.grids[floor], nodes) - point[:2], axis=1)
        best = int(np.argmin(away))
        return self.spot(floor, int(nodes[best])) if away[best] <= reach else None

    def position(self, spot: Spot) -> F64:
        """World point `(3,)` of a cell's centre on its floor."""
        floor, row, column = spot
        return np.append(self.grids[floor].xy_of(row, column), self.heights.get(floor, 0.0))

    @cached_property
    def flights(self) -> tuple[Flight, ...]:
        """The stairs that the robot fits on and can step onto, at both ends."""
        stairs = [edge for edge in self.partition.edges if edge.kind is EdgeKind.STAIRS]
        return tuple(f for edge in stairs if (f := self._flight(edge)) is not None)

    @cached_property
    def pieces(self) -> dict[int, I32]:
        """By storey, cells `(R, C)` numbered by what can be walked to, stairs included; 0 where one cannot stand."""
        labelled, first = {}, 0
        for floor, mask in self.standing.items():
            labels, count = walk_pieces(mask)
            labelled[floor] = np.where(mask, labels + first, 0).astype(np.int32)
            first += count
        joined = [
            (labelled[f.lower[0]][f.lower[1:]], labelled[f.upper[0]][f.upper[1:]]) for f in self.flights
        ]
        ones, others = np.array(joined, dtype=np.int64).reshape(-1, 2).T
        links = sparse.csr_matrix((np.ones(len(ones)), (ones, others)), shape=(first + 1, first + 1))
        _, piece = csgraph.connected_components(links, directed=False)
        return {floor: piece[labels].astype(np.int32) for floor, labels in labelled.items()}

    def distances(self, start: Spot) -> dict[int, F64]:
        """Metres walked from a cell to every cell of every storey `(R, C)`; infinite where there is no way."""
        walked = csgraph.dijkstra(self._graph, directed=True, indices=self.node(start))
        fields = {}
        for floor, mask in self.standing.items():
            fields[floor] = np.full(mask.shape, np.inf)
            first, nodes = self._nodes[floor]
            fields[floor].ravel()[nodes] = walked[first : first + len(nodes)]
        return fields

    def legs(self, start: Spot, goal: Spot) -> tuple[Leg, ...]:
        """The shortest way, storey by storey; none where there is no way."""
        if self.pieces[start[0]][start[1:]] != self.pieces[goal[0]][goal[1:]]:
            return ()
        ends = self.node(start), self.node(goal)
        _, before = csgraph.dijkstra(self._graph, directed=True, indices=ends[0], return_predecessors=True)
        return self._cut(chain_back(before, *ends))

    def centres(self, leg: Leg) -> F64:
        """A leg cell by cell `(N, 3)`, metres."""
        xy = cell_centres(self.grids[leg.floor], leg.cells)
        return np.column_stack([xy, np.full(len(xy), self.heights.get(leg.floor, 0.0))])

    def straight(self, leg: Leg) -> F64:
        """A leg with every stretch that can be walked in a straight line walked so: its corners `(N, 3)`, metres."""
        grid = self.grids[leg.floor]
        xy = pull_straight(grid, self.standing[leg.floor], cell_centres(grid, leg.cells))
        return np.column_stack([xy, np.full(len(xy), self.heights.get(leg.floor, 0.0))])

    def _flight(self, edge: RegionEdge) -> Flight | None:
        """Its ends are the cells nearest to foot and head; none where the stairs are narrower than the robot."""
        if edge.upper is None or 0.0 < edge.width < 2 * self.radius:
            return None
        lower, upper = self._beside(edge.position), self._beside(edge.upper)
        if lower is None or upper is None or lower[0] == upper[0]:
            return None
        climb = np.stack([edge.position, edge.upper])
        whole = np.stack([self.position(lower), *climb, self.position(upper)])
        return Flight(edge, lower, upper, path_length(whole), climb)

    def _beside(self, end: F64) -> Spot | None:
        """Where to stand at an end `(3,)` of stairs, on the storey whose floor is nearest to it in height."""
        known = [floor for floor in self.partition.floors if floor.floor in self.grids]
        if not known:
            return None
        level = min(known, key=lambda floor: abs(floor.z - float(end[2])))
        return self.nearest(end, level.floor, _STAIRS_REACH)

    @cached_property
    def _nodes(self) -> dict[int, tuple[int, I64]]:
        """By storey: the number of its first node, and the flat indices of the cells of its nodes."""
        found, first = {}, 0
        for floor, mask in self.standing.items():
            found[floor] = (first, np.flatnonzero(mask))
            first += len(found[floor][1])
        return found

    @cached_property
    def _graph(self) -> sparse.csr_matrix:
        """All cells to stand on and the steps and flights between them, metres, each both ways."""
        storeys = [walk_graph(mask, self.grids[f].resolution)[0] for f, mask in self.standing.items()]
        steps = storeys[0] if len(storeys) == 1 else sparse.block_diag(storeys, format="csr")
        if self._climbs:
            tails, heads = np.array(list(self._climbs), dtype=np.int64).T
            lengths = np.array([flight.length for flight in self._climbs.values()])
            steps = steps + sparse.csr_matrix((lengths, (tails, heads)), shape=steps.shape)
        return (steps + steps.T).tocsr()

    @cached_property
    def _climbs(self) -> dict[tuple[int, int], Flight]:
        """The shortest flight between each two nodes that flights join."""
        shortest: dict[tuple[int, int], Flight] = {}
        for flight in sorted(self.flights, key=lambda f: -f.length):
            shortest[(self.node(flight.lower), self.node(flight.upper))] = flight
        return shortest

    def _cut(self, chain: Sequence[int]) -> tuple[Leg, ...]:
        """A chain of nodes, each a step from the one before, cut where it leaves a storey."""
        legs, begin = [], 0
        for at, (one, other) in enumerate(pairwise(chain), start=1):
            flight = self._climbs.get((one, other)) or self._climbs.get((other, one))
            if flight is not None:
                legs.append(replace(self._leg(chain[begin:at]), flight=flight))
                begin = at
        return (*legs, self._leg(chain[begin:]))

    def _leg(self, chain: Sequence[int]) -> Leg:
        for floor, (first, nodes) in self._nodes.items():
            if first <= chain[0] < first + len(nodes):
                return Leg(floor, nodes[np.asarray(chain) - first])
        raise AssertionError("every node is of a storey")


def joined(legs: Sequence[Leg], lines: Sequence[F64]) -> F64:
    """The legs' lines `(N, 3)` and the ends of the flights between them, in walking order -> `(M, 3)`."""
    parts = [np.zeros((0, 3))]
    for leg, line in zip(legs, lines, strict=True):
        parts.append(line)
        if leg.flight is not None:
            parts.append(leg.flight.climb if leg.floor == leg.flight.lower[0] else leg.flight.climb[::-1])
    return np.concatenate(parts)


def check_radius(radius: float) -> float:
    """The radius in metres; InvalidInput for one that no robot has."""
    if not (np.isfinite(radius) and 0.0 <= radius <= MOST_RADIUS):
        raise InvalidInput(f"radius: expected 0 to {MOST_RADIUS:g} metres, got {radius:g}")
    return float(radius)


def floor_of(z: float, floors: Sequence[Floor], slack: float = 0.3) -> Floor | None:
    """The storey whose floor is the highest at or below height `z` (within `slack`); the lowest where all are
    above.
    """
    if not floors:
        return None
    below = [floor for floor in floors if floor.z <= z + slack]
    return max(below, key=lambda floor: floor.z) if below else min(floors, key=lambda floor: floor.z)
