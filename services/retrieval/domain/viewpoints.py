"""Tier 4's waypoints: where a robot can stand and what it can see of a region's floor from there (CARA, SPEC
4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ovip.scene.grid import FREE, FloorGrid
from ovip.scene.types import F64, I64, Bools

HEADINGS = tuple(k * np.pi / 3.0 for k in range(6))
"""Six headings 60 degrees apart, radians."""


_SAMPLE_SPACING = 0.15  # metres
_FEW_CELLS = 200


@dataclass(frozen=True, slots=True)
class ViewpointParams:
    """reach: metres at which a small thing is still detected. spacing: metres between candidate waypoints.

    views: from how many waypoints each cell is to be seen, because voting wants that many distinct frames
    (the paper's 52 coverage points for one flat are as dense). least_gain: square metres that a further
    waypoint must add.
    """

    reach: float = 3.0
    spacing: float = 0.4
    views: int = 3
    least_gain: float = 0.25


def plan_waypoints(
    grid: FloorGrid, area: Bools, standing: Bools, params: ViewpointParams | None = None
) -> tuple[tuple[int, int], ...]:
    """Cells to stand on, greedy set cover: each next one sees the most of `area` not yet seen `views` times.

    area: `(R, C)` the region's free cells. standing: `(R, C)` cells that the robot can reach and stand on;
    only those inside the area are taken, or where there are none the ones nearest to it. Ties go to the first
    in row-major order.
    """
    params = params or ViewpointParams()
    candidates = _candidates(grid, area, standing, params)
    if not len(candidates):
        return ()
    cells = _sample(grid, area)
    sees = np.stack([visible(grid, cell, params.reach).ravel()[cells] for cell in candidates])
    missing = np.full(len(cells), params.views)
    least = params.least_gain / grid.resolution**2 * len(cells) / area.sum()
    chosen: list[tuple[int, int]] = []
    open_candidates = np.ones(len(candidates), dtype=bool)
    while open_candidates.any():
        gain = (sees & (missing > 0)).sum(axis=1) * open_candidates
        best = int(np.argmax(gain))
        if (gain[best] < least and chosen) or gain[best] == 0:
            break
        chosen.append((int(candidates[best, 0]), int(candidates[best, 1])))
        missing = missing - sees[best]
        open_candidates[best] = False
    return tuple(chosen)


def visible(
    grid: FloorGrid,
    cell: tuple[int, int] | I64,
    reach: float,
    yaw: float = 0.0,
    field_of_view: float = 2 * np.pi,
) -> Bools:
    """Free floor cells in line of sight of a cell, within `reach` metres and the field of view -> `(R, C)`.

    Anything not free ends the view: low furniture too, so what is seen is never overstated. Rays are a cell
    apart at full reach and sampled twice a cell.
    """
    free = grid.occupancy == FREE
    rows, columns = free.shape
    steps = np.arange(0.0, reach / grid.resolution + 1e-9, 0.5)
    count = max(int(np.ceil(field_of_view * reach / grid.resolution)), 1)
    full = field_of_view >= 2 * np.pi - 1e-9
    angles = yaw + np.linspace(-field_of_view / 2, field_of_view / 2, count, endpoint=not full)
    r = np.rint(cell[0] + np.outer(np.sin(angles), steps)).astype(np.int64)
    c = np.rint(cell[1] + np.outer(np.cos(angles), steps)).astype(np.int64)
    inside = (r >= 0) & (r < rows) & (c >= 0) & (c < columns)
    open_cell = inside & free[np.clip(r, 0, rows - 1), np.clip(c, 0, columns - 1)]
    open_cell[:, 0] = True
    lit = np.logical_and.accumulate(open_cell, axis=1) & inside
    seen = np.zeros_like(free)
    seen[r[lit], c[lit]] = True
    return np.asarray(seen & free)


def snap(standing: Bools, cell: tuple[int, int], most: float) -> tuple[int, int] | None:
    """The standing cell nearest to `cell`, at most `most` cells away; ties go to the first, row by row."""
    places = np.argwhere(standing)
    if not len(places):
        return None
    away = np.hypot(places[:, 0] - cell[0], places[:, 1] - cell[1])
    best = int(np.argmin(away))
    return (int(places[best, 0]), int(places[best, 1])) if away[best] <= most else None


def _sample(grid: FloorGrid, area: Bools) -> npt.NDArray[np.intp]:
    """Flat indices of cells that stand for the area, about 0.15 m apart; all of them in a small area."""
    step = max(round(_SAMPLE_SPACING / grid.resolution), 1)
    thinned = np.zeros_like(area)
    thinned[::step, ::step] = area[::step, ::step]
    cells = np.flatnonzero(thinned)
    return cells if len(cells) >= _FEW_CELLS else np.flatnonzero(area)


def _candidates(
    grid: FloorGrid, area: Bools, standing: Bools, params: ViewpointParams
) -> npt.NDArray[np.int64]:
    """Standing cells of the area on a lattice, and one a connected piece that the lattice misses."""
    inside = area & standing
    if not inside.any():
        return _nearest_outside(grid, area, standing, params)
    step = max(round(params.spacing / grid.resolution), 1)
    lattice = np.zeros_like(inside)
    lattice[::step, ::step] = True
    on_lattice = np.argwhere(inside & lattice)
    return on_lattice if len(on_lattice) else np.argwhere(inside)[:: max(step, 1)]


def _nearest_outside(
    grid: FloorGrid, area: Bools, standing: Bools, params: ViewpointParams
) -> npt.NDArray[np.int64]:
    """For a region that one can only look into: the standing cells within half the reach of it."""
    if not area.any() or not standing.any():
        return np.zeros((0, 2), dtype=np.int64)
    middle = np.argwhere(area).mean(axis=0)
    places = np.argwhere(standing)
    away = np.hypot(*(places - middle).T) * grid.resolution
    return np.asarray(places[away <= params.reach / 2])[:: max(int(params.spacing / grid.resolution), 1)]


def yaw_of(world_from_camera: F64) -> float:
    """Heading of a camera's optical axis on the floor, radians."""
    forward = world_from_camera[:2, 2]
    return float(np.arctan2(forward[1], forward[0]))
