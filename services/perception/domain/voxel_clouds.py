"""Pixels of many masks as clouds in the world, one point a voxel, all masks in one go (SPEC 1.6)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ovip.scene.types import F32, I64, U8, Bools, Frame

_FINE = 1 << 16  # steps of an edge at which a point's place in its voxel is noted, so that sums are exact
_LOW = (1 << 32) - 1


@dataclass(frozen=True, slots=True, eq=False)
class Clouds:
    """One point a voxel of each owner, ordered by owner and, inside one, by voxel key.

    points: `(V, 3)` float32 world metres, each in its voxel as `ovip.scene.voxels.voxel_keys` has it. colors:
    `(V, 3)` uint8 means. owners: `(V,)`. cells: `(V, 3)` the voxels on the world's grid.
    """

    points: F32
    colors: U8
    owners: I64
    cells: I64

    def kept(self, keep: Bools) -> Clouds:
        """The points that `keep` `(V,)` says."""
        if keep.all():
            return self
        index = np.flatnonzero(keep)
        points, colors, cells = (_columns(rows, index) for rows in (self.points, self.colors, self.cells))
        return Clouds(points, colors, self.owners[index], cells)


def voxel_clouds(frame: Frame, pixels: I64, owners: I64, size: float) -> Clouds:
    """The pixels `(P,)` (flat indices, with depth) as one point a voxel of `size` metres and owner `(P,)`.

    A point is the mean of its pixels' places, a colour that of their colours; sums are of whole numbers, so that
    their order cannot matter.
    """
    if len(pixels) == 0:
        return Clouds(_rows(np.float32), _rows(np.uint8), np.zeros(0, np.int64), _rows(np.int64))
    cells, places = _cells_and_places(frame, pixels, size)
    keys = _keys(owners, cells)
    order = np.argsort(keys)
    ordered = keys[order]
    last = np.append(np.flatnonzero(ordered[1:] != ordered[:-1]), len(ordered) - 1)
    counts = np.diff(last, prepend=-1)
    first = order[last]
    taken = np.stack(
        [axis[first] for axis in cells]
    )  # axes first: a column in one piece is quicker to go through
    red, green, blue = (channel.ravel()[pixels].astype(np.int64) for channel in cv2.split(frame.rgb))
    x, y = _pair_sums(places[0], places[1], order, last)
    z, b = _pair_sums(places[2], blue, order, last)
    r, g = _pair_sums(red, green, order, last)
    points = np.stack([_means(*axis, counts, size) for axis in zip((x, y, z), taken, strict=True)])
    colors = np.stack([np.rint(channel / counts).astype(np.uint8) for channel in (r, g, b)])
    return Clouds(points.T, colors.T, owners[first], taken.T)


def _cells_and_places(frame: Frame, pixels: I64, size: float) -> tuple[list[I64], list[I64]]:
    """Of each pixel the voxel that holds it and its place in there in steps of 1 / _FINE, axis by axis: `(P,)` each.

    The ray through a pixel is a term of its column plus a term of its row.
    """
    k, pose = frame.intrinsics, frame.world_from_camera
    rows = pixels // k.width
    columns = pixels - rows * k.width
    turned = pose[:3, :3] / size
    of_column = turned[:, :1] * ((np.arange(k.width) - k.cx) / k.fx)
    of_row = turned[:, 1:2] * ((np.arange(k.height) - k.cy) / k.fy) + turned[:, 2:3]
    z = frame.depth.ravel()[pixels].astype(np.float64)
    cells, places = [], []
    for axis in range(3):
        at = of_column[axis][columns]
        at += of_row[axis][rows]
        at *= z
        at += pose[axis, 3] / size
        cell = np.floor(at)
        at -= cell
        at *= _FINE
        cells.append(cell.astype(np.int64))
        places.append(at.astype(np.int64))
    return cells, places


def _keys(owners: I64, cells: list[I64]) -> I64:
    """One number `(P,)` for each owner and voxel, in the order of owner, x, y, z."""
    keys = owners.copy()
    for axis in cells:
        low = int(axis.min())
        keys *= int(axis.max()) - low + 1
        keys += axis
        keys -= low
    return keys


def _pair_sums(a: I64, b: I64, order: I64, last: I64) -> tuple[I64, I64]:
    """Sums `(V,)` of two columns `(P,)` of small numbers from 0, taken in `order`, over runs that end at `last`."""
    sums = np.cumsum((a << 32 | b)[order])[last]
    sums[1:] -= sums[:-1].copy()
    return sums >> 32, sums & _LOW


def _means(places: I64, cells: I64, counts: I64, size: float) -> F32:
    """Mean coordinate `(V,)` in metres; what float32 would round out of its voxel goes one step back into it."""
    means = ((places / (counts * _FINE) + cells) * size).astype(np.float32)
    out = np.flatnonzero(np.floor(means.astype(np.float64) / size) != cells)
    means[out] = np.nextafter(means[out], ((cells[out] + 0.5) * size).astype(np.float32))
    return means


def _columns(rows: np.ndarray, index: I64) -> np.ndarray:  # type: ignore[type-arg]
    """Some rows of `(V, 3)`, each column in one piece."""
    return np.stack([column[index] for column in rows.T]).T


def _rows(kind: type) -> np.ndarray:  # type: ignore[type-arg]
    return np.zeros((0, 3), kind)
