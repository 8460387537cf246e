"""Stairs: the ways from a storey to the next, over surfaces that rise in steps a person can climb (SPEC 3).

Each column between two floors has the height of its highest top. Neighbouring columns are joined where those differ by
a step or less; a piece that reaches from just above the lower floor to just below the upper one is a flight of stairs,
straight or not, and so is a ramp. Furniture rises in higher steps, and walls are thin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from ovip.scene.grid import FREE
from ovip.scene.types import F64, I32, I64, Bools
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.levels import read_hit, tops
from services.regions.domain.survey import SurveyedStorey

_OFFSETS = tuple((r, c) for r in range(3) for c in range(-2, 3) if (r, c) > (0, 0))
"""Half of the neighbours within two cells."""
_ALIKE = 0.1
"""Metres between the heights of cameras that are carried the same way."""
_NONE = np.iinfo(np.int32).min // 2


@dataclass(frozen=True, slots=True)
class StairsParams:
    """Metres. step: most that neighbouring columns differ in height. end: the lowest tread is at most this far above
    the lower floor, the highest this far below the upper one. thin: what is narrower is no tread; hidden: what is as
    narrow, between seen columns, may be one. steepest: rise over
    run. beside: a column belongs to a flight up to this many widths from the middle of the way, heights counting
    double. stride: from one camera on the way up to the next; body: the radius of who carries it. standing: from the
    middle of the outermost tread to where a robot stands; reach: but on free floor, if there is any so near.
    """

    step: float = 0.25
    end: float = 0.45
    thin: float = 0.25
    hidden: float = 0.2
    steepest: float = 1.7
    beside: float = 0.8
    stride: float = 1.2
    body: float = 0.3
    standing: float = 0.45
    reach: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Stairs:
    """A way from one storey up to the next.

    lower, upper: indices of the storeys. foot, head: `(3,)` metres, where a robot stands before climbing, and after.
    width: metres. lower_cells, upper_cells: the columns that it takes up, `(R, C)` of each storey's grid.
    """

    lower: int
    upper: int
    foot: F64
    head: F64
    width: float
    lower_cells: Bools
    upper_cells: Bools


def find_stairs(
    evidence: FloorEvidence, surveyed: tuple[SurveyedStorey, ...], params: StairsParams | None = None
) -> tuple[Stairs, ...]:
    """The stairs between storeys that follow one another, from the lowest up, then by the place of their foot."""
    params = params or StairsParams()
    return tuple(
        stairs
        for number in range(len(surveyed) - 1)
        for stairs in sorted(_between(evidence, surveyed, number, params), key=lambda s: tuple(s.foot))
    )


@dataclass(frozen=True, slots=True)
class _Flight:
    """Columns `(N, 2)` as x, y indices of the world, the heights of their tops in layers, and metres along the way."""

    xy: I64
    layer: I64
    along: F64
    width: float


def _between(
    evidence: FloorEvidence, surveyed: tuple[SurveyedStorey, ...], number: int, params: StairsParams
) -> Iterator[Stairs]:
    lower, upper = surveyed[number], surveyed[number + 1]
    low, high = (int(np.floor(here.storey.z / CELL)) for here in (lower, upper))
    cubes = tops(read_hit(evidence.hits, low + 2, high - 1)).between(low + 2, high - 1)
    stood = _climbed(np.array(list(evidence.cameras.values())), lower.storey.z, upper.storey.z, params)
    for piece in _pieces(cubes, stood, low, high, params):
        for flight in _flights(piece, low, high, params):
            foot, head = _ends(flight, params)
            yield Stairs(
                number,
                number + 1,
                _on_floor(lower, foot, params),
                _on_floor(upper, head, params),
                flight.width,
                _cells(lower.space, flight.xy),
                _cells(upper.space, flight.xy),
            )


def _climbed(cameras: F64, low: float, high: float, params: StairsParams) -> I64:
    """The ground under cameras that were carried from one floor to the other: discs of cubes `(K, 3)`.

    A camera's ground is as far below it as the floor is below most cameras; from camera to near camera it rises
    in a line. In a lift it rises in one place, which is no flight.
    """
    rise = cameras[:, 2] - np.where(cameras[:, 2] < high, low, high)
    rise = np.sort(rise[rise > 0.0])
    if not len(rise):
        return np.zeros((0, 3), np.int64)
    alike = np.searchsorted(rise, rise + _ALIKE, side="right") - np.searchsorted(rise, rise - _ALIKE)
    ground = cameras - (0.0, 0.0, rise[np.argmax(alike)])
    between = ground[(ground[:, 2] > low + params.step) & (ground[:, 2] < high - params.step / 2)]
    pairs = cKDTree(between).query_pairs(params.stride, output_type="ndarray")
    share = np.linspace(0.0, 1.0, 1 + int(np.ceil(params.stride / CELL)))[:, None, None]
    line = (between[pairs[:, 0]] * (1 - share) + between[pairs[:, 1]] * share).reshape(-1, 3)
    cubes = np.unique(np.floor(np.concatenate([between, line]) / CELL).astype(np.int64), axis=0)
    reach = round(params.body / CELL)
    disc = np.argwhere(np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1]) <= reach) - reach
    around = np.column_stack([disc, np.zeros(len(disc), np.int64)])
    return (cubes[:, None] + around).reshape(-1, 3)


def _pieces(cubes: I64, stood: I64, low: int, high: int, params: StairsParams) -> Iterator[I64]:
    """The parts of `(N, 3)` tops that hang together in plan, are no thin lines, and reach from floor to floor.

    Each column has the highest of its cubes, or of those `stood` on where it has none; one between seen columns that
    was hidden (a tread's rear, from below) has the height of the nearest.
    """
    places = np.concatenate([cubes, stood])
    if not len(places):
        return
    gap = round(params.hidden / CELL)
    corner = places[:, :2].min(axis=0) - gap
    heights, under = np.full((2, *(places[:, :2].max(axis=0) + gap + 1 - corner)), _NONE, np.int32)
    np.maximum.at(heights, tuple((cubes[:, :2] - corner).T), cubes[:, 2])
    np.maximum.at(under, tuple((stood[:, :2] - corner).T), stood[:, 2])
    heights = np.where(heights > _NONE, heights, under)
    near = cv2.dilate((heights > _NONE).view(np.uint8), np.ones((gap + 1, gap + 1), np.uint8))
    _, pieces = cv2.connectedComponents(near, connectivity=8)
    end, windows = round(params.end / CELL), ndimage.find_objects(pieces)
    for number in _reaching(pieces, heights, low + end, high - end):
        window = windows[number - 1]
        at, layers = _wide(np.where(pieces[window] == number, heights[window], _NONE), params)
        if _reaches(layers, low + end, high - end, params):
            yield np.column_stack([at + corner + [axis.start for axis in window], layers])


def _reaching(pieces: I32, heights: I32, low: int, high: int) -> list[int]:
    """The pieces whose lowest height is at most `low` and whose highest is at least `high`."""
    seen = heights > _NONE
    lowest, highest = np.full(int(pieces.max()) + 1, high), np.full(int(pieces.max()) + 1, low)
    np.minimum.at(lowest, pieces[seen], heights[seen])
    np.maximum.at(highest, pieces[seen], heights[seen])
    return [int(number) for number in np.flatnonzero((lowest <= low) & (highest >= high)) if number]


def _wide(heights: I32, params: StairsParams) -> tuple[I64, I64]:
    """The columns `(N, 2)` of a piece that are part of a square, hidden ones filled in, and their heights `(N,)`."""
    gap, side = round(params.hidden / CELL), round(params.thin / CELL)
    padded = np.pad(heights, gap, constant_values=_NONE)
    seen = (padded > _NONE).view(np.uint8)
    closed = cv2.morphologyEx(seen, cv2.MORPH_CLOSE, np.ones((gap + 1, gap + 1), np.uint8))
    wide = cv2.morphologyEx(closed, cv2.MORPH_OPEN, np.ones((side, side), np.uint8))
    nearest = ndimage.distance_transform_edt(seen == 0, return_distances=False, return_indices=True)
    at = np.argwhere(wide)
    layers = padded[tuple(nearest)][tuple(at.T)].astype(np.int64)
    return at - gap, layers


def _reaches(layers: I64, low: int, high: int, params: StairsParams) -> bool:
    """Whether heights go from `low` to `high` and none between is farther than a step from the next."""
    found = np.unique(layers)
    if not len(found) or found[0] > low or found[-1] < high:
        return False
    return bool((np.diff(found) <= round(params.step / CELL)).all())


def _flights(piece: I64, low: int, high: int, params: StairsParams) -> Iterator[_Flight]:
    """The flights in `(N, 3)` tops: what is joined by steps and reaches from floor to floor, without what is beside."""
    joined = _joined(piece, params)
    _, labels = csgraph.connected_components(joined, directed=False)
    end = round(params.end / CELL)
    for number in np.flatnonzero(np.bincount(labels) > round(params.thin / CELL) ** 2).tolist():
        members = np.flatnonzero(labels == number)
        if not _reaches(piece[members, 2], low + end, high - end, params):
            continue
        flight = _along_way(piece[members], joined[members][:, members], params)
        if flight is not None:
            yield flight


def _joined(piece: I64, params: StairsParams) -> sparse.csr_matrix:
    """Tops within two cells and a step of one another, `(N, N)`, their distance in plan in metres."""
    corner = piece[:, :2].min(axis=0)
    at = piece[:, :2] - corner
    index = np.full(at.max(axis=0) + 5, -1)
    index[tuple((at + 2).T)] = np.arange(len(piece))
    rows, columns, lengths = [], [], []
    for offset in _OFFSETS:
        other = index[tuple((at + 2 + offset).T)]
        one = np.flatnonzero(other >= 0)
        one = one[np.abs(piece[one, 2] - piece[other[one], 2]) <= round(params.step / CELL)]
        rows.append(one)
        columns.append(other[one])
        lengths.append(np.full(len(one), np.hypot(*offset) * CELL))
    entries = (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns)))
    half = sparse.coo_matrix(entries, shape=(len(piece), len(piece)))
    return (half + half.T).tocsr()


def _along_way(piece: I64, joined: sparse.csr_matrix, params: StairsParams) -> _Flight | None:
    """The columns on the way up, which keeps to the middle, and beside it; None where that is too steep."""
    inside = _from_edge(joined)
    way = _way_up(piece, joined, inside)
    points = (piece[way] + 0.5) * CELL
    steps = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    rise = float(np.ptp(points[:, 2]))
    if rise > params.steepest * along[-1]:
        return None
    width = 2.0 * float(np.median(inside[way])) - CELL
    distance, nearest = cKDTree(points * (1.0, 1.0, 2.0)).query((piece + 0.5) * CELL * (1.0, 1.0, 2.0))
    beside = distance <= max(width, params.thin) * params.beside
    return _Flight(piece[beside, :2], piece[beside, 2], along[nearest[beside]], width)


def _from_edge(joined: sparse.csr_matrix) -> F64:
    """Metres from each top over its like to where they end, or where a step is too high, `(N,)`."""
    edge = np.flatnonzero(np.diff((joined == CELL).tocsr().indptr) < 4)
    distance: F64 = csgraph.dijkstra(joined, directed=False, indices=edge, min_only=True) + CELL
    return distance


def _way_up(piece: I64, joined: sparse.csr_matrix, inside: F64) -> I64:
    """The tops on the shortest way from the lowest to the highest ones, dearer the nearer to an edge."""
    pairs = joined.tocoo()
    dear = 1.0 + (0.7 * inside.max() / np.minimum(inside[pairs.row], inside[pairs.col])) ** 2
    cost = sparse.csr_matrix((pairs.data * dear, (pairs.row, pairs.col)), shape=joined.shape)
    bottom = np.flatnonzero(piece[:, 2] <= piece[:, 2].min() + 1)
    top = np.flatnonzero(piece[:, 2] >= piece[:, 2].max() - 1)
    costs, before, _ = csgraph.dijkstra(
        cost, directed=False, indices=bottom, min_only=True, return_predecessors=True
    )
    way = [int(top[np.argmin(costs[top])])]
    while before[way[-1]] >= 0:
        way.append(int(before[way[-1]]))
    return np.array(way[::-1])


def _ends(flight: _Flight, params: StairsParams) -> tuple[F64, F64]:
    """Where one stands before the lowest tread and behind the highest, on the flight's own line, `(2,)` each."""
    middles = (flight.xy + 0.5) * CELL
    length = float(flight.along.max())
    stretch = min(0.8, length / 2)
    found = []
    for outermost, inner in (
        (flight.layer <= flight.layer.min() + 1, flight.along <= stretch),
        (flight.layer >= flight.layer.max() - 1, flight.along >= length - stretch),
    ):
        end = middles[outermost & inner].mean(axis=0)
        way = end - middles[inner & ~outermost].mean(axis=0) if (inner & ~outermost).any() else np.zeros(2)
        found.append(end + params.standing * way / max(float(np.linalg.norm(way)), CELL))
    return found[0], found[1]


def _on_floor(here: SurveyedStorey, place: F64, params: StairsParams) -> F64:
    """The middle of the free cell nearest to `place` `(2,)`, or that place where none is near -> `(3,)`."""
    space = here.space
    cell = np.floor((place - space.origin) / space.resolution).astype(int)[::-1]
    reach = int(np.ceil(params.reach / space.resolution))
    start = np.maximum(cell - reach, 0)
    window = tuple(
        slice(low, max(low, int(high))) for low, high in zip(start.tolist(), cell + reach + 1, strict=True)
    )
    free = np.argwhere(space.occupancy[window] == FREE) + start
    if len(free):
        nearest = free[np.argmin(((free - cell) ** 2).sum(axis=1))]
        place = np.asarray(space.origin) + (nearest[::-1] + 0.5) * space.resolution
    return np.array([*place, here.storey.z])


def _cells(space: FreeSpace, xy: I64) -> Bools:
    """The columns `(N, 2)` (x, y) as a mask `(R, C)` of a grid, their pinholes filled."""
    cells = np.zeros(space.free.shape, bool)
    at = xy[:, ::-1] - np.round(np.asarray(space.origin)[::-1] / space.resolution).astype(np.int64)
    at = at[((at >= 0) & (at < cells.shape)).all(axis=1)]
    if len(at):
        cells[tuple(at.T)] = True
        window = tuple(
            slice(int(low), int(high) + 1) for low, high in zip(at.min(axis=0), at.max(axis=0), strict=True)
        )
        cells[window] = ndimage.binary_fill_holes(cells[window])
    return cells
