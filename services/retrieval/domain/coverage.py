"""Absence conditioned on coverage: floor seen by region, viewpoints, and a Bayesian posterior (CARA, SPEC 4).

Bayesian search (Stone 1975). Prior: the target is present with probability p0 = max_r S(goal | r), clipped,
and if present it is in region r with w_r = S_r / sum S, spread evenly over its floor. A view that has a cell
in sight detects the target there with probability d. With n_c views of cell c,

    m_r = mean over cells of r of (1 - d)^n_c           P(missed | in r)
    P(present | nothing found) = p0 M / (p0 M + 1 - p0),   M = sum_r w_r m_r
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.answers import Coverage, RegionCoverage
from ovip.scene.grid import FloorGrid
from ovip.scene.types import I64, Bools, Region
from services.retrieval.domain.viewpoints import visible


@dataclass(frozen=True, slots=True)
class CoverageParams:
    """detection_rate: d, one view's chance to detect a thing whose place it sees; assumed, not the paper's.

    most_certain: p0 is never nearer to 0 or 1 than this.
    """

    detection_rate: float = 0.7
    most_certain: float = 0.05


@dataclass(frozen=True, slots=True)
class View:
    """A frame of this search on one floor's grid. x, y metres; yaw and field_of_view radians."""

    floor: int
    x: float
    y: float
    yaw: float
    field_of_view: float


def times_seen(grid: FloorGrid, views: Sequence[View], reach: float) -> I64:
    """By how many views each free floor cell was seen -> `(R, C)`; views of other floors do not count."""
    counts: I64 = np.zeros(grid.occupancy.shape, dtype=np.int64)
    for view in views:
        cell = grid.cell_of(np.array([view.x, view.y]))
        inside = 0 <= cell[0] < counts.shape[0] and 0 <= cell[1] < counts.shape[1]
        if view.floor == grid.floor and inside:
            counts += visible(grid, cell, reach, view.yaw, view.field_of_view)
    return counts


def region_cells(grid: FloorGrid, region_id: str) -> Bools:
    """Cells of a region -> `(R, C)`; none where the grid does not hold it."""
    if region_id not in grid.region_ids:
        return np.zeros(grid.regions.shape, dtype=bool)
    return np.asarray(grid.regions == 1 + grid.region_ids.index(region_id))


def seen_share(counts: I64, area: Bools) -> float:
    """Share of the area's cells seen at least once, 0..1; 0 for no area."""
    cells = int(area.sum())
    return float((counts[area] > 0).sum() / cells) if cells else 0.0


def missed(counts: I64, area: Bools, params: CoverageParams | None = None) -> float:
    """m_r: the chance that a target in the area was missed by every view; 1 for no area or no view."""
    params = params or CoverageParams()
    return float(np.mean((1.0 - params.detection_rate) ** counts[area])) if area.any() else 1.0


def posterior_present(
    priors: Sequence[float], misses: Sequence[float], params: CoverageParams | None = None
) -> float:
    """P(present | nothing found) from S and m by region; without regions one half, for nothing is known."""
    params = params or CoverageParams()
    if not len(priors):
        return 0.5
    prior = np.asarray(priors, dtype=np.float64)
    present = float(np.clip(prior.max(), params.most_certain, 1.0 - params.most_certain))
    share = prior / prior.sum() if prior.sum() > 0 else np.full(len(prior), 1.0 / len(prior))
    still = present * float(share @ np.asarray(misses, dtype=np.float64))
    return still / (still + 1.0 - present)


def assess(
    regions: Sequence[Region],
    priors: Mapping[str, float],
    grids: Mapping[int, FloorGrid],
    views: Sequence[View],
    counted: tuple[int, int, int],
    reach: float,
    params: CoverageParams | None = None,
) -> Coverage:
    """The account of a search: `counted` is (viewpoints planned, visited, unreachable).

    complete is the paper's strict boolean: something was planned and every one of them was visited.
    """
    params = params or CoverageParams()
    planned, visited, unreachable = counted
    counts = {floor: times_seen(grid, views, reach) for floor, grid in grids.items()}
    areas = {r.region_id: _area(grids, r) for r in regions}
    seen = {
        r.region_id: seen_share(counts[r.floor], areas[r.region_id]) if r.floor in grids else 0.0
        for r in regions
    }
    miss = [missed(counts[r.floor], areas[r.region_id], params) if r.floor in grids else 1.0 for r in regions]
    return Coverage(
        planned=planned,
        visited=visited,
        unreachable=unreachable,
        regions=tuple(
            RegionCoverage(r.region_id, r.display_name, r.area, seen[r.region_id], priors[r.region_id])
            for r in regions
        ),
        posterior_present=posterior_present([priors[r.region_id] for r in regions], miss, params),
        complete=planned > 0 and visited == planned,
    )


def _area(grids: Mapping[int, FloorGrid], region: Region) -> Bools:
    grid = grids.get(region.floor)
    return region_cells(grid, region.region_id) if grid else np.zeros((0, 0), dtype=bool)
