"""Knowledge-guided semantic watershed (KGSW, the paper's Algorithm 1, lines 1 to 22), on one storey.

Decided here where the paper is silent: Dilate is by a disc of `dilation` cells; the core threshold; A_min;
that a disc stays inside its own core (no wall is thinner than a marker otherwise); that objects of unknown
function make no seed group in a core where another function is known; and that a map too small for any core
or marker is still one region for each connected piece.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from skimage.graph import MCP_Geometric
from skimage.segmentation import watershed

from ovip.scene.clusters import clusters
from ovip.scene.types import F64, I32, I64, Bools

UNKNOWN_FUNCTION = "unknown"


class Relief(StrEnum):
    """What the last watershed floods.

    CLEARANCE is the paper's -D. On it, the marker that lies deepest in an open space takes all of that space,
    and markers along its walls keep little more than their discs. ARRIVAL, ours, is the time at which a front
    that spreads from all markers with speed D arrives: borders still fall in narrow places, where fronts are
    slow, and an open space is shared by distance.
    """

    CLEARANCE = "clearance"
    ARRIVAL = "arrival"


@dataclass(frozen=True, slots=True)
class PartitionParams:
    """dilation, marker_radius, eps: the paper's Table of settings (DIL = 6 cells, r = 0.30 m, 2.0 m).

    min_core: the core threshold, square metres after dilation; min_unknown: A_min, square metres (both ours).
    relief: what the last watershed floods, see `Relief`.
    """

    resolution: float = 0.05
    dilation: int = 6
    marker_radius: float = 0.30
    eps: float = 2.0
    min_core: float = 0.25
    min_unknown: float = 1.0
    relief: Relief = Relief.CLEARANCE


@dataclass(frozen=True, slots=True)
class SeedGroup:
    """One marker's origin: the objects (indices) that made it, in which core, and their function."""

    function: str
    core: int
    members: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class StoreyPartition:
    """R and how it came about.

    labels: R, `(R, C)` int32, 0 = no region, else 1 + index into `groups`. cores: C, `(R, C)` int32.
    region_of_object: `(N,)`, index into `groups`, -1 where there is no region at all.
    """

    labels: I32
    cores: I32
    groups: tuple[SeedGroup, ...]
    region_of_object: I64


def partition_storey(
    free: Bools, cells: F64, functions: tuple[str, ...], params: PartitionParams | None = None
) -> StoreyPartition:
    """Algorithm 1 on free space F `(R, C)`, object centres p_i as (row, column) cells `(N, 2)`, and types
    t_i.

    Cell (row, column) has its centre at (row, column). Deterministic; ties are stated at each step.
    """
    params = params or PartitionParams()
    if not free.any():
        empty = np.zeros(free.shape, np.int32)
        return StoreyPartition(empty, empty, (), np.full(len(functions), -1, dtype=np.int64))
    clearance = clearance_of(free, params.resolution)  # 1: D(x) = min over y not in F of |x - y|
    cores = find_cores(free, params)  # 2, 3: C_0
    basins = watershed(-clearance, cores, mask=free)  # 4: C = Watershed(-D, C_0; F)
    snapped = snap(cells, basins > 0)  # 6 (line 5, the functions t_i, came in)
    groups = seed_groups(basins, snapped, functions, params)  # 7-20
    markers = place_markers(basins, snapped, groups, params)  # 12, 20: M
    kept = [k for k in range(len(groups)) if (markers == k + 1).any()]
    markers = _renumber(markers, kept)
    relief = -clearance if params.relief is Relief.CLEARANCE else arrival(clearance, markers)
    labels = watershed(relief, markers, mask=free)  # 22: R = Watershed(-D, M; F)
    return StoreyPartition(
        labels=labels.astype(np.int32),
        cores=basins.astype(np.int32),
        groups=tuple(groups[k] for k in kept),
        region_of_object=regions_at(labels, cells),
    )


def clearance_of(free: Bools, resolution: float) -> F64:
    """D: metres from each free cell to the nearest that is not, the grid's edge included -> `(R, C)`."""
    if not free.size:
        return np.zeros(free.shape)
    distance: F64 = ndimage.distance_transform_edt(np.pad(free, 1), sampling=resolution)[1:-1, 1:-1]
    return distance


def find_cores(free: Bools, params: PartitionParams) -> I32:
    """C_0 = connected components of F minus Dilate(not F), small ones removed -> `(R, C)`, 0 = none.

    Components connect by edges. Where none is left, every connected piece of F is one core, so that a map
    with no place wider than twice the dilation still has regions.
    """
    dilated = clearance_of(free, 1.0) <= params.dilation
    cores = _components(free & ~dilated, params.min_core / params.resolution**2)
    return cores if cores.any() else _components(free, 1)


def snap(cells: F64, target: Bools) -> I64:
    """The nearest cell of `target` to each of `(N, 2)` cells -> `(N, 2)`; -1 where `target` is empty.

    Ties go to the first such cell in row-major order.
    """
    cells = np.asarray(cells, dtype=np.float64).reshape(-1, 2)
    places = np.argwhere(target)
    if not len(places) or not len(cells):
        return np.full(cells.shape, -1, dtype=np.int64)
    tree = cKDTree(places)
    distance, _ = tree.query(cells)
    near = tree.query_ball_point(cells, distance + 1e-6)
    first = [min(candidates) for candidates in near]
    nearest: I64 = places[first].astype(np.int64)
    return nearest


def seed_groups(
    basins: I32, snapped: I64, functions: tuple[str, ...], params: PartitionParams
) -> tuple[SeedGroup, ...]:
    """Pi_c of every core c, in the order of the cores and, within one, of first members (Eq. 6)."""
    core_of = basins[tuple(snapped.T)] if basins.any() else np.zeros(len(snapped), np.int64)
    areas = np.bincount(basins.ravel(), minlength=int(basins.max(initial=0)) + 1) * params.resolution**2
    groups: list[SeedGroup] = []
    for core in range(1, len(areas)):
        members = np.flatnonzero(core_of == core)
        if not len(members):
            if areas[core] >= params.min_unknown:
                groups.append(SeedGroup(UNKNOWN_FUNCTION, core, ()))
        else:
            groups += _groups_of_core(core, members, snapped, functions, params)
    if not groups and len(areas) > 1:
        groups = [SeedGroup(UNKNOWN_FUNCTION, int(np.argmax(areas[1:])) + 1, ())]
    return tuple(groups)


def place_markers(basins: I32, snapped: I64, groups: tuple[SeedGroup, ...], params: PartitionParams) -> I32:
    """M: discs of radius r about each group's objects, inside their core; the whole core of a group of none.

    -> `(R, C)`, 0 = none, else 1 + index of the group. A cell in several discs goes to the nearest object's
    group; ties to the earlier group. A group all of whose cells go to others has no marker.
    """
    markers = np.zeros(basins.shape, np.int32)
    nearest = np.full(basins.shape, np.inf)
    for number, group in enumerate(groups, start=1):
        if not group.members:
            markers[basins == group.core] = number
        for row, column in snapped[list(group.members)]:
            window, distance = _disc(basins.shape, int(row), int(column), params)
            wins = (distance <= params.marker_radius + 1e-9) & (basins[window] == group.core)
            wins &= distance < nearest[window]
            markers[window][wins] = number
            nearest[window][wins] = distance[wins]
    return markers


def arrival(clearance: F64, markers: I32) -> F64:
    """When a front from all markers, moving at speed D, gets to each cell -> `(R, C)`; 0 for never."""
    starts = np.argwhere((markers > 0) & (clearance > 0))
    if not len(starts):
        return np.zeros(clearance.shape)
    slowness = np.where(clearance > 0, 1.0 / np.maximum(clearance, 1e-9), -1.0)
    times, _ = MCP_Geometric(slowness).find_costs(starts)
    return np.where(np.isfinite(times), times, 0.0)


def regions_at(labels: I32, cells: F64) -> I64:
    """The region at, or nearest to, each of `(N, 2)` (row, column) cells -> `(N,)`; -1 for none."""
    places = snap(cells, labels > 0)
    if not labels.any():
        return np.full(len(places), -1, dtype=np.int64)
    regions: I64 = labels[tuple(places.T)].astype(np.int64) - 1
    return regions


def cluster(points: F64, eps: float) -> list[I64]:
    """DBSCAN of `(N, 2)` points with min_samples 1: the connected pieces of the graph of pairs within `eps`.

    Each piece is its members' indices, rising; pieces come in the order of their first members.
    """
    if not len(points):
        return []
    piece = clusters(points, eps)
    return [np.flatnonzero(piece == k) for k in range(piece.max() + 1)]


def _groups_of_core(
    core: int, members: I64, snapped: I64, functions: tuple[str, ...], params: PartitionParams
) -> list[SeedGroup]:
    kinds = [functions[i] for i in members]
    known = sorted({kind for kind in kinds if kind != UNKNOWN_FUNCTION})
    if len(known) <= 1:
        return [SeedGroup(known[0] if known else UNKNOWN_FUNCTION, core, tuple(int(i) for i in members))]
    groups: list[SeedGroup] = []
    for kind in known:
        same = members[[k == kind for k in kinds]]
        pieces = cluster(snapped[same].astype(np.float64) * params.resolution, params.eps)
        groups += [SeedGroup(kind, core, tuple(int(i) for i in same[piece])) for piece in pieces]
    return sorted(groups, key=lambda group: group.members[0])


def _components(mask: Bools, min_cells: float) -> I32:
    pieces, _ = ndimage.label(mask)
    sizes = np.bincount(pieces.ravel()) if pieces.size else np.zeros(1, np.int64)
    kept = [k for k in range(1, len(sizes)) if sizes[k] >= min_cells]
    return _renumber(pieces, [k - 1 for k in kept])


def _renumber(labels: I32, kept: list[int]) -> I32:
    """Labels 1 + k for k in `kept` become 1, 2, ..; all others 0."""
    table = np.zeros(int(labels.max(initial=0)) + 1, np.int32)
    for new, old in enumerate(kept, start=1):
        table[old + 1] = new
    return table[labels]


def _disc(
    shape: tuple[int, ...], row: int, column: int, params: PartitionParams
) -> tuple[tuple[slice, slice], F64]:
    """The window of the grid that holds a marker disc, and its cells' distances from the centre, metres."""
    reach = int(np.ceil(params.marker_radius / params.resolution))
    rows = slice(max(0, row - reach), min(shape[0], row + reach + 1))
    columns = slice(max(0, column - reach), min(shape[1], column + reach + 1))
    down, across = np.ogrid[rows, columns]
    return (rows, columns), np.hypot(down - row, across - column) * params.resolution
