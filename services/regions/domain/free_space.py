"""Free space F of one storey on a 0.05 m grid, and what a robot may drive on (KGSW, Algorithm 1 line 1; SPEC
3).

Two masks with two meanings. F is the room floor, furniture included: only walls bound it, found in the high
band of the cloud, and above it, so that furniture does not cut rooms. Occupancy is what a robot meets: furniture
is occupied there. In both, what was never seen is not free, nor what was only seen through a window.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import U8, Bools
from services.regions.domain.columns import Bandwidths, Columns, Marks, Span, marked
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.floors import Storey

_AROUND = np.ones((3, 3), bool)


@dataclass(frozen=True, slots=True)
class FreeSpaceParams:
    """Heights in metres above the floor.

    floor_band: hits this close to the floor are floor. body: the band in which a hit is an obstacle to a
    robot. wall: the high band; above most furniture, below the head of a door (2.0 m). low_wall: the band
    that stands in for it in a column whose high band was never looked at. wall_share: a wall holds hits in at
    least this share of its band's voxels. min_wall_height: and in at least so many metres of it.
    min_wall_cells: smaller clumps (poles, chains of lamps) are no walls.
    upper: above wardrobes and open doors, at most up to `ceiling_gap` under the ceiling; a wall goes on there.
    sill: a wall under a window fills `sill_share` of it. min_lintel: metres of wall in `upper` over a window.
    overhead: ceilings, roofs. roof_share: of a room's cells that have one, where cameras see ceilings. open_share:
    outdoors has less than that. min_outdoors: smaller pieces are neither, square metres.
    min_obstacle: hits (voxels x frames) that make a column an obstacle; a column with fewer is unknown. driven:
    rays lower than this prove floor that was not hit. carried: cameras up to this height were carried over the
    floor. body_radius: and its bearer's floor is free, metres. fill_area: holes in F up to this many square
    metres, enclosed by F alone, are filled (a blind spot behind a sofa is no wall); occupancy keeps them unknown.
    below: rays in these heights go through a hole in the floor. min_hole: square metres of one. hole_share: of its
    cells in which rays do. specks: pieces of occupancy's free floor below this, square metres, are unknown.
    """

    floor_band: Span = (-0.15, 0.10)
    body: Span = (0.10, 1.40)
    wall: Span = (1.40, 2.00)
    low_wall: Span = (0.40, 1.40)
    wall_share: float = 0.5
    min_wall_height: float = 0.2
    min_wall_cells: int = 6
    upper: Span = (2.10, 2.75)
    ceiling_gap: float = 0.10
    sill: Span = (0.10, 0.70)
    sill_share: float = 0.7
    min_lintel: float = 0.1
    overhead: Span = (2.10, 8.00)
    roof_share: float = 0.25
    open_share: float = 0.005
    min_outdoors: float = 0.5
    min_obstacle: int = 2
    driven: float = 0.35
    carried: float = 2.2
    body_radius: float = 0.20
    fill_area: float = 1.0
    below: Span = (-0.37, -0.12)
    min_hole: float = 0.25
    hole_share: float = 0.25
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
    wanted = _bands(storey, params)
    margin = int(np.ceil(params.body_radius / CELL)) + 1
    seen = marked(evidence, storey, wanted, lambda columns: _judged(columns, params), margin)
    if seen is None:
        none = np.zeros((0, 0), bool)
        return FreeSpace((0.0, 0.0), CELL, none, none, none.astype(np.uint8))
    return _space(seen, params)


def _space(seen: Marks, params: FreeSpaceParams) -> FreeSpace:
    marks = seen.masks
    wall = _walls(marks, params)
    hole = _holes(marks, params)
    carried = _discs(seen.stood, params.body_radius)
    open_floor = (marks["air"] | marks["floor"] | marks["obstacle"] | carried) & ~wall & ~hole
    reached = _reached(_under_a_roof(open_floor, marks, seen.stood, params), seen.stood)
    free = _fill(reached, wall | hole, params.fill_area)
    driven = (marks["floor"] | marks["driven"] | carried) & ~marks["met"] & free
    return FreeSpace(
        origin=(seen.window.low[0] * CELL, seen.window.low[1] * CELL),
        resolution=CELL,
        free=free,
        wall=wall,
        occupancy=_occupancy(driven, marks["obstacle"] | wall, params.specks),
    )


def _bands(storey: Storey, params: FreeSpaceParams) -> Bandwidths:
    upper = _upper(storey, params)
    air = (0.0, max(upper[1], params.wall[1]))
    walls = {"wall": params.wall, "low_wall": params.low_wall, "upper": upper, "sill": params.sill}
    hits = {"floor": params.floor_band, "body": params.body, "overhead": params.overhead, **walls}
    passes = {"air": air, "driven": (0.0, params.driven), "below": params.below, **walls}
    return Bandwidths(hits, passes, (-CELL, params.carried))  # a camera in the floor's own cube stands on it


def _judged(columns: Columns, params: FreeSpaceParams) -> dict[str, Bools]:
    """What each column is, as far as it tells by itself.

    high: filled through the high band, or through the one below it where nobody looked at the high one (a camera
    that never looks up). open_above, goes_on: seen through, or wall, above where furniture ends. edge: filled as
    over an opening, or as under one; windowed: both. through: rays on either side of the floor's height.
    """
    hits, passes = columns.hits, columns.passes
    share, height = params.wall_share, params.min_wall_height
    looked_at = (hits["wall"] > 0) | (passes["wall"] > 0)
    low = ~looked_at & columns.is_filled("low_wall", share, height)
    seen = (hits["floor"] > 0) | (hits["body"] > 0) | (passes["air"] > 0)
    over = columns.is_filled("upper", 0.0, params.min_lintel)
    under = columns.is_filled("sill", params.sill_share, height)
    return {
        "floor": hits["floor"] > 0,
        "met": hits["body"] > 0,
        "obstacle": hits["body"] >= params.min_obstacle,
        "air": passes["air"] > 0,
        "driven": passes["driven"] > 0,
        "through": (passes["below"] > 0) & (passes["driven"] > 0),
        "high": low | columns.is_filled("wall", share, height),
        "windowed": over & under,
        "edge": over | under,
        "overhead": seen & (hits["overhead"] > 0),
        "open_above": passes["upper"] > 0,
        "goes_on": columns.goes_on("upper"),
    }


def _upper(storey: Storey, params: FreeSpaceParams) -> Span:
    """The band above furniture and below the ceiling; empty where the ceiling is too low for one."""
    low, high = params.upper
    if storey.ceiling_z is None:
        return low, high
    return low, max(low, min(high, storey.ceiling_z - storey.z - params.ceiling_gap))


def _walls(marks: Mapping[str, Bools], params: FreeSpaceParams) -> Bools:
    """What fills the high band and is not seen to end above it, where furniture ends; and windows in walls.

    A column ends above where rays pass over it and no neighbour goes on. Where nobody looked that high, it is a wall.
    """
    ends = marks["open_above"] & ~_widened(marks["goes_on"])
    return _without_specks((marks["high"] & ~ends) | marks["windowed"], params.min_wall_cells)


def _holes(marks: Mapping[str, Bools], params: FreeSpaceParams) -> Bools:
    """Stairwells and edges: patches in which nothing was ever hit and many rays go on through the floor's height."""
    solid = marks["floor"] | marks["met"]
    empty = marks["air"] & ~_widened(solid)
    pieces, found = ndimage.label(empty)
    cells = np.bincount(pieces.ravel(), minlength=found + 1)
    fallen = np.bincount(pieces[marks["through"]], minlength=found + 1)
    hole = (cells * CELL**2 >= params.min_hole) & (fallen >= params.hole_share * cells)
    hole[0] = False
    grown: Bools = _widened(hole[pieces]) & ~solid
    return grown


def _under_a_roof(free: Bools, marks: Mapping[str, Bools], stood: Bools, params: FreeSpaceParams) -> Bools:
    """F without what lies outdoors: beyond a lintel or a sill, where no camera was and nothing is overhead.

    Only where cameras that came this way saw the ceiling in every room that they were in; else its absence says
    nothing.
    """
    pieces, found = ndimage.label(free & ~_widened(marks["edge"]))
    cells = np.bincount(pieces.ravel(), minlength=found + 1)
    cells[0] = 0
    roofed = np.bincount(pieces[marks["overhead"]], minlength=found + 1)
    large = cells * CELL**2 >= params.min_outdoors
    entered = np.isin(np.arange(found + 1), pieces[stood])
    rooms = entered & large
    if not rooms.any() or (roofed < params.roof_share * cells)[rooms].any():
        return free
    outdoors = ~entered & large & (roofed < params.open_share * cells)
    indoors: Bools = free & ~outdoors[pieces]
    return indoors


def _reached(free: Bools, stood: Bools) -> Bools:
    """The connected pieces of F in which a camera was; all, where none was in any."""
    pieces, _ = ndimage.label(free)
    entered = np.unique(pieces[stood & free])
    if not len(entered):
        return free
    kept = np.zeros(int(pieces.max()) + 1, bool)
    kept[entered] = True
    reached: Bools = kept[pieces]
    return reached


def _without_specks(wall: Bools, min_cells: int) -> Bools:
    pieces, _ = ndimage.label(wall, _AROUND)
    kept: Bools = wall & (np.bincount(pieces.ravel()) >= min_cells)[pieces] if wall.any() else wall
    return kept


def _fill(free: Bools, wall: Bools, fill_area: float) -> Bools:
    """F with its small enclosed holes filled, those that touch a wall or the edge left out."""
    holes, found = ndimage.label(~free & ~wall)
    if not found:
        return free
    small = np.bincount(holes.ravel()) * CELL**2 <= fill_area
    beside_wall = np.unique(holes[_widened(wall)])
    edge = np.unique(np.concatenate([holes[0], holes[-1], holes[:, 0], holes[:, -1]]))
    small[beside_wall] = small[edge] = small[0] = False
    filled: Bools = free | small[holes]
    return filled


def _occupancy(driven: Bools, blocked: Bools, specks: float) -> U8:
    free = driven & ~blocked
    pieces, _ = ndimage.label(free)
    free &= (np.bincount(pieces.ravel()) * CELL**2 >= specks)[pieces]
    occupancy = np.full(free.shape, UNKNOWN, np.uint8)
    occupancy[free] = FREE
    occupancy[blocked] = OCCUPIED
    return occupancy


def _widened(mask: Bools) -> Bools:
    """The mask and the eight neighbours of each of its cells."""
    wide = mask.copy()
    for axis in (0, 1):
        thin = np.moveaxis(wide.copy(), axis, 0)
        out = np.moveaxis(wide, axis, 0)
        out[1:] |= thin[:-1]
        out[:-1] |= thin[1:]
    return wide


def _discs(centres: Bools, radius: float) -> Bools:
    """Cells within `radius` metres of a centre."""
    reach = int(radius / CELL + 1e-9)
    down, across = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    near = np.hypot(down, across) * CELL <= radius + 1e-9
    at = np.argwhere(np.pad(centres, reach))
    discs = np.zeros((centres.shape[0] + 2 * reach, centres.shape[1] + 2 * reach), bool)
    discs[np.add.outer(at[:, 0], down[near]), np.add.outer(at[:, 1], across[near])] = True
    return discs[reach : reach + centres.shape[0], reach : reach + centres.shape[1]]
