"""Free space F of one storey on a 0.05 m grid, and what a robot may drive on (KGSW, Algorithm 1 line 1; SPEC
3).

Two masks with two meanings. F is the room floor, furniture included: only walls bound it, found in the high
band of the cloud so that furniture does not cut rooms. Occupancy is what a robot meets: furniture is occupied
there. In both, what was never seen is not free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import F64, I64, U8, Bools
from services.regions.domain.evidence import CELL, SLAB, Counts, FloorEvidence, unpack_voxel
from services.regions.domain.floors import Storey


@dataclass(frozen=True, slots=True)
class FreeSpaceParams:
    """Heights in metres above the floor.

    floor_band: hits this close to the floor are floor. body: the band in which a hit is an obstacle to a
    robot. wall: the high band; above most furniture, below the head of a door (2.0 m). low_wall: the band
    that stands in for it in a column whose high band was never looked at. wall_share: a wall holds hits in at
    least this share of its band's voxels. min_wall_height: and in at least so many metres of it.
    min_wall_cells: smaller clumps (poles, chains of lamps) are no walls. min_obstacle: hits (voxels x frames)
    that make a column an obstacle; a column with fewer is unknown. driven: rays lower than this prove floor
    that was not hit. carried: cameras up to this height were carried over the floor. body_radius: and its
    bearer's floor is free, metres. fill_area: holes in F up to this many square metres, enclosed by F alone,
    are filled (a blind spot behind a sofa is no wall); occupancy keeps them unknown. specks: pieces of
    occupancy's free floor below this, square metres, are unknown.
    """

    floor_band: tuple[float, float] = (-0.15, 0.10)
    body: tuple[float, float] = (0.10, 1.40)
    wall: tuple[float, float] = (1.40, 2.00)
    low_wall: tuple[float, float] = (0.40, 1.40)
    wall_share: float = 0.5
    min_wall_height: float = 0.2
    min_wall_cells: int = 6
    min_obstacle: int = 2
    driven: float = 0.35
    carried: float = 2.2
    body_radius: float = 0.20
    fill_area: float = 1.0
    specks: float = 0.05


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """One storey's masks, all `(R, C)`, rows with y, columns with x.

    free: F. wall: the walls that bound it. occupancy: uint8 of UNKNOWN, FREE, OCCUPIED. origin: world x, y of
    the outer corner of cell (0, 0), a whole number of cells from the world's, so that grids of one scene
    always line up.
    """

    origin: tuple[float, float]
    resolution: float
    free: Bools
    wall: Bools
    occupancy: U8


def find_free_space(
    evidence: FloorEvidence, storey: Storey, params: FreeSpaceParams | None = None
) -> FreeSpace:
    """F, walls and occupancy of one storey; `(0, 0)` masks where nothing of it was seen."""
    params = params or FreeSpaceParams()
    columns = _Columns.of(evidence, storey, params)
    wall = _walls(columns, params)
    floor = columns.count("hits", *params.floor_band) > 0
    stood = _disc_dilate(columns.count("stood", 0.0, params.carried) > 0, params.body_radius)
    met = columns.count("hits", *params.body)
    obstacle = met >= params.min_obstacle
    seen = floor | stood | obstacle | (columns.count("passes", 0.0, params.wall[1]) > 0)
    driven = (floor | stood | (columns.count("passes", 0.0, params.driven) > 0)) & (met == 0)
    return FreeSpace(
        origin=(float(columns.low[0] * CELL), float(columns.low[1] * CELL)),
        resolution=CELL,
        free=_fill(seen & ~wall, wall, params.fill_area),
        wall=wall,
        occupancy=_occupancy(driven, obstacle | wall, params.specks),
    )


@dataclass(frozen=True, slots=True)
class _Columns:
    """A storey's evidence as `(row, column, metres above the floor, count)`, one stream at a time."""

    low: I64
    shape: tuple[int, int]
    streams: dict[str, tuple[I64, I64, F64, I64]]

    @classmethod
    def of(cls, evidence: FloorEvidence, storey: Storey, params: FreeSpaceParams) -> _Columns:
        top = max(params.wall[1], params.body[1])
        raw = {
            "hits": _above(evidence.hits, storey, CELL, params.floor_band[0], top),
            "passes": _above(evidence.passes, storey, SLAB, 0.0, top),
            "stood": _above(evidence.stood, storey, CELL, 0.0, params.carried),
        }
        xy = np.concatenate([index for index, _, _ in raw.values()])
        margin = int(np.ceil(params.body_radius / CELL)) + 1
        low = xy.min(axis=0) - margin if len(xy) else np.zeros(2, np.int64)
        size = xy.max(axis=0) + margin + 1 - low if len(xy) else np.zeros(2, np.int64)
        streams = {
            name: (index[:, 1] - low[1], index[:, 0] - low[0], height, count)
            for name, (index, height, count) in raw.items()
        }
        return cls(low, (int(size[1]), int(size[0])), streams)

    def count(self, stream: str, bottom: float, top: float) -> I64:
        """Summed counts of a column between two heights above the floor -> `(R, C)`."""
        rows, columns, _, counts = self._between(stream, bottom, top)
        total = np.zeros(self.shape, np.int64)
        np.add.at(total, (rows, columns), counts)
        return total

    def filled(self, bottom: float, top: float) -> I64:
        """How many voxels of a column between two heights hold a hit -> `(R, C)`."""
        rows, columns, _, _ = self._between("hits", bottom, top)
        total = np.zeros(self.shape, np.int64)
        np.add.at(total, (rows, columns), 1)
        return total

    def _between(self, stream: str, bottom: float, top: float) -> tuple[I64, I64, F64, I64]:
        rows, columns, heights, counts = self.streams[stream]
        inside = (heights >= bottom) & (heights < top)
        return rows[inside], columns[inside], heights[inside], counts[inside]


def _above(counts: Counts, storey: Storey, layer: float, bottom: float, top: float) -> tuple[I64, F64, I64]:
    """x, y indices `(N, 2)`, heights above the floor of the layers' middles `(N,)` and counts `(N,)`."""
    keys, values = counts.items()
    index = unpack_voxel(keys)
    world = (index[:, 2] + 0.5) * layer
    height = world - storey.z
    inside = (height >= bottom) & (height < top) & (world >= storey.low) & (world < storey.high)
    return index[inside, :2], height[inside].astype(np.float64), values[inside]


def _walls(columns: _Columns, params: FreeSpaceParams) -> Bools:
    """Columns filled with hits through the high band, hit at least as often as seen through.

    A column whose high band was neither hit nor seen through (a camera that never looks up) is judged by the
    band below it, alone.
    """
    high = _is_filled(columns, params.wall, params)
    looked_at = (columns.count("hits", *params.wall) > 0) | (columns.count("passes", *params.wall) > 0)
    low = _is_filled(columns, params.low_wall, params)
    return _without_specks(high | (~looked_at & low), params.min_wall_cells)


def _is_filled(columns: _Columns, band: tuple[float, float], params: FreeSpaceParams) -> Bools:
    filled = columns.filled(*band)
    hits_a_voxel = columns.count("hits", *band) / np.maximum(filled, 1)
    passes_a_slab = columns.count("passes", *band) / max(1.0, round((band[1] - band[0]) / SLAB))
    enough = max(params.min_wall_height, params.wall_share * (band[1] - band[0])) / CELL
    walls: Bools = (filled >= enough - 1e-9) & (hits_a_voxel >= passes_a_slab)
    return walls


def _without_specks(wall: Bools, min_cells: int) -> Bools:
    pieces, _ = ndimage.label(wall, np.ones((3, 3)))
    kept: Bools = wall & (np.bincount(pieces.ravel()) >= min_cells)[pieces] if wall.any() else wall
    return kept


def _fill(free: Bools, wall: Bools, fill_area: float) -> Bools:
    """F with its small enclosed holes filled, those that touch a wall or the edge left out."""
    holes, found = ndimage.label(~free & ~wall)
    if not found:
        return free
    small = np.bincount(holes.ravel()) * CELL**2 <= fill_area
    beside_wall = np.unique(holes[ndimage.binary_dilation(wall, np.ones((3, 3)))])
    edge = np.unique(np.concatenate([holes[0], holes[-1], holes[:, 0], holes[:, -1]]))
    small[beside_wall] = small[edge] = small[0] = False
    filled: Bools = free | small[holes]
    return filled


def _occupancy(driven: Bools, blocked: Bools, specks: float) -> U8:
    free = driven & ~blocked
    pieces, _ = ndimage.label(free)
    free &= (np.bincount(pieces.ravel()) * CELL**2 >= specks)[pieces]
    return np.where(blocked, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.uint8)


def _disc_dilate(mask: Bools, radius: float) -> Bools:
    if not mask.any():
        return mask
    grown: Bools = ndimage.distance_transform_edt(~mask, sampling=CELL) <= radius + 1e-9
    return grown
