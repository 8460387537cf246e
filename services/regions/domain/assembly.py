"""From evidence, objects and their functions to the partition of a whole scene (KGSW, Algorithm 1 line 23).

`survey` finds the storeys and their free space; between the two, somebody names the objects' functions;
`assemble` cuts each storey into regions and back-projects objects and frames onto them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from ovip.scene.grid import FloorGrid
from ovip.scene.types import F64, I64, Floor, Partition, Region, RegionEdge
from services.regions.domain.adjacency import find_openings
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.identity import keep_ids
from services.regions.domain.outlines import trace_outlines
from services.regions.domain.partition import PartitionParams, StoreyPartition, partition_storey, regions_at
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects

_SAME_FLOOR = 0.5
"""Metres: a floor this close to one of the last partition is that floor."""


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
    surveyed: tuple[SurveyedStorey, ...],
    objects: PlacedObjects,
    functions: tuple[str, ...],
    cameras: dict[str, tuple[float, float, float]],
    before: Cut,
    params: PartitionParams | None = None,
) -> Cut:
    """The scene cut into regions, each with its objects and the frames taken in it; the revision after
    `before`'s.

    functions: one for each object. Every object and frame is on one floor and, where that floor has regions,
    in one.
    """
    next_number = before.next_number
    floors: list[Floor] = []
    regions: list[Region] = []
    edges: list[RegionEdge] = []
    grids: list[FloorGrid] = []
    frames = PlacedObjects(tuple(sorted(cameras)), (), _places([cameras[i] for i in sorted(cameras)]))
    object_storey = storeys_of_objects(surveyed, objects.centres)
    frame_storey = storeys_of_objects(surveyed, frames.centres)
    for number, here in enumerate(surveyed):
        mine = np.flatnonzero(object_storey == number)
        cut = partition_storey(
            here.space.free,
            _cells(here.space, objects.centres[mine]),
            tuple(functions[i] for i in mine),
            params,
        )
        named = keep_ids(
            cut.labels, len(cut.groups), here.space.origin, _same_floor(before, here.storey), next_number
        )
        next_number = named.next_number
        grid = _grid(number, here.space, cut, named.ids, before.partition.revision + 1)
        taken = np.flatnonzero(frame_storey == number)
        floors.append(_floor(number, here))
        regions += _regions(
            here,
            grid,
            cut,
            _inhabitants(cut.region_of_object, mine, objects.ids),
            _inhabitants(
                regions_at(cut.labels, _cells(here.space, frames.centres[taken])), taken, frames.ids
            ),
        )
        edges += _edges(here, grid, cut)
        grids.append(grid)
    partition = Partition(
        map_version=0,
        revision=before.partition.revision + 1,
        floors=tuple(floors),
        regions=_with_names(regions),
        edges=tuple(edges),
    )
    return Cut(partition, tuple(grids), next_number)


def _places(points: list[tuple[float, float, float]]) -> F64:
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _cells(space: FreeSpace, points: F64) -> F64:
    """World points `(N, 3)` as (row, column) with cell centres at integers -> `(N, 2)`."""
    cells: F64 = (points[:, 1::-1] - np.asarray(space.origin)[::-1]) / space.resolution - 0.5
    return cells


def _same_floor(before: Cut, storey: Storey) -> FloorGrid | None:
    near = [
        (abs(floor.z - storey.z), grid)
        for floor, grid in zip(before.partition.floors, before.grids, strict=True)
        if abs(floor.z - storey.z) <= _SAME_FLOOR
    ]
    return min(near, key=lambda pair: pair[0])[1] if near else None


def _grid(
    number: int, space: FreeSpace, cut: StoreyPartition, ids: tuple[str, ...], revision: int
) -> FloorGrid:
    return FloorGrid(
        floor=number,
        origin=space.origin,
        resolution=space.resolution,
        occupancy=space.occupancy,
        regions=cut.labels.astype(np.uint16),
        region_ids=ids,
        revision=revision,
    )


def _floor(number: int, here: SurveyedStorey) -> Floor:
    area = float(here.space.free.sum() * here.space.resolution**2)
    return Floor(number, here.storey.z, here.storey.ceiling_z, area)


def _inhabitants(region: I64, members: I64, ids: tuple[str, ...]) -> dict[int, tuple[str, ...]]:
    """Region index -> ids of those of `members` that are in it, sorted."""
    inside: dict[int, list[str]] = {}
    for of, member in zip(region.tolist(), members.tolist(), strict=True):
        inside.setdefault(of, []).append(ids[member])
    return {of: tuple(sorted(found)) for of, found in inside.items()}


def _regions(
    here: SurveyedStorey,
    grid: FloorGrid,
    cut: StoreyPartition,
    objects: dict[int, tuple[str, ...]],
    frames: dict[int, tuple[str, ...]],
) -> list[Region]:
    regions = []
    for number, (region_id, group) in enumerate(zip(grid.region_ids, cut.groups, strict=True)):
        cells = cut.labels == number + 1
        outlines = trace_outlines(cells, grid.origin, grid.resolution)
        regions.append(
            Region(
                region_id=region_id,
                floor=grid.floor,
                function=group.function,
                display_name=group.function,
                area=float(cells.sum() * grid.resolution**2),
                centroid=_centre(grid, np.argwhere(cells).astype(np.float64), here.storey.z),
                outlines=outlines.outer,
                holes=outlines.holes,
                object_ids=objects.get(number, ()),
                frame_ids=frames.get(number, ()),
            )
        )
    return regions


def _centre(grid: FloorGrid, cells: F64, z: float) -> F64:
    """The cell nearest to the mean of the region's cells, so that it lies in the region -> `(3,)`."""
    _, nearest = cKDTree(cells).query(cells.mean(axis=0))
    row, column = cells[nearest]
    return np.array([*grid.xy_of(float(row), float(column)), z])


def _edges(here: SurveyedStorey, grid: FloorGrid, cut: StoreyPartition) -> list[RegionEdge]:
    return [
        RegionEdge(
            grid.region_ids[opening.a],
            grid.region_ids[opening.b],
            opening.width,
            np.array([*grid.xy_of(*opening.middle.tolist()), here.storey.z]),
        )
        for opening in find_openings(cut.labels, grid.resolution)
    ]


def _with_names(regions: list[Region]) -> tuple[Region, ...]:
    """Display names: the function, numbered from its second region on in the order of their ids."""
    seen: Counter[str] = Counter()
    names = {}
    for region in sorted(regions, key=lambda region: int(region.region_id[1:])):
        seen[region.function] += 1
        count = seen[region.function]
        names[region.region_id] = region.function if count == 1 else f"{region.function} {count}"
    return tuple(replace(region, display_name=names[region.region_id]) for region in regions)
