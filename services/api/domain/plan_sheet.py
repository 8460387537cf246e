"""What one floor plan shows, and how its metres lie on the picture's pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ovip.scene.grid import UNKNOWN, FloorGrid
from ovip.scene.types import (
    F64,
    EdgeKind,
    Floor,
    Frontier,
    MapObject,
    Partition,
    Region,
    RegionEdge,
    SceneMap,
)

T = TypeVar("T", bound=np.generic)

_MARGIN = 0.6
"""Metres of paper around what is known."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanSheet:
    """One floor of a scene's partition, with its grid and the objects that stand on it."""

    scene: str
    partition: Partition
    floor: Floor
    grid: FloorGrid
    objects: tuple[MapObject, ...]

    @property
    def regions(self) -> tuple[Region, ...]:
        return tuple(region for region in self.partition.regions if region.floor == self.floor.floor)

    @property
    def frontiers(self) -> tuple[Frontier, ...]:
        return tuple(frontier for frontier in self.partition.frontiers if frontier.floor == self.floor.floor)

    def passages(self, kind: EdgeKind) -> tuple[RegionEdge, ...]:
        """The ways of one kind that begin or end on this floor."""
        here = {region.region_id for region in self.regions}
        return tuple(
            edge for edge in self.partition.edges if edge.kind is kind and (edge.a in here or edge.b in here)
        )

    def other_floor(self, stairs: RegionEdge) -> int:
        """The floor that stairs lead to from this one."""
        floors = {region.region_id: region.floor for region in self.partition.regions}
        ends = [floors.get(stairs.a, self.floor.floor), floors.get(stairs.b, self.floor.floor)]
        return ends[1] if ends[0] == self.floor.floor else ends[0]


@dataclass(frozen=True, slots=True)
class PlanFrame:
    """The part of a grid that a plan shows. corner: world x, y of the picture's upper left corner; scale: pixels a
    metre; cell: pixels; size: width and height, pixels."""

    rows: slice
    columns: slice
    corner: tuple[float, float]
    scale: float
    cell: float
    size: tuple[int, int]

    @classmethod
    def around(cls, grid: FloorGrid, scale: float) -> PlanFrame:
        """Everything known of a floor, with a margin; all of it where nothing is."""
        rows, columns = _known(grid)
        return cls(
            rows,
            columns,
            (
                grid.origin[0] + columns.start * grid.resolution,
                grid.origin[1] + rows.stop * grid.resolution,
            ),
            scale,
            scale * grid.resolution,
            (
                max(1, round((columns.stop - columns.start) * grid.resolution * scale)),
                max(1, round((rows.stop - rows.start) * grid.resolution * scale)),
            ),
        )

    def pixel(self, xy: F64) -> tuple[float, float]:
        """Where a world point lies in the picture."""
        return (
            float(xy[0] - self.corner[0]) * self.scale,
            float(self.corner[1] - xy[1]) * self.scale,
        )

    def pictured(self, cells: npt.NDArray[T]) -> npt.NDArray[T]:
        """The shown part of `(R, C)` with the largest y on top; zeros where it reaches over the grid's rim."""
        shown = np.zeros(
            (self.rows.stop - self.rows.start, self.columns.stop - self.columns.start), cells.dtype
        )
        low = max(0, self.rows.start), max(0, self.columns.start)
        part = cells[low[0] : self.rows.stop, low[1] : self.columns.stop]
        row, column = low[0] - self.rows.start, low[1] - self.columns.start
        shown[row : row + part.shape[0], column : column + part.shape[1]] = part
        return shown[::-1]


def plan_sheets(
    scene_map: SceneMap, partition: Partition, grids: Sequence[FloorGrid]
) -> tuple[PlanSheet, ...]:
    """A sheet for each grid, with the objects that stand on its floor."""
    floors = {floor.floor: floor for floor in partition.floors}
    return tuple(
        PlanSheet(
            scene_map.scene,
            partition,
            floors[grid.floor],
            grid,
            _on_floor(scene_map.objects, partition, grid.floor),
        )
        for grid in grids
    )


def fits(grid: FloorGrid, partition: Partition) -> bool:
    """Whether a floor's grid has just the regions that a partition has there."""
    here = {region.region_id for region in partition.regions if region.floor == grid.floor}
    return set(grid.region_ids) == here


def _on_floor(objects: Sequence[MapObject], partition: Partition, floor: int) -> tuple[MapObject, ...]:
    """The objects of a floor: those of its regions, and of those in no region the ones it is the next floor below."""
    floor_of = {object_id: region.floor for region in partition.regions for object_id in region.object_ids}
    return tuple(
        obj for obj in objects if floor_of.get(obj.object_id, _floor_below(obj, partition.floors)) == floor
    )


def _floor_below(obj: MapObject, floors: Sequence[Floor]) -> int:
    z = float(obj.centroid[2])
    below = [floor for floor in floors if floor.z <= z]
    if below:
        return max(below, key=lambda floor: floor.z).floor
    return min(floors, key=lambda floor: floor.z).floor if floors else 0


def _known(grid: FloorGrid) -> tuple[slice, slice]:
    known = (grid.occupancy != UNKNOWN) | (grid.regions > 0)
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if not len(rows):
        return slice(0, known.shape[0]), slice(0, known.shape[1])
    margin = round(_MARGIN / grid.resolution)
    return (
        slice(int(rows[0]) - margin, int(rows[-1]) + 1 + margin),
        slice(int(columns[0]) - margin, int(columns[-1]) + 1 + margin),
    )
