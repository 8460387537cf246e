"""Where doorways, open borders, stairs and frontiers lie in a plan: their lines, in world metres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.scene.grid import UNKNOWN, FloorGrid
from ovip.scene.types import F64, U16, Bools, Frontier, RegionEdge

_LEAST_REACH = 0.4
"""Metres around a mark's middle that are looked at, at least."""

_SLACK = 0.3
"""Metres by which a frontier's line may go on past its width, and gaps in it that are bridged."""
_TREAD = 0.28
"""Metres from one tread of a flight to the next."""


def passage_line(grid: FloorGrid, edge: RegionEdge) -> F64:
    """The ends `(2, 2)` of the line through which one goes from `edge.a` to `edge.b`, as long as it is wide."""
    return _through(edge.position[:2], edge.width, _crossings(grid, edge))


def frontier_lines(grid: FloorGrid, frontier: Frontier, outlines: Sequence[F64]) -> tuple[F64, ...]:
    """The parts `(N, 2)` of its region's outlines along which seen floor ends, near the frontier."""
    parts = []
    for ring in outlines:
        points = _along(ring, grid.resolution)
        near = np.linalg.norm(points - frontier.position[:2], axis=1) <= 0.5 * frontier.width + _SLACK
        kept = np.flatnonzero(near & _beside_unknown(grid, points))
        runs = np.split(kept, np.flatnonzero(np.diff(kept) > round(_SLACK / grid.resolution)) + 1)
        parts += [points[run] for run in runs if len(run) > 1]
    return tuple(parts) or (_through(frontier.position[:2], frontier.width, np.zeros((0, 2))),)


def stairs_lines(stairs: RegionEdge) -> tuple[F64, tuple[F64, ...], F64]:
    """The rim `(4, 2)` of a flight in plan, its treads and the line that leads up `(2, 2)`; a flight that rises on the
    spot is shown as long as it is wide."""
    foot = stairs.position[:2]
    run = (foot if stairs.upper is None else stairs.upper[:2]) - foot
    length = float(np.linalg.norm(run))
    along = run / length if length > 0.0 else np.array([1.0, 0.0])
    length = max(length, stairs.width)
    side = 0.5 * stairs.width * np.array([-along[1], along[0]])
    head = foot + length * along
    steps = max(2, round(length / _TREAD))
    treads = tuple(
        np.stack([foot + at * along - side, foot + at * along + side])
        for at in np.linspace(0.0, length, steps + 1)[1:-1]
    )
    rim = np.stack([foot - side, head - side, head + side, foot + side])
    return rim, treads, np.stack([foot, head])


def _through(middle: F64, width: float, points: F64) -> F64:
    """A line of a length through `middle`, along the main direction of `points` `(N, 2)`; along x where none."""
    along = np.array([1.0, 0.0])
    if len(points) > 1:
        apart = points - points.mean(axis=0)
        along = np.linalg.eigh(apart.T @ apart)[1][:, -1]
    along = along if (along[0], along[1]) > (0.0, 0.0) else -along
    return middle + 0.5 * width * np.stack([-along, along])


def _crossings(grid: FloorGrid, edge: RegionEdge) -> F64:
    """Middles `(N, 2)` of the cell edges between the two regions, near the passage."""
    labels, (row, column) = _around(grid, edge.position[:2], edge.width)
    numbers = {name: 1 + index for index, name in enumerate(grid.region_ids)}
    pair = {numbers.get(edge.a, -1), numbers.get(edge.b, -1)}
    a, b = min(pair), max(pair)
    found = []
    for one, other, step in (
        (labels[:-1], labels[1:], (0.5, 0.0)),
        (labels[:, :-1], labels[:, 1:], (0.0, 0.5)),
    ):
        at = np.argwhere(((one == a) & (other == b)) | ((one == b) & (other == a)))
        found.append(at + np.asarray(step))
    return _world(grid, np.concatenate(found) + np.array([row, column]))


def _along(ring: F64, step: float) -> F64:
    """Points `(N, 2)` on a ring, at most `step` metres apart, its first again at the end."""
    pieces = []
    for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(end - start) / step)))
        pieces.append(start + np.arange(count)[:, None] / count * (end - start))
    return np.concatenate([*pieces, ring[:1]])


def _beside_unknown(grid: FloorGrid, points: F64) -> Bools:
    """Whether a cell that was never seen, and is no region's, lies within 1.5 cells of each point `(N, 2)`."""
    unseen = np.pad((grid.occupancy == UNKNOWN) & (grid.regions == 0), 3, constant_values=True)
    cells = np.floor((points - grid.origin) / grid.resolution).astype(np.int64)[:, ::-1] + 3
    beside = np.zeros(len(points), bool)
    for row in (-1, 0, 1):
        for column in (-1, 0, 1):
            at = np.clip(cells + np.array([row, column]), 0, np.asarray(unseen.shape) - 1)
            beside |= unseen[at[:, 0], at[:, 1]]
    return beside


def _around(grid: FloorGrid, xy: F64, width: float) -> tuple[U16, tuple[int, int]]:
    """Region labels in a square about a point, with the row and column of its first cell."""
    row, column = grid.cell_of(xy)
    reach = int(np.ceil(max(_LEAST_REACH, 0.5 * width) / grid.resolution)) + 1
    row, column = max(0, row - reach), max(0, column - reach)
    size = 2 * reach + 1
    labels: U16 = grid.regions[row : row + size, column : column + size]
    return labels, (row, column)


def _world(grid: FloorGrid, cells: F64) -> F64:
    """(row, column) `(N, 2)`, cell centres at integers, as world x, y."""
    xy: F64 = (cells[:, ::-1] + 0.5) * grid.resolution + np.asarray(grid.origin)
    return xy
