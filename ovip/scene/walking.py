"""Walking on a floor grid: clearance, where a robot fits, geodesic distances, shortest paths (SPEC 3, 4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.types import F64, I32, I64, Bools

_MOST_AROUND = 24
"""Cells of radius above which a distance transform is cheaper than one run of cells a row."""
_FEW_SAMPLES = 24


def clearance(grid: FloorGrid) -> F64:
    """Metres from each free cell's centre to the nearest edge of an occupied cell -> `(R, C)`; 0 where not free.

    What was seen in a cell may lie anywhere in it, so only its edge keeps a robot's promise to fit. Unknown cells
    and the grid's edge are no obstacles (one may pass beside them, never stand on them); with nothing occupied
    every free cell's clearance is infinite.
    """
    free = grid.occupancy == FREE
    occupied = grid.occupancy == OCCUPIED
    if not occupied.any():
        return np.where(free, np.inf, 0.0)
    touched = _lattice(occupied)
    distance: F64 = ndimage.distance_transform_edt(~touched, sampling=grid.resolution / 2)
    return np.where(free, distance[1::2, 1::2], 0.0)


def traversable(grid: FloorGrid, radius: float) -> Bools:
    """Cells where a round robot of `radius` metres may stand: free, with clearance >= radius -> `(R, C)`."""
    free = grid.occupancy == FREE
    occupied = grid.occupancy == OCCUPIED
    around = int(np.ceil(radius / grid.resolution + 0.5))
    if around > _MOST_AROUND:
        return np.asarray(free & (clearance(grid) >= radius))
    return np.asarray(free & ~_nearer_than(occupied, radius, grid.resolution, around))


def close_footprints(grid: FloorGrid, boxes: F64) -> FloorGrid:
    """The grid with every cell whose centre lies in the x, y extent of one of `(N, 6)` boxes occupied."""
    occupancy = grid.occupancy.copy()
    rows, columns = occupancy.shape
    for box in np.asarray(boxes, dtype=np.float64).reshape(-1, 6):
        low = np.ceil((box[:2] - grid.origin) / grid.resolution - 0.5).astype(int)
        high = np.floor((box[3:5] - grid.origin) / grid.resolution - 0.5).astype(int) + 1
        x0, y0 = np.clip(low, 0, (columns, rows))
        x1, y1 = np.clip(high, 0, (columns, rows))
        occupancy[y0:y1, x0:x1] = OCCUPIED
    return replace(grid, occupancy=occupancy)


def distance_field(traversable: Bools, start_cell: tuple[int, int], resolution: float) -> F64:
    """Metres walked from the start to every cell, 8-connected -> `(R, C)`; infinite where there is no way.

    A diagonal step is taken only where both cells beside it are traversable (no cutting of corners). A start
    outside the grid or not traversable reaches nothing.
    """
    field = np.full(traversable.shape, np.inf)
    if not _holds(traversable, start_cell):
        return field
    graph, nodes = walk_graph(traversable, resolution)
    start = np.searchsorted(nodes, np.ravel_multi_index(start_cell, traversable.shape))
    field.ravel()[nodes] = csgraph.dijkstra(graph, directed=False, indices=int(start))
    return field


def shortest_path(grid: FloorGrid, start_xy: F64, goal_xy: F64, radius: float, reach: float = 2.0) -> F64:
    """Shortest 8-connected way for a robot of `radius` metres as cell centres -> `(N, 2)`, or `(0, 2)` for
    none.

    Start and goal need not be traversable: both snap to traversable cells at most `reach` metres away, in the
    connected piece of floor where the two snaps together are shortest (so a goal on a table ends beside it,
    on the side that can be walked to). Ties go to the first cell in row-major order.
    """
    walkable = traversable(grid, radius)
    nodes = np.flatnonzero(walkable)
    ends = _snap(grid, walkable, nodes, np.asarray(start_xy)[:2], np.asarray(goal_xy)[:2], reach)
    if ends is None:
        return np.zeros((0, 2))
    start, goal = ends
    graph, _ = walk_graph(walkable, grid.resolution)
    _, before = csgraph.dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    return cell_centres(grid, nodes[chain_back(before, start, goal)])


def straighten(grid: FloorGrid, path: F64, radius: float) -> F64:
    """The path with every stretch that can be walked in a straight line walked so -> `(M, 2)`, M <= N."""
    return path if len(path) < 3 else pull_straight(grid, traversable(grid, radius), path)


def pull_straight(grid: FloorGrid, walkable: Bools, path: F64) -> F64:
    """`straighten` on cells `(R, C)` known to be walkable: from each corner to the farthest point in a clear line."""
    kept = [0]
    while kept[-1] < len(path) - 1:
        here = kept[-1]
        ahead = np.arange(len(path) - 1, here + 1, -1)
        ahead = ahead[_may_be_clear(grid, walkable, path[here], path[ahead])].tolist()
        kept.append(
            next((k for k in ahead if _straight_is_clear(grid, walkable, path[here], path[k])), here + 1)
        )
    return path[kept]


def path_length(path: F64) -> float:
    """Metres along a `(N, D)` polyline; 0 for fewer than two points."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def walk_graph(mask: Bools, resolution: float, beside: Bools | None = None) -> tuple[sparse.csr_matrix, I64]:
    """The steps between neighbouring cells `(R, C)` that are set, 8-connected, without cutting corners.

    An undirected graph `(N, N)` in metres, each step stored once, and the flat indices `(N,)` of its nodes' cells.
    beside: cells `(R, C)` that the corner of a diagonal step may brush; those set where None.
    """
    wide = mask.shape[1] + 2
    number = np.full((mask.shape[0] + 2, wide), -1, dtype=np.int32)
    nodes = np.flatnonzero(mask)
    number[1:-1, 1:-1][mask] = np.arange(len(nodes), dtype=np.int32)
    here = np.flatnonzero(number.ravel() >= 0)
    heads = np.stack([number.ravel()[here + step] for step in (1, wide - 1, wide, wide + 1)], axis=1)
    may_brush = np.pad(mask if beside is None else beside, 1).ravel()
    heads[~(may_brush[here - 1] & may_brush[here + wide]), 1] = -1
    heads[~(may_brush[here + 1] & may_brush[here + wide]), 3] = -1
    there = heads >= 0
    lengths = np.array([1.0, np.sqrt(2.0), 1.0, np.sqrt(2.0)]) * resolution
    starts = np.concatenate([[0], np.cumsum(there.sum(axis=1))]).astype(np.int32)
    steps = (np.broadcast_to(lengths, heads.shape)[there], heads[there], starts)
    return sparse.csr_matrix(steps, shape=(len(nodes), len(nodes))), nodes


def walk_pieces(mask: Bools) -> tuple[I32, int]:
    """Cells `(R, C)` that can be walked to from one another, numbered from 1 (0: not set), and how many pieces.

    A diagonal step needs both cells beside it, so pieces are 4-connected.
    """
    labelled, pieces = ndimage.label(mask)
    return np.asarray(labelled, dtype=np.int32), int(pieces)


def chain_back(before: I32, start: int, goal: int) -> list[int]:
    """From start to goal along the predecessors `(N,)` of a search that began at the start."""
    chain = [goal]
    while chain[-1] != start:
        chain.append(int(before[chain[-1]]))
    return chain[::-1]


def cell_centres(grid: FloorGrid, flat: I64) -> F64:
    """World x, y of the centres of cells given by flat index `(N,)` -> `(N, 2)`."""
    rows, columns = np.unravel_index(flat, grid.occupancy.shape)
    centres: F64 = np.stack([columns + 0.5, rows + 0.5], axis=1) * grid.resolution + np.asarray(grid.origin)
    return centres


def _holds(mask: Bools, cell: tuple[int, int]) -> bool:
    row, column = cell
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])


def _lattice(mask: Bools) -> Bools:
    """Points half a cell apart, `(2R + 1, 2C + 1)`: the corners, edges' middles and centre of every set cell.

    A cell's point nearest to the centre of another one is always among them, so distances are exact.
    """
    rows, columns = mask.shape
    points = np.zeros((2 * rows + 1, 2 * columns + 1), dtype=bool)
    for down in range(3):
        for across in range(3):
            points[down : down + 2 * rows : 2, across : across + 2 * columns : 2] |= mask
    return points


def _nearer_than(occupied: Bools, radius: float, resolution: float, around: int) -> Bools:
    """Cells whose centre is nearer than `radius` metres to the edge of an occupied cell -> `(R, C)`.

    Each row of the disc about a cell is a run of cells, so one running sum along the rows serves every run.
    """
    rows, columns = occupied.shape
    disc = _disc(radius, resolution, around)
    total = np.zeros((rows, columns + 2 * around + 1), dtype=np.int32)
    np.cumsum(np.pad(occupied, ((0, 0), (around, around))), axis=1, out=total[:, 1:])
    near = np.zeros_like(occupied)
    for away, width in enumerate(disc[around:].sum(axis=1).tolist()):
        if not width or away >= rows:
            break
        first = around - width // 2
        run = total[:, first + width : first + width + columns] > total[:, first : first + columns]
        near[away:] |= run[: rows - away]
        near[: rows - away] |= run[away:]
    return near


def _disc(radius: float, resolution: float, around: int) -> Bools:
    """Cells whose centre is nearer than `radius` to the edge of the middle one -> `(2A + 1, 2A + 1)`."""
    middle = np.zeros((2 * around + 1, 2 * around + 1), dtype=bool)
    middle[around, around] = True
    away = ndimage.distance_transform_edt(~_lattice(middle), sampling=resolution / 2)
    return np.asarray(away[1::2, 1::2] < radius)


def _snap(
    grid: FloorGrid, walkable: Bools, nodes: I64, start_xy: F64, goal_xy: F64, reach: float
) -> tuple[int, int] | None:
    """The nodes nearest to start and goal in the piece of floor where both are nearest together."""
    if not len(nodes):
        return None
    centres = cell_centres(grid, nodes)
    to_start = np.linalg.norm(centres - start_xy, axis=1)
    to_goal = np.linalg.norm(centres - goal_xy, axis=1)
    labelled, pieces = walk_pieces(walkable)
    piece = labelled.ravel()[nodes] - 1
    every = np.arange(pieces)
    nearest = np.stack([ndimage.minimum(away, piece, every) for away in (to_start, to_goal)])
    snap = np.where(nearest.max(axis=0) > reach, np.inf, nearest[0] + nearest[1])
    best = int(np.argmin(snap))
    if not np.isfinite(snap[best]):
        return None
    inside = piece == best
    return (
        int(np.argmin(np.where(inside, to_start, np.inf))),
        int(np.argmin(np.where(inside, to_goal, np.inf))),
    )


def _may_be_clear(grid: FloorGrid, walkable: Bools, a: F64, ends: F64) -> Bools:
    """False only where a few of the samples of the segment from `a` to an end `(K, 2)` meet a wall -> `(K,)`."""
    last = _samples(grid, a, ends) - 1
    share = np.rint(np.linspace(0.0, 1.0, _FEW_SAMPLES) * last[:, None]) * (1.0 / last[:, None])
    points = a + np.minimum(share, 1.0)[:, :, None] * (ends - a)[:, None]
    cells = np.floor((points - np.asarray(grid.origin)) / grid.resolution).astype(int)
    return np.asarray(walkable[cells[..., 1], cells[..., 0]].all(axis=1))


def _samples(grid: FloorGrid, a: F64, ends: F64) -> I64:
    """Number of points a quarter cell apart on the segments from `a` to the ends `(K, 2)` -> `(K,)`."""
    steps = np.ceil(np.linalg.norm(ends - a, axis=1) / (0.25 * grid.resolution)).astype(np.int64)
    return np.asarray(np.maximum(2, steps + 1))


def _straight_is_clear(grid: FloorGrid, walkable: Bools, a: F64, b: F64) -> bool:
    """Whether every cell that the segment crosses, sampled at a quarter cell, is walkable."""
    samples = int(_samples(grid, a, b[None])[0])
    points = a + np.linspace(0.0, 1.0, samples)[:, None] * (b - a)
    cells = np.floor((points - np.asarray(grid.origin)) / grid.resolution).astype(int)
    return bool(walkable[cells[:, 1], cells[:, 0]].all())
