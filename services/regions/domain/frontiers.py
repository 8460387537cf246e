"""Frontiers: where the floor that was seen ends at what never was, which is where to explore (SPEC 3)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from ovip.scene.grid import FREE, UNKNOWN
from ovip.scene.types import F64, I64, Bools
from services.regions.domain.free_space import FreeSpace


@dataclass(frozen=True, slots=True)
class FrontierParams:
    """Metres and square metres.

    min_width: shorter borders are left out. thin: unknown floor narrower than this is none (slits beside furniture and
    walls). min_hole: nor is unknown floor that known cells enclose, if it is smaller than this. min_floor: pieces of
    seen floor below this have no frontier. chord: a border is measured as a line of corners this far apart.
    """

    min_width: float = 0.5
    thin: float = 0.25
    min_hole: float = 1.0
    min_floor: float = 1.0
    chord: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """One piece of frontier. position: `(3,)` metres, its middle, on seen floor; cell: (row, column) of it; width:
    metres along it."""

    position: F64
    cell: tuple[int, int]
    width: float


def find_frontiers(
    space: FreeSpace, z: float, params: FrontierParams | None = None, known: Bools | None = None
) -> tuple[Border, ...]:
    """The borders between seen and unknown floor of a storey at height `z`, the widest first, then by cell.

    Seen floor is free, or in F and nothing was met there; unknown is what is neither that, nor wall, nor furniture.
    known: `(R, C)` cells where there is no floor to find: the footprints of stairs.
    """
    params = params or FrontierParams()
    thin = max(1, round(params.thin / space.resolution))
    seen = (space.occupancy == FREE) | (space.free & (space.occupancy == UNKNOWN))
    unseen = ~seen & ~space.wall & (space.occupancy == UNKNOWN)
    if known is not None:
        unseen &= ~known
    free = _large(np.pad(seen, thin + 1), params.min_floor / space.resolution**2)
    unknown = _opened(np.pad(unseen, thin + 1, constant_values=True), thin)
    unknown = _large(unknown, params.min_hole / space.resolution**2)
    at, normal = _border(free, unknown)
    borders = [_measured(at[piece] - (thin + 1), normal[piece], space, z, params) for piece in _pieces(at)]
    kept = [border for border in borders if border.width >= params.min_width - 1e-9]
    return tuple(sorted(kept, key=lambda border: (-border.width, border.cell)))


def _large(mask: Bools, cells: float) -> Bools:
    """The pieces of a mask, joined by their cells' sides, with at least so many cells."""
    _, pieces, stats, _ = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=4)
    enough = stats[:, cv2.CC_STAT_AREA] >= cells - 1e-6
    enough[0] = False
    kept: Bools = enough[pieces]
    return kept


def _opened(mask: Bools, side: int) -> Bools:
    """What squares of `side` cells that lie in the mask cover."""
    square = np.ones((side, side), np.uint8)
    covered: Bools = cv2.morphologyEx(mask.view(np.uint8), cv2.MORPH_OPEN, square) > 0
    return covered


def _border(free: Bools, unknown: Bools) -> tuple[I64, F64]:
    """Free cells `(K, 2)` beside unknown ones, by row and column, and each one's ways out, added up `(K, 2)`."""
    near = cv2.dilate(unknown.view(np.uint8), cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))) > 0
    at = np.argwhere(free & near)
    normal = np.zeros((len(at), 2))
    for step in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        normal += np.outer(unknown[tuple((at + step).T)], step)
    return at, normal


def _pieces(at: I64) -> Iterator[I64]:
    """Indices of the cells `(K, 2)` that lie within two cells of one another, piece by piece."""
    if not len(at):
        return
    pairs = cKDTree(at).query_pairs(2.9, output_type="ndarray")
    links = sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(at), len(at)))
    count, pieces = csgraph.connected_components(links, directed=False)
    yield from np.split(
        np.argsort(pieces, kind="stable"), np.cumsum(np.bincount(pieces, minlength=count))[:-1]
    )


def _measured(at: I64, normal: F64, space: FreeSpace, z: float, params: FrontierParams) -> Border:
    """The border of these cells: its length as chords, the sums of the normals in squares of that size."""
    block = at // max(1, round(params.chord / space.resolution))
    _, of = np.unique(block, axis=0, return_inverse=True)
    chords = np.stack([np.bincount(of.ravel(), weights=side) for side in normal.T], axis=1)
    width = space.resolution * float(np.linalg.norm(chords, axis=1).sum())
    row, column = at[np.argmin(((at - at.mean(axis=0)) ** 2).sum(axis=1))].tolist()
    x, y = (
        space.origin[0] + (column + 0.5) * space.resolution,
        space.origin[1] + (row + 0.5) * space.resolution,
    )
    return Border(np.array([x, y, z]), (row, column), width)
