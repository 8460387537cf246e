"""Where one can stand and walk in a home: a floor grid per storey, and the flights of stairs between them.

A cell is occupied where some face passes at 0.1 to 1.4 m above the storey's floor, free where there is floor and
nothing of that. Door leaves that stand open are obstacles, closed ones ("door" across a doorway) are too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from lab.simulation.home import Area, Home, Mesh, Storey, inside_polygon
from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import F32, F64, I64, U8, U16, Bools
from ovip.scene.walking import clearance as clearance_field
from ovip.scene.walking import distance_field, shortest_path, straighten, traversable

OBSTACLE_LOW, OBSTACLE_HIGH = 0.10, 1.40  # metres above the floor
RESOLUTION = 0.05
_FLOOR_WITHIN = 0.08  # metres of the storey's height that count as its floor
_BESIDE_ROOMS = 0.35  # metres outside the rooms' outlines that may still be floor: doorways
_SPACING = 0.03  # metres between samples of a face
_CHUNK = 2_000_000
_ENCLOSED = 1.5  # square metres under which enclosed floor is the inside of a thing
_LANDING = 0.35  # metres before and behind a flight


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A straight flight of stairs between two storeys. way: `(4, 3)` floor points, from the foot to the top."""

    lower: int
    upper: int
    way: F64


class Ground:
    """The floors of one home."""

    def __init__(self, home: Home) -> None:
        self.home = home
        origin, shape = _extent(home)
        self.grids: dict[int, FloorGrid] = {s.floor: _grid(home, s, origin, shape) for s in home.storeys}
        self._clearance = {floor: clearance_field(grid) for floor, grid in self.grids.items()}
        self.flights: tuple[Flight, ...] = tuple(_flights(home))

    def storey(self, floor: int) -> Storey:
        """The storey with this number. KeyError for none."""
        return {storey.floor: storey for storey in self.home.storeys}[floor]

    def floor_at(self, z: float) -> int:
        """The storey that height `z` metres belongs to: the highest that begins at or below it."""
        below = [s for s in self.home.storeys if s.z <= z + 0.5]
        return max(below or self.home.storeys[:1], key=lambda s: s.z).floor

    def is_free(self, xy: F64, clearance: float = 0.2, floor: int = 0) -> bool:
        """Whether a round robot of radius `clearance` can stand at floor point `xy` `(2,)`."""
        grid = self.grids[floor]
        row, column = grid.cell_of(np.asarray(xy, np.float64))
        if not (0 <= row < grid.occupancy.shape[0] and 0 <= column < grid.occupancy.shape[1]):
            return False
        return bool(grid.occupancy[row, column] == FREE and self.clearance_at(xy, floor) >= clearance)

    def clearance_at(self, xy: F64, floor: int = 0) -> float:
        """Metres to the nearest obstacle, 0 where one cannot stand; between cells it is interpolated."""
        grid = self.grids[floor]
        at = (np.asarray(xy, np.float64)[:2] - grid.origin) / grid.resolution - 0.5
        field = self._clearance[floor]
        return float(ndimage.map_coordinates(field, at[::-1, None], order=1, mode="nearest")[0])

    def standing(self, floor: int, radius: float) -> Bools:
        """Cells `(R, C)` of a storey where a robot of `radius` can stand."""
        return traversable(self.grids[floor], radius)

    def distances(self, floor: int, xy: F64, radius: float) -> F64:
        """Metres walked from `xy` to every cell `(R, C)`; infinite where there is no way."""
        grid = self.grids[floor]
        return distance_field(self.standing(floor, radius), grid.cell_of(np.asarray(xy)), grid.resolution)

    def path(self, floor: int, start: F64, goal: F64, radius: float) -> F64:
        """Shortest way on one storey, straightened -> `(N, 2)`; `(0, 2)` for none."""
        grid = self.grids[floor]
        return straighten(grid, shortest_path(grid, start, goal, radius, reach=1.0), radius)


def _extent(home: Home) -> tuple[tuple[float, float], tuple[int, int]]:
    points = np.concatenate([area.polygon for area in (*home.rooms, *home.areas)])
    low = np.floor((points.min(axis=0) - 0.5) / RESOLUTION) * RESOLUTION
    columns, rows = np.ceil((points.max(axis=0) + 0.5 - low) / RESOLUTION).astype(int)
    return (float(low[0]), float(low[1])), (int(rows), int(columns))


def _grid(home: Home, storey: Storey, origin: tuple[float, float], shape: tuple[int, int]) -> FloorGrid:
    z = home.mesh.vertices[:, 2][home.mesh.triangles]
    low, high = z.min(axis=1), z.max(axis=1)
    floor = _FLOOR_WITHIN
    obstacle = _touched(home.mesh, storey.z + OBSTACLE_LOW, storey.z + OBSTACLE_HIGH, origin, shape)
    flat = (low > storey.z - floor) & (high < storey.z + floor)
    ground = _cells_of(home.mesh, np.flatnonzero(flat), (-np.inf, np.inf), origin, shape)
    areas = [area for area in home.areas if area.floor == storey.floor]
    rooms = [area for area in (*home.rooms, *areas) if area.floor == storey.floor]
    inside = (
        np.any([_covered(area, origin, shape) for area in rooms], axis=0) if rooms else np.zeros(shape, bool)
    )
    near = ndimage.distance_transform_edt(~inside, sampling=RESOLUTION) <= _BESIDE_ROOMS
    occupancy: U8 = np.full(shape, UNKNOWN, dtype=np.uint8)
    occupancy[ground & near] = FREE
    occupancy[obstacle] = OCCUPIED
    occupancy[_enclosed(occupancy == FREE)] = OCCUPIED
    regions: U16 = np.zeros(shape, dtype=np.uint16)
    for number, area in reversed(list(enumerate(areas, start=1))):
        regions[_covered(area, origin, shape)] = number
    ids = tuple(str(area.area_id) for area in areas)
    return FloorGrid(storey.floor, origin, RESOLUTION, occupancy, regions, ids)


def _enclosed(free: Bools) -> Bools:
    """Free cells in pieces too small to be a room: the insides of wardrobes and bins."""
    pieces, _ = ndimage.label(free)
    small = np.bincount(pieces.ravel()) * RESOLUTION**2 < _ENCLOSED
    return np.asarray(free & small[pieces])


def _covered(area: Area, origin: tuple[float, float], shape: tuple[int, int]) -> Bools:
    """Cells whose centres lie in the area's outline `(R, C)`."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    centres = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1) * RESOLUTION + np.array(origin)
    return inside_polygon(area.polygon, centres).reshape(shape)


def _touched(
    mesh: Mesh, low: float, high: float, origin: tuple[float, float], shape: tuple[int, int]
) -> Bools:
    """Cells that some face passes over between two heights `(R, C)`."""
    z = mesh.vertices[:, 2][mesh.triangles]
    between = (z.min(axis=1) < high) & (z.max(axis=1) > low)
    return _cells_of(mesh, np.flatnonzero(between), (low, high), origin, shape)


def _cells_of(
    mesh: Mesh,
    triangles: I64,
    heights: tuple[float, float],
    origin: tuple[float, float],
    shape: tuple[int, int],
) -> Bools:
    cells = np.zeros(shape, dtype=bool)
    for points in _samples(mesh.vertices[mesh.triangles[triangles]]):
        points = points[(points[:, 2] > heights[0]) & (points[:, 2] < heights[1])]
        column, row = np.floor((points[:, :2] - np.array(origin)) / RESOLUTION).astype(np.int64).T
        inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
        cells[row[inside], column[inside]] = True
    return cells


def _samples(corners: F32) -> Iterator[F64]:
    """Points `(N, 3)` on triangles `(T, 3, 3)`, in pieces: a lattice on each, at most `_SPACING` apart."""
    ends = np.roll(corners, -1, axis=1)
    longest = np.linalg.norm(ends - corners, axis=2).max(axis=1, initial=0.0)
    cuts = 2 ** np.ceil(np.log2(np.maximum(longest / _SPACING, 1))).astype(np.int64)
    for cut in np.unique(cuts):
        i, j = np.meshgrid(np.arange(cut + 1), np.arange(cut + 1), indexing="ij")
        weight = np.stack([i[i + j <= cut], j[i + j <= cut]], axis=1) / cut
        chosen = corners[cuts == cut].astype(np.float64)
        size = max(1, _CHUNK // len(weight))
        for start in range(0, len(chosen), size):
            a, b, c = np.moveaxis(chosen[start : start + size], 1, 0)
            across = np.stack([b - a, c - a], axis=1)
            yield (a[:, None] + weight @ across).reshape(-1, 3)


def _flights(home: Home) -> Iterator[Flight]:
    """Straight flights from what is labelled stairs: the way up is the slope of its upward faces."""
    storeys = sorted(home.storeys, key=lambda s: s.z)
    for thing in home.objects:
        if thing.label != "stairs" or len(storeys) < 2:
            continue
        lower = max((s for s in storeys if s.z <= thing.box[2] + 0.3), key=lambda s: s.z, default=storeys[0])
        upper = next((s for s in storeys if s.z > lower.z), None)
        steps = _treads(home.mesh, thing.object_id)
        if upper is None or len(steps) < 3 or thing.box[5] < upper.z - 0.6:
            continue
        yield Flight(lower.floor, upper.floor, _way_up(steps, lower.z, upper.z))


def _treads(mesh: Mesh, object_id: int) -> F64:
    """Middles `(N, 3)` of an object's level faces, and their areas in a fourth column `(N, 4)`."""
    corners = mesh.vertices[mesh.triangles[mesh.object_ids == object_id]].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    level = (np.abs(cross[:, 2]) > 1.9 * area) & (area > 1e-4)
    return np.column_stack([corners[level].mean(axis=1), area[level]])


def _way_up(steps: F64, low: float, high: float) -> F64:
    """`(4, 3)`: before the first step, on it, on the last, and behind it, along the middle of the flight."""
    middle = np.average(steps[:, :3], axis=0, weights=steps[:, 3])
    away, rise = steps[:, :2] - middle[:2], steps[:, 2] - middle[2]
    slope = (away * (rise * steps[:, 3])[:, None]).sum(axis=0)
    axis = np.zeros(2)
    axis[int(np.argmax(np.abs(slope)))] = 1.0
    up = axis * np.sign(slope[np.argmax(np.abs(slope))])
    along = away @ up
    ends = (along.min() - _LANDING - 0.15, along.min(), along.max(), along.max() + _LANDING + 0.15)
    return np.array(
        [[*(middle[:2] + end * up), z] for end, z in zip(ends, (low, low, high, high), strict=True)]
    )
