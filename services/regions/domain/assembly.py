"""From evidence, objects and their functions to the partition of a whole scene (KGSW, Algorithm 1 line 27).

`survey` finds the storeys and their free space; between the two, somebody names the objects' functions;
`assemble` cuts each storey into regions, gives them the stairs that lead up or down, back-projects objects and frames
onto them, and joins the storeys.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from ovip.scene.grid import FloorGrid
from ovip.scene.types import F64, I32, I64, Bools, EdgeKind, Floor, Frontier, Partition, Region, RegionEdge
from services.regions.domain.adjacency import Opening, find_openings
from services.regions.domain.cells import cells_of, labels_at
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.flooding import clearance_of, flood
from services.regions.domain.frontiers import find_frontiers
from services.regions.domain.functions import votes_of
from services.regions.domain.identity import keep_ids
from services.regions.domain.outlines import trace_outlines
from services.regions.domain.partition import UNKNOWN_FUNCTION, PartitionParams, partition_storey
from services.regions.domain.stairs import Stairs, find_stairs
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects
from services.regions.domain.views import seen_by

HALLWAY = "hallway"
_SAME_FLOOR = 0.5
"""Metres: a floor this close to one of the last partition is that floor."""
_DOOR = 1.3
"""Metres: a passage between walls up to this wide is a doorway (a double door and its frame)."""
_JAMB = 2.5
"""Cells: the ends of a doorway are this near to what is not free."""
_HALLWAY_PASSAGES = 3
"""A region of unknown function that joins at least so many others is a hallway."""


@dataclass(frozen=True, slots=True)
class PlacedObjects:
    """What a partition needs of the map's objects. centres: `(N, 3)` world metres."""

    ids: tuple[str, ...]
    labels: tuple[str, ...]
    centres: F64

    @classmethod
    def none(cls) -> PlacedObjects:
        return cls((), (), np.zeros((0, 3)))

    def only(self, members: I64) -> PlacedObjects:
        """Those at the indices `members`."""
        return PlacedObjects(
            tuple(self.ids[i] for i in members), tuple(self.labels[i] for i in members), self.centres[members]
        )


@dataclass(frozen=True, slots=True)
class Cut:
    """A partition with what belongs to it: one grid a floor, and the number of the next new region id."""

    partition: Partition
    grids: tuple[FloorGrid, ...]
    next_number: int

    @classmethod
    def none(cls) -> Cut:
        return cls(Partition(0, 0), (), 1)


def assemble(
    surveyed: Sequence[SurveyedStorey],
    objects: PlacedObjects,
    functions: Sequence[str],
    evidence: FloorEvidence,
    before: Cut,
    params: PartitionParams | None = None,
    kept: frozenset[int] = frozenset(),
    told: Sequence[bool] = (),
) -> Cut:
    """The scene cut into regions, each with its objects and the frames taken in it; the revision after `before`'s.

    functions: one for each object; told: whether a VLM named it, none of them where empty. kept: floors of `before`
    whose regions stay as they are; objects and frames are placed in them anew. Every object and frame is on one floor
    and, where that floor has regions, in one. The events and the map's version are left to the caller.
    """
    objects_on = storeys_of_objects(tuple(surveyed), objects.centres)
    votes = votes_of(objects.labels, functions, told)
    frames = _frames(evidence)
    frames_on = storeys_of_objects(tuple(surveyed), frames.centres)
    floors: list[_FloorCut] = []
    next_number = before.next_number
    for number, here in enumerate(surveyed):
        old = _same_floor(before, here)
        if old is not None and old in kept:
            floors.append(_kept(here, number, before, old))
            continue
        mine = np.flatnonzero(objects_on == number)
        cells = _cells(here, objects.centres[mine])
        kinds = [functions[i] for i in mine.tolist()]
        cut = partition_storey(here.space.free, cells, kinds, params, votes[mine])
        last = before.grids[old] if old is not None else None
        named = keep_ids(cut.labels, len(cut.functions), here.space.origin, last, next_number)
        next_number = named.next_number
        floors.append(_FloorCut(number, here, cut.labels, named.ids, cut.functions))
    stairs = find_stairs(evidence, tuple(surveyed))
    floors = [_with_stairs(floor, stairs) for floor in floors]
    edges = _stairs_edges(floors, stairs) + [edge for floor in floors for edge in _edges(floor)]
    floors = [_with_hallways(floor, edges) for floor in floors]
    regions = [
        region
        for floor in floors
        for region in _regions(
            floor,
            _inside(floor, objects.only(np.flatnonzero(objects_on == floor.number))),
            _inside(floor, frames.only(np.flatnonzero(frames_on == floor.number))),
            evidence,
        )
    ]
    partition = Partition(
        map_version=0,
        revision=before.partition.revision + 1,
        floors=tuple(_summary(floor) for floor in floors),
        regions=_with_names(regions),
        edges=tuple(edges),
        frontiers=tuple(frontier for floor in floors for frontier in _frontiers(floor, stairs)),
    )
    return Cut(partition, tuple(_grid(floor, partition.revision) for floor in floors), next_number)


@dataclass(frozen=True, slots=True)
class _FloorCut:
    """One storey cut up: R `(R, C)`, 0 = none, else 1 + index into the regions' ids and functions."""

    number: int
    here: SurveyedStorey
    labels: I32
    ids: tuple[str, ...]
    functions: tuple[str, ...]

    def at(self, cells: F64) -> list[str]:
        """The region at, or nearest to, each of `(N, 2)` cells; "" where the storey has none."""
        return [self.ids[k] if k >= 0 else "" for k in labels_at(self.labels, cells).tolist()]

    def world(self, row: float, column: float) -> F64:
        """The centre of a cell on the floor `(3,)`, metres."""
        space = self.here.space
        x = space.origin[0] + (column + 0.5) * space.resolution
        y = space.origin[1] + (row + 0.5) * space.resolution
        return np.array([x, y, self.here.storey.z])


def _cells(here: SurveyedStorey, points: F64) -> F64:
    return cells_of(points, here.space.origin, here.space.resolution)


def _frames(evidence: FloorEvidence) -> PlacedObjects:
    """The frames as things with a place: where each camera was."""
    ids = tuple(sorted(evidence.cameras))
    places = np.array([evidence.cameras[i] for i in ids], dtype=np.float64).reshape(-1, 3)
    return PlacedObjects(ids, ("",) * len(ids), places)


def _same_floor(before: Cut, here: SurveyedStorey) -> int | None:
    """Index of the last partition's floor nearest in height."""
    apart = [abs(floor.z - here.storey.z) for floor in before.partition.floors]
    return int(np.argmin(apart)) if apart and min(apart) <= _SAME_FLOOR else None


def _kept(here: SurveyedStorey, number: int, before: Cut, old: int) -> _FloorCut:
    """The regions of a floor of `before`, on today's grid: cells that are no longer free fall out, new ones join."""
    grid, space = before.grids[old], here.space
    functions = {region.region_id: region.function for region in before.partition.regions}
    labels = np.zeros(space.free.shape, np.int32)
    at = np.argwhere(grid.regions > 0)
    shift = np.round((np.asarray(grid.origin) - np.asarray(space.origin)) / space.resolution).astype(int)[
        ::-1
    ]
    there = at + shift
    inside = ((there >= 0) & (there < labels.shape)).all(axis=1)
    labels[tuple(there[inside].T)] = grid.regions[tuple(at[inside].T)]
    labels = flood(np.zeros(labels.shape), np.where(space.free, labels, 0), space.free)
    named = tuple(functions.get(region_id, UNKNOWN_FUNCTION) for region_id in grid.region_ids)
    return _FloorCut(number, here, labels, grid.region_ids, named)


def _edges(floor: _FloorCut) -> list[RegionEdge]:
    """The openings in free space; nobody passes through the columns of a flight of stairs."""
    space = floor.here.space
    beside_wall = clearance_of(space.free, 1.0) <= _JAMB
    return [
        RegionEdge(
            floor.ids[opening.a],
            floor.ids[opening.b],
            opening.width,
            floor.world(*opening.middle.tolist()),
            _kind(opening, beside_wall),
        )
        for opening in find_openings(np.where(space.free, floor.labels, 0), space.resolution)
    ]


def _kind(opening: Opening, beside_wall: Bools) -> EdgeKind:
    """A doorway is narrow and has a wall at both ends."""
    rows, columns = np.floor(opening.ends).astype(int).T
    narrow = opening.width <= _DOOR
    return EdgeKind.DOORWAY if narrow and beside_wall[rows, columns].all() else EdgeKind.OPENING


def _with_stairs(floor: _FloorCut, stairs: Sequence[Stairs]) -> _FloorCut:
    """The floor with the columns that stairs take up in the regions of their foot and head."""
    labels = floor.labels
    for way in stairs:
        for storey, cells, end in (
            (way.lower, way.lower_cells, way.foot),
            (way.upper, way.upper_cells, way.head),
        ):
            if storey == floor.number:
                (region,) = labels_at(floor.labels, _cells(floor.here, end[None])).tolist()
                labels = np.where(cells & (labels == 0) & ~floor.here.space.wall, region + 1, labels)
    return replace(floor, labels=labels)


def _stairs_edges(floors: Sequence[_FloorCut], stairs: Sequence[Stairs]) -> list[RegionEdge]:
    """Each stair as an edge from the region at its foot to the region at its head."""
    edges = []
    for way in stairs:
        lower, upper = floors[way.lower], floors[way.upper]
        (a,) = lower.at(_cells(lower.here, way.foot[None]))
        (b,) = upper.at(_cells(upper.here, way.head[None]))
        if a and b:
            edges.append(RegionEdge(a, b, way.width, way.foot, EdgeKind.STAIRS, way.head))
    return edges


def _with_hallways(floor: _FloorCut, edges: Sequence[RegionEdge]) -> _FloorCut:
    """Regions that nothing names but that lead to several others are hallways."""
    beside: dict[str, set[str]] = {}
    for edge in edges:
        beside.setdefault(edge.a, set()).add(edge.b)
        beside.setdefault(edge.b, set()).add(edge.a)
    functions = tuple(
        HALLWAY
        if function == UNKNOWN_FUNCTION and len(beside.get(region_id, ())) >= _HALLWAY_PASSAGES
        else function
        for region_id, function in zip(floor.ids, floor.functions, strict=True)
    )
    return replace(floor, functions=functions)


def _inside(floor: _FloorCut, things: PlacedObjects) -> dict[str, tuple[str, ...]]:
    """Region id -> ids of the things in it, sorted."""
    held: dict[str, list[str]] = {}
    for region_id, thing in zip(floor.at(_cells(floor.here, things.centres)), things.ids, strict=True):
        held.setdefault(region_id, []).append(thing)
    return {region_id: tuple(sorted(ids)) for region_id, ids in held.items()}


def _regions(
    floor: _FloorCut,
    objects: dict[str, tuple[str, ...]],
    frames: dict[str, tuple[str, ...]],
    evidence: FloorEvidence,
) -> list[Region]:
    space, count = floor.here.space, len(floor.ids)
    viewers = seen_by(evidence, floor.here.storey.z, floor.labels, count, space.origin, space.resolution)
    windows = ndimage.find_objects(floor.labels, count)
    regions = []
    for number, (region_id, window) in enumerate(zip(floor.ids, windows, strict=True)):
        if window is None:
            continue
        rows, columns = window
        cells = floor.labels[window] == number + 1
        corner = (
            space.origin[0] + columns.start * space.resolution,
            space.origin[1] + rows.start * space.resolution,
        )
        outlines = trace_outlines(cells, corner, space.resolution)
        regions.append(
            Region(
                region_id=region_id,
                floor=floor.number,
                function=floor.functions[number],
                display_name=floor.functions[number],
                area=float(cells.sum() * space.resolution**2),
                centroid=floor.world(*_middle(cells, rows.start, columns.start)),
                outlines=outlines.outer,
                holes=outlines.holes,
                object_ids=objects.get(region_id, ()),
                frame_ids=frames.get(region_id, ()),
                seen_by=viewers[number],
            )
        )
    return regions


def _middle(cells: Bools, row: int, column: int) -> tuple[float, float]:
    """The cell nearest to the mean of the region's cells, so that it lies in the region; ties to the first."""
    at = np.argwhere(cells)
    nearest = at[np.argmin(((at - at.mean(axis=0)) ** 2).sum(axis=1))]
    return float(nearest[0] + row), float(nearest[1] + column)


def _frontiers(floor: _FloorCut, stairs: Sequence[Stairs]) -> list[Frontier]:
    """Where the floor ends at what was never seen; under stairs there is no floor to find."""
    taken = np.zeros(floor.labels.shape, dtype=bool)
    for way in stairs:
        if way.lower == floor.number:
            taken |= way.lower_cells
        if way.upper == floor.number:
            taken |= way.upper_cells
    borders = find_frontiers(floor.here.space, floor.here.storey.z, known=taken)
    cells = np.array([border.cell for border in borders], dtype=np.float64).reshape(-1, 2)
    return [
        Frontier(floor.number, region_id, border.position, border.width)
        for region_id, border in zip(floor.at(cells), borders, strict=True)
    ]


def _summary(floor: _FloorCut) -> Floor:
    storey, space = floor.here.storey, floor.here.space
    return Floor(floor.number, storey.z, storey.ceiling_z, float(space.free.sum() * space.resolution**2))


def _grid(floor: _FloorCut, revision: int) -> FloorGrid:
    space = floor.here.space
    labels = floor.labels.astype(np.uint16)
    return FloorGrid(
        floor.number, space.origin, space.resolution, space.occupancy, labels, floor.ids, revision
    )


def _with_names(regions: Sequence[Region]) -> tuple[Region, ...]:
    """Display names: the function, numbered from its second region on in the order of their ids."""
    seen: Counter[str] = Counter()
    names = {}
    for region in sorted(regions, key=lambda region: int(region.region_id[1:])):
        seen[region.function] += 1
        count = seen[region.function]
        names[region.region_id] = region.function if count == 1 else f"{region.function} {count}"
    return tuple(replace(region, display_name=names[region.region_id]) for region in regions)
