"""Where a robot can truly stand in a simulated place, and how far it walks there: what drives are scored on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from skimage.graph import MCP_Geometric

from lab.simulation.ground import Ground
from lab.simulation.room import BEDROOM, MAIN_ROOM, SimulatedRoom
from ovip.scene.grid import FREE, UNKNOWN, FloorGrid
from ovip.scene.types import F64, Bools
from ovip.scene.walking import distance_field, path_length, shortest_path

_ROOM_CELL = 0.1  # metres
_RING = 0.1  # metres by which places to stand at a thing may differ in their distance from it


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """grids: by storey; FREE exactly where the robot can stand, UNKNOWN elsewhere. heights: metres, by storey."""

    grids: Mapping[int, FloorGrid]
    heights: Mapping[int, float]

    def floor_at(self, z: float) -> int:
        """The storey that a height belongs to: the highest that begins at or below it, the lowest where none does."""
        below = [floor for floor, height in self.heights.items() if height <= z + 0.3]
        return max(below or [min(self.heights, key=self.heights.__getitem__)], key=self.heights.__getitem__)

    def standing(self, floor: int) -> Bools:
        """Cells `(R, C)` where the robot can stand."""
        return np.asarray(self.grids[floor].occupancy == FREE)

    def walked(self, floor: int, xy: F64) -> F64:
        """Metres walked from the standing cell that holds `xy` to every cell `(R, C)`, infinite without a way."""
        grid = self.grids[floor]
        return distance_field(self.standing(floor), grid.cell_of(xy), grid.resolution)

    def drive(self, floor: int, start: F64, goal: F64, reach: float = 3.0) -> F64:
        """Shortest way from `start` to the standing cell nearest to `goal` -> `(N, 2)`; none within reach `(0, 2)`."""
        return shortest_path(self.grids[floor], start, goal, 0.0, reach)

    def beside(self, floor: int, box: F64, within: float) -> Bools:
        """Standing cells `(R, C)` whose middles are at most `within` metres from a box's `(6,)` footprint."""
        grid = self.grids[floor]
        rows, columns = grid.occupancy.shape
        x = grid.origin[0] + (np.arange(columns) + 0.5) * grid.resolution
        y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution
        dx = np.maximum(np.maximum(box[0] - x, x - box[3]), 0.0)
        dy = np.maximum(np.maximum(box[1] - y, y - box[4]), 0.0)
        near: Bools = np.hypot(dx[None, :], dy[:, None]) <= within
        return near & self.standing(floor)

    def at(self, floor: int, box: F64, within: float) -> Bools:
        """Of the standing cells beside a box `(6,)`, `within` metres, those from which one walks no farther than that
        to one of the nearest: what is near but behind a wall is not at it -> `(R, C)`.
        """
        near = self.beside(floor, box, within)
        for apart in np.arange(0.0, within, _RING):
            ring = self.beside(floor, box, float(apart))
            if ring.any():
                return near & (self._walked_from(floor, ring) <= within)
        return np.zeros_like(near)

    def _walked_from(self, floor: int, cells: Bools) -> F64:
        """Metres walked from the nearest of several cells to every cell `(R, C)`."""
        paces = MCP_Geometric(np.where(self.standing(floor), 1.0, -1.0))
        walked: F64 = paces.find_costs(np.argwhere(cells))[0] * self.grids[floor].resolution
        return walked


def length(path: F64) -> float:
    """Metres along a path `(N, 2)`."""
    return path_length(path)


def terrain_of_ground(ground: Ground, radius: float) -> Terrain:
    """A home's terrain for a robot of `radius` metres."""
    grids = {floor: _only(grid, ground.standing(floor, radius)) for floor, grid in ground.grids.items()}
    return Terrain(grids, {storey.floor: storey.z for storey in ground.home.storeys})


def terrain_of_room(room: SimulatedRoom, radius: float) -> Terrain:
    """The small room's terrain, on cells of 0.1 metres."""
    columns = int(np.ceil(BEDROOM[1] / _ROOM_CELL))
    rows = int(np.ceil(MAIN_ROOM[3] / _ROOM_CELL))
    standing = np.array(
        [
            [
                room.is_free(np.array([(c + 0.5) * _ROOM_CELL, (r + 0.5) * _ROOM_CELL]), radius)
                for c in range(columns)
            ]
            for r in range(rows)
        ]
    )
    return Terrain({0: _grid(standing, (0.0, 0.0), _ROOM_CELL)}, {0: 0.0})


def _only(grid: FloorGrid, standing: Bools) -> FloorGrid:
    return _grid(standing, grid.origin, grid.resolution, grid.floor)


def _grid(standing: Bools, origin: tuple[float, float], resolution: float, floor: int = 0) -> FloorGrid:
    occupancy = np.where(standing, FREE, UNKNOWN).astype(np.uint8)
    return FloorGrid(floor, origin, resolution, occupancy, np.zeros(standing.shape, np.uint16))
