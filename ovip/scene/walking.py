"""Walking on a floor grid: clearance, where a robot fits, geodesic distances, shortest paths (SPEC 3, 4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from ovip.scene.grid import FREE, OCCUPIED, FloorGrid
from ovip.scene.types import F64, I64, Bools


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
    stands: Bools = (grid.occupancy == FREE) & (clearance(grid) >= radius)
    return stands


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
    graph, nodes = _walk_graph(traversable, resolution)
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
    graph, nodes = _walk_graph(walkable, grid.resolution)
    ends = _snap(grid, graph, nodes, np.asarray(start_xy)[:2], np.asarray(goal_xy)[:2], reach)
    if ends is None:
        return np.zeros((0, 2))
    start, goal = ends
    _, before = csgraph.dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    chain = [goal]
    while chain[-1] != start:
        chain.append(int(before[chain[-1]]))
    return _centres(grid, nodes[chain[::-1]])


def straighten(grid: FloorGrid, path: F64, radius: float) -> F64:
    """The path with every stretch that can be walked in a straight line walked so -> `(M, 2)`, M <= N."""
    if len(path) < 3:
        return path
    walkable = traversable(grid, radius)
    kept = [0]
    while kept[-1] < len(path) - 1:
        here = kept[-1]
        ahead = range(len(path) - 1, here + 1, -1)
        kept.append(
            next((k for k in ahead if _straight_is_clear(grid, walkable, path[here], path[k])), here + 1)
        )
    return path[kept]


def path_length(path: F64) -> float:
    """Metres along a `(N, D)` polyline; 0 for fewer than two points."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


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


def _walk_graph(mask: Bools, resolution: float) -> tuple[sparse.csr_matrix, I64]:
    """The 8-connected graph of the cells that are set, weights in metres, and those cells' flat indices."""
    nodes = np.flatnonzero(mask)
    number = np.full(mask.shape, -1, dtype=np.int64)
    number.ravel()[nodes] = np.arange(len(nodes))
    across = mask[:, :-1] & mask[:, 1:]
    down = mask[:-1] & mask[1:]
    square = across[:-1] & across[1:]
    steps = (
        (number[:, :-1][across], number[:, 1:][across], 1.0),
        (number[:-1][down], number[1:][down], 1.0),
        (number[:-1, :-1][square], number[1:, 1:][square], np.sqrt(2.0)),
        (number[:-1, 1:][square], number[1:, :-1][square], np.sqrt(2.0)),
    )
    tails = np.concatenate([tail for tail, _, _ in steps])
    heads = np.concatenate([head for _, head, _ in steps])
    weights = np.concatenate([np.full(len(tail), length * resolution) for tail, _, length in steps])
    return sparse.csr_matrix((weights, (tails, heads)), shape=(len(nodes), len(nodes))), nodes


def _snap(
    grid: FloorGrid, graph: sparse.csr_matrix, nodes: I64, start_xy: F64, goal_xy: F64, reach: float
) -> tuple[int, int] | None:
    """The nodes nearest to start and goal in the piece of floor where both are nearest together."""
    if not len(nodes):
        return None
    centres = _centres(grid, nodes)
    to_start = np.linalg.norm(centres - start_xy, axis=1)
    to_goal = np.linalg.norm(centres - goal_xy, axis=1)
    pieces, piece = csgraph.connected_components(graph, directed=False)
    every = np.arange(pieces)
    snap = ndimage.minimum(to_start, piece, every) + ndimage.minimum(to_goal, piece, every)
    snap[
        np.maximum(ndimage.minimum(to_start, piece, every), ndimage.minimum(to_goal, piece, every)) > reach
    ] = np.inf
    best = int(np.argmin(snap))
    if not np.isfinite(snap[best]):
        return None
    inside = piece == best
    return (
        int(np.argmin(np.where(inside, to_start, np.inf))),
        int(np.argmin(np.where(inside, to_goal, np.inf))),
    )


def _centres(grid: FloorGrid, flat: I64) -> F64:
    rows, columns = np.unravel_index(flat, grid.occupancy.shape)
    centres: F64 = np.stack([columns + 0.5, rows + 0.5], axis=1) * grid.resolution + np.asarray(grid.origin)
    return centres


def _straight_is_clear(grid: FloorGrid, walkable: Bools, a: F64, b: F64) -> bool:
    """Whether every cell that the segment crosses, sampled at a quarter cell, is walkable."""
    samples = max(2, int(np.ceil(np.linalg.norm(b - a) / (0.25 * grid.resolution))) + 1)
    points = a + np.linspace(0.0, 1.0, samples)[:, None] * (b - a)
    cells = np.floor((points - np.asarray(grid.origin)) / grid.resolution).astype(int)
    return bool(walkable[cells[:, 1], cells[:, 0]].all())
