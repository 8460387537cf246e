"""SysNav-style rooms: walls from planes, on a coarse grid, dilated until doorways close, and grown back.

After the released room segmentation node: grid of 0.1 m, walls lengthened along themselves and dilated four times,
seeds of more than 40 cells, watershed. What differs: there a wall is a vertical plane grown over normals; here, where
the evidence has no normals, it is a connected set of columns that are hit through at least half of the height between
floor and ceiling and that extends over 0.5 m; and only walls along the grid's axes are lengthened.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from skimage.segmentation import watershed

from ovip.scene.types import I32, I64, Bools
from services.regions.domain.baselines.heights import ceiling_of, filled_voxels
from services.regions.domain.evidence import CELL, FloorEvidence
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace

_AROUND = np.ones((3, 3), bool)


@dataclass(frozen=True, slots=True)
class SysNavParams:
    """cells: grid cells of 0.05 m to a side of one here. dilation: cells of 0.1 m. min_room: cells of a seed.

    wall_from, wall_below: metres above the floor and under the ceiling between which a plane is looked for.
    wall_share: of that band that is hit. min_plane: metres that a plane extends. lengthened: metres that it is drawn
    on at both ends, to meet what it nearly meets.
    """

    cells: int = 2
    dilation: int = 4
    min_room: int = 40
    wall_from: float = 0.3
    wall_below: float = 0.2
    wall_share: float = 0.5
    min_plane: float = 0.5
    lengthened: float = 0.5


def sysnav_rooms(
    evidence: FloorEvidence, storey: Storey, space: FreeSpace, params: SysNavParams | None = None
) -> I32:
    """The storey's rooms on `space`'s grid, within its free space -> `(R, C)`, 0 = none.

    Floor that no seed is left in after the dilation belongs to no room, unless it is connected to one that has.
    """
    params = params or SysNavParams()
    if not space.free.any():
        return np.zeros(space.free.shape, np.int32)
    low, high = storey.z + params.wall_from, ceiling_of(evidence, storey) - params.wall_below
    hit = _coarse(filled_voxels(evidence, space, low, high), space, params.cells)
    planes = _planes(hit >= params.wall_share * max(high - low, CELL) / CELL, params)
    floor = (_coarse(space.free.astype(np.int64), space, params.cells) > 0) & ~planes
    drawn = _lengthened(planes, params)
    closed = ndimage.binary_dilation(
        np.pad(drawn | ~floor, 1, constant_values=True), _AROUND, params.dilation
    )
    pieces, _ = ndimage.label(~closed[1:-1, 1:-1])
    large = np.flatnonzero(np.bincount(pieces.ravel()) > params.min_room)
    seeds = np.searchsorted(large, pieces) * np.isin(pieces, large)
    rooms = watershed(drawn.astype(np.uint8), seeds, mask=floor) if seeds.any() else np.zeros_like(seeds)
    return np.where(space.free, _fine(rooms, space, params.cells), 0).astype(np.int32)


def _planes(tall: Bools, params: SysNavParams) -> Bools:
    """Connected sets of tall columns that extend far enough along either axis -> `(R, C)`."""
    pieces, _ = ndimage.label(tall, _AROUND)
    cells = params.min_plane / (params.cells * CELL)
    kept = [
        number
        for number, window in enumerate(ndimage.find_objects(pieces), start=1)
        if max(side.stop - side.start for side in window) >= cells
    ]
    return np.isin(pieces, kept)


def _lengthened(planes: Bools, params: SysNavParams) -> Bools:
    """The planes with each straight run of `min_plane` along a row or column drawn on -> `(R, C)`."""
    cell = params.cells * CELL
    run, reach = round(params.min_plane / cell), round(params.lengthened / cell)
    drawn = planes.copy()
    for along in ((1, 0), (0, 1)):
        straight = ndimage.binary_opening(planes, np.ones([run if axis else 1 for axis in along]))
        drawn |= ndimage.binary_dilation(straight, np.ones([2 * reach + 1 if axis else 1 for axis in along]))
    return drawn


def _coarse(values: I64, space: FreeSpace, cells: int) -> I64:
    """The most of each block of `cells` x `cells` grid cells, blocks on the world's own lattice -> `(R', C')`."""
    (above, left), (rows, columns) = _offset(space, cells), values.shape
    padded = np.pad(values, ((above, -(above + rows) % cells), (left, -(left + columns) % cells)))
    blocks = padded.reshape(padded.shape[0] // cells, cells, padded.shape[1] // cells, cells)
    coarse: I64 = blocks.max(axis=(1, 3), initial=0)
    return coarse


def _fine(labels: I64, space: FreeSpace, cells: int) -> I64:
    (above, left), (rows, columns) = _offset(space, cells), space.free.shape
    fine = np.repeat(np.repeat(labels, cells, axis=0), cells, axis=1)
    return fine[above : above + rows, left : left + columns]


def _offset(space: FreeSpace, cells: int) -> tuple[int, int]:
    x, y = (round(at / CELL) % cells for at in space.origin)
    return y, x
