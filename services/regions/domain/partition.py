"""Knowledge-guided semantic watershed (KGSW, the paper's Algorithm 1, lines 1 to 26), on one storey.

The numbers beside the code are the lines of the paper's listing, its ends counted. The defaults of `PartitionParams`
are the algorithm to the letter. Decided here where the paper is silent: Dilate is by a disc of `dilation` cells; the
core threshold; A_min; that a disc stays inside its own core (no wall is thinner than a marker otherwise); that objects
of unknown function make no seed group in a core where another function is known; and that a map too small for any core
or marker is still one region for each connected piece. What goes beyond the paper is a parameter: `votes`, `growth`,
`min_part` and `merge_width`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ovip.scene.clusters import clusters
from ovip.scene.types import F32, F64, I32, I64, Bools
from services.regions.domain.adjacency import find_openings
from services.regions.domain.cells import nearest_cells
from services.regions.domain.flooding import clearance_of, components, flood, renumber, share_by_distance

UNKNOWN_FUNCTION = "unknown"


class Growth(StrEnum):
    """How the last watershed grows the markers.

    CLEARANCE is the paper's: all markers flood -D over all of F. On it, the marker that lies deepest in an open space
    takes all of that space, and markers along its walls keep little more than their discs. DISTANCE, ours, keeps the
    geometric basins: one with a single group is its region, and a mixed one goes, cell by cell, to the marker nearest
    by a way inside it.
    """

    CLEARANCE = "clearance"
    DISTANCE = "distance"


@dataclass(frozen=True, slots=True)
class PartitionParams:
    """dilation, marker_radius, eps: the paper's Table of settings (DIL = 6 cells, r = 0.30 m, 2.0 m).

    min_core: the core threshold, square metres after dilation; min_unknown: A_min, square metres (both ours).
    votes: what the objects of a seed group of a mixed core, two at least, must have together, else they follow their
    core's other groups (0: the paper, a single odd object makes a region). vote_share: in a core with few votes, this
    share of them is enough. sparse: in a core with less than a vote for so many square metres, where furniture is all
    that is known, one object with a whole vote makes a group too. growth: see `Growth`. min_part: by distance, a part
    of a mixed basin below so many square metres goes to the others. merge_width: regions of one function that share a
    border of at least so many metres are one (infinite: the paper, none are).
    """

    resolution: float = 0.05
    dilation: int = 6
    marker_radius: float = 0.30
    eps: float = 2.0
    min_core: float = 0.25
    min_unknown: float = 1.0
    votes: float = 0.0
    vote_share: float = 0.1
    sparse: float = 15.0
    growth: Growth = Growth.CLEARANCE
    min_part: float = 0.0
    merge_width: float = float("inf")


@dataclass(frozen=True, slots=True)
class SeedGroup:
    """One marker's origin: the objects (indices) that made it, in which core, and their function."""

    function: str
    core: int
    members: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class StoreyPartition:
    """R and how it came about.

    labels: R, `(R, C)` int32, 0 = no region, else 1 + index into `functions`. basins: C, `(R, C)` int32, 0 = none.
    groups: what the regions grew from, in the order of their markers; merged regions have several.
    """

    labels: I32
    functions: tuple[str, ...]
    basins: I32
    groups: tuple[SeedGroup, ...]


def partition_storey(
    free: Bools,
    cells: F64,
    functions: Sequence[str],
    params: PartitionParams | None = None,
    votes: F64 | None = None,
) -> StoreyPartition:
    """Algorithm 1 on free space F `(R, C)`, object centres p_i as (row, column) cells `(N, 2)`, and types t_i.

    votes: `(N,)` how much each object vouches for its type, 0..1; one each where not given. Cell (row, column) has its
    centre at (row, column). Deterministic; ties are stated at each step.
    """
    params = params or PartitionParams()
    if not free.any():
        empty = np.zeros(free.shape, np.int32)
        return StoreyPartition(empty, (), empty, ())
    clearance = clearance_of(free, params.resolution)  # 1: D(x) = min over y not in F of |x - y|
    cores = find_cores(free, clearance, params)  # 2, 3: C_0
    basins = flood(-clearance, cores, free)  # 4: C = Watershed(-D, C_0; F)
    snapped = nearest_cells(cells, basins > 0)  # 6 (line 5, the functions t_i, came in)
    groups = seed_groups(basins, snapped, functions, params, votes)  # 7-19: O_c, T_c, Pi_c
    markers = place_markers(basins, snapped, groups, params)  # 11, 20-22: M
    labels = grow(clearance, basins, markers, groups, params)  # 26: R = Watershed(-D, M; F)
    labels, named = merged(labels, [group.function for group in groups], params)
    return StoreyPartition(labels, named, basins, groups)


def find_cores(free: Bools, clearance: F32, params: PartitionParams) -> I32:
    """C_0 = connected components of F minus Dilate(not F), small ones removed -> `(R, C)`, 0 = none.

    Components connect by edges. Where none is left, every connected piece of F is one core, so that a map
    with no place wider than twice the dilation still has regions.
    """
    beyond = clearance > np.float32((params.dilation + 1e-3) * params.resolution)
    cores = components(free & beyond, params.min_core / params.resolution**2)
    return cores if cores.any() else components(free, 1)


def seed_groups(
    basins: I32,
    snapped: I64,
    functions: Sequence[str],
    params: PartitionParams,
    votes: F64 | None = None,
) -> tuple[SeedGroup, ...]:
    """Pi_c of every core c, in the order of the cores and, within one, of first members (Eq. 5)."""
    votes = np.ones(len(functions)) if votes is None else votes
    core_of = basins[tuple(snapped.T)] if basins.any() else np.zeros(len(snapped), np.int32)
    kinds = np.array(functions, dtype=np.str_)
    pieces = _pieces(core_of, kinds, snapped, params)
    areas = np.bincount(basins.ravel(), minlength=int(basins.max(initial=0)) + 1) * params.resolution**2
    groups: list[SeedGroup] = []
    for core, members in enumerate(_members(core_of, len(areas))[1:], start=1):  # 7, 8: O_c
        if len(members):
            groups += _groups_of_core(core, areas[core], members, kinds, pieces, votes, params)  # 13-19
        elif areas[core] >= params.min_unknown:  # 9, 10
            groups.append(SeedGroup(UNKNOWN_FUNCTION, core, ()))  # 11
    if not groups and len(areas) > 1:
        groups = [SeedGroup(UNKNOWN_FUNCTION, int(np.argmax(areas[1:])) + 1, ())]
    return tuple(groups)


def place_markers(basins: I32, snapped: I64, groups: Sequence[SeedGroup], params: PartitionParams) -> I32:
    """M: discs of radius r about each group's objects, inside their core; the whole core of a group of none.

    -> `(R, C)`, 0 = none, else 1 + index of the group. A cell in several discs goes to the nearest object's
    group; ties to the earlier group. A group all of whose cells go to others has no marker.
    """
    numbers = np.zeros(int(basins.max(initial=0)) + 1, np.int32)
    for number, group in enumerate(groups, start=1):
        if not group.members:
            numbers[group.core] = number
    markers = numbers[basins]
    places, owner = _discs(basins, snapped, groups, params)
    markers[tuple(places.T)] = owner
    return markers


def grow(
    clearance: F32, basins: I32, markers: I32, groups: Sequence[SeedGroup], params: PartitionParams
) -> I32:
    """R from M: `(R, C)`, 1 + index of the group; 0 where no marker can get to. See `Growth`."""
    free = clearance > 0
    if params.growth is Growth.CLEARANCE:
        return flood(-clearance, markers, free)
    lone = np.zeros(int(basins.max(initial=0)) + 1, np.int32)
    marked = [number for number in np.unique(markers).tolist() if number]
    cores = np.array([groups[number - 1].core for number in marked], np.int64)
    for number, core in zip(marked, cores.tolist(), strict=True):
        lone[core] = number if (cores == core).sum() == 1 else 0
    labels = lone[basins]
    mixed = np.isin(basins, np.setdiff1d(cores, np.flatnonzero(lone)))
    for core, rows, columns in _windows(basins * mixed):
        mine = basins[rows, columns] == core
        labels[rows, columns][mine] = _parts(markers[rows, columns] * mine, mine, params)[mine]
    return flood(-clearance, labels, free)  # basins without a marker go to their neighbours


def merged(labels: I32, functions: Sequence[str], params: PartitionParams) -> tuple[I32, tuple[str, ...]]:
    """R with regions of one function that share a wide border made one, renumbered, and their functions.

    A region without a cell is left out. The union is numbered as the first of its parts.
    """
    root = list(range(len(functions) + 1))
    openings = find_openings(labels, params.resolution) if np.isfinite(params.merge_width) else ()
    for opening in openings:
        a, b = _root(root, opening.a + 1), _root(root, opening.b + 1)
        if opening.width >= params.merge_width and functions[opening.a] == functions[opening.b]:
            root[max(a, b)] = min(a, b)
    joined = np.array([_root(root, k) for k in range(len(root))], np.int32)[labels]
    kept = [number for number in np.unique(joined).tolist() if number]
    return renumber(joined, kept), tuple(functions[number - 1] for number in kept)


def _pieces(core_of: I32, kinds: NDArray[np.str_], snapped: I64, params: PartitionParams) -> I64:
    """DB_eps, DBSCAN with min_samples 1, of each type of each core -> `(N,)`: the number of each object's piece.

    A piece is a connected part of the graph of pairs within eps; pieces are numbered in order of their first objects.
    """
    if not len(kinds):
        return np.zeros(0, np.int64)
    _, kind = np.unique(kinds, return_inverse=True)
    apart = (core_of.astype(np.int64) * (kind.max() + 1) + kind) * 10.0 * params.eps
    return clusters(np.column_stack([snapped * params.resolution, apart]), params.eps)


def _groups_of_core(
    core: int,
    area: float,
    members: I64,
    kinds: NDArray[np.str_],
    pieces: I64,
    votes: F64,
    params: PartitionParams,
) -> list[SeedGroup]:
    known = members[kinds[members] != UNKNOWN_FUNCTION]
    found = dict.fromkeys(pieces[known].tolist())  # 14, 18: T_c, DB_eps
    groups = [
        SeedGroup(str(kinds[same[0]]), core, tuple(same.tolist()))
        for same in (known[pieces[known] == piece] for piece in found)
    ]
    groups = _elected(groups, votes, area, params)
    if len({group.function for group in groups}) <= 1:  # 15, 16: one type, one group
        function = groups[0].function if groups else UNKNOWN_FUNCTION
        return [SeedGroup(function, core, tuple(members.tolist()))]
    return groups


def _elected(groups: list[SeedGroup], votes: F64, area: float, params: PartitionParams) -> list[SeedGroup]:
    """Groups with enough votes; where none has, those of the function with the most, ties by its name."""
    if not groups or not params.votes:
        return groups
    got = [float(votes[list(group.members)].sum()) for group in groups]
    enough = min(params.votes, params.vote_share * sum(got)) - 1e-9
    alone = max(enough, 1.0 - 1e-9) if sum(got) * params.sparse < area else np.inf
    elected = [
        group
        for group, count in zip(groups, got, strict=True)
        if count >= (enough if len(group.members) > 1 else alone)
    ]
    if elected:
        return elected
    counts: dict[str, float] = {}
    for group, count in zip(groups, got, strict=True):
        counts[group.function] = counts.get(group.function, 0.0) + count
    winner = max(sorted(counts), key=lambda function: counts[function])
    return [group for group in groups if group.function == winner]


def _parts(markers: I32, basin: Bools, params: PartitionParams) -> I32:
    """A mixed basin shared by distance, its smallest part given up until all are large enough; ties: the first."""
    while True:
        labels = share_by_distance(markers, basin)
        found, sizes = np.unique(labels[labels > 0], return_counts=True)
        smallest = int(np.argmin(sizes))
        if len(found) == 1 or sizes[smallest] * params.resolution**2 >= params.min_part:
            return labels
        markers = np.where(markers == found[smallest], 0, markers)


def _discs(
    basins: I32, snapped: I64, groups: Sequence[SeedGroup], params: PartitionParams
) -> tuple[I64, I64]:
    """Cells in the objects' discs `(K, 2)`, each once, and the number of the group that each goes to `(K,)`."""
    reach = int(np.ceil(params.marker_radius / params.resolution))
    offsets = np.argwhere(np.ones((2 * reach + 1, 2 * reach + 1))) - reach
    away = np.hypot(*offsets.T) * params.resolution
    offsets, away = offsets[away <= params.marker_radius + 1e-9], away[away <= params.marker_radius + 1e-9]
    members = [(index, number) for number, group in enumerate(groups, start=1) for index in group.members]
    index, number = np.array(members, np.int64).reshape(-1, 2).T
    core = np.array([group.core for group in groups], np.int64)[number - 1]
    places = (snapped[index][:, None] + offsets[None]).reshape(-1, 2)
    owner, core, away = np.repeat(number, len(away)), np.repeat(core, len(away)), np.tile(away, len(number))
    inside = ((places >= 0) & (places < basins.shape)).all(axis=1)
    inside[inside] = basins[tuple(places[inside].T)] == core[inside]
    places, owner, away = places[inside], owner[inside], away[inside]
    flat = places[:, 0] * basins.shape[1] + places[:, 1]
    order = np.lexsort((owner, away, flat))
    first = order[np.flatnonzero(np.diff(flat[order], prepend=-1))]
    return places[first], owner[first]


def _members(number: I64 | I32, count: int = 0) -> list[I64]:
    """Indices of those that bear 0, 1, .., each rising."""
    order = np.argsort(number, kind="stable")
    sizes = np.bincount(number, minlength=count)
    return [np.asarray(part, np.int64) for part in np.split(order, np.cumsum(sizes)[:-1])]


def _windows(labels: I32) -> list[tuple[int, slice, slice]]:
    """Each label with the rows and columns that it lies in."""
    found = enumerate(ndimage.find_objects(labels), start=1)
    return [(label, *window) for label, window in found if window is not None]


def _root(root: list[int], k: int) -> int:
    while root[k] != k:
        k = root[k]
    return k
