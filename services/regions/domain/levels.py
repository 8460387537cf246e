"""Levels: the heights at which there is floor to stand on, or ceiling, from the cubes that were hit (SPEC 3).

A cube is a top where nothing was hit for a person's height above it, and an underside where nothing was for as much
below. Tops that fill much of one height, and little of the heights beside it, are a level: floors are, and so are the
tops of furniture, but not walls, ramps and stairs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage, signal

from ovip.scene.types import F64, I64, U8, Bools
from services.regions.domain.bricks import SIDE, Bricks
from services.regions.domain.counts import Counts, pack_voxel, unpack_voxel
from services.regions.domain.evidence import BIN, CELL

_CLEAR = 3  # bricks of 0.4 m that are empty above a top
_BESIDE = np.array([-6, -5, -4, -3, 3, 4, 5, 6])  # layers
_REFINE = 0.08  # metres
_HIGHEST = np.array([1 << (n.bit_length() - 1) if n else 0 for n in range(256)], np.uint8)
_PLACE = np.array([max(n.bit_length() - 1, 0) for n in range(256)])
_LOWEST = np.array([n & -n for n in range(256)], np.uint8)


@dataclass(frozen=True, slots=True)
class LevelParams:
    """peak_gap: metres between levels (HOV-SG's 0.2). blur: Gaussian sigma in bins of 0.01 m for a level's exact height
    (HOV-SG's 2). slope: were it a slope, a level would have this share of its area at the heights beside it. min_area:
    smaller ones are none, square metres."""

    peak_gap: float = 0.2
    blur: float = 2.0
    slope: float = 0.5
    min_area: float = 0.2


@dataclass(frozen=True, slots=True)
class Level:
    """z: metres. area: square metres of it that were hit."""

    z: float
    area: float


@dataclass(frozen=True, slots=True, eq=False)
class Hit:
    """The cubes that were hit, by brick: sorted keys `(N,)`, and bits `(N, 64)`, by column (y, x), a bit a layer."""

    bricks: I64
    bits: U8


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Tops or undersides, as `Hit`; at most one in a column of a brick."""

    bricks: I64
    bits: U8

    def at(self, index: I64) -> Bools:
        """Which cubes `(N, 3)` are one of these -> `(N,)`."""
        if not len(self.bricks):
            return np.zeros(len(index), bool)
        key = pack_voxel(index >> 3)
        row = np.minimum(np.searchsorted(self.bricks, key), len(self.bricks) - 1)
        within = index & (SIDE - 1)
        bit = self.bits[row, within[:, 1] * SIDE + within[:, 0]] >> within[:, 2].astype(np.uint8) & 1
        found: Bools = (self.bricks[row] == key) & (bit > 0)
        return found

    def between(self, low: int, high: int) -> I64:
        """The indices `(M, 3)` of those from layer `low` to below `high`."""
        base = unpack_voxel(self.bricks)[:, 2:] * SIDE + np.arange(SIDE)
        wanted = np.packbits((base >= low) & (base < high), axis=1, bitorder="little")
        some = np.flatnonzero(wanted)
        bits = self.bits[some] & wanted[some]
        row, column = np.nonzero(bits)
        within = np.stack([column % SIDE, column // SIDE, _PLACE[bits[row, column]]], axis=1)
        index: I64 = unpack_voxel(self.bricks[some])[row] * SIDE + within
        return index

    def by_layer(self) -> tuple[int, I64]:
        """The lowest layer (z index) of the bricks, and how many there are in each from there up."""
        if not len(self.bricks):
            return 0, np.zeros(0, np.int64)
        height = unpack_voxel(self.bricks)[:, 2]
        low = int(height.min())
        row, column = np.nonzero(self.bits)
        layer = (height[row] - low) * SIDE + _PLACE[self.bits[row, column]]
        return low * SIDE, np.bincount(layer, minlength=(int(height.max()) - low + 1) * SIDE)


def read_hit(hits: Bricks, low: int | None = None, high: int | None = None) -> Hit:
    """The cubes that were hit; from layer `low` to below `high` and as far above as `tops` looks, where both are
    given."""
    bricks = hits.changed(0)
    if low is not None and high is not None:
        height = unpack_voxel(bricks)[:, 2] * SIDE
        bricks = bricks[(height > low - SIDE) & (height < high + _CLEAR * SIDE)]
    bits = np.zeros((len(bricks), SIDE * SIDE), np.uint8)
    at = 0
    for blocks in hits.read(bricks) if len(bricks) else ():
        some = (blocks != 0).view(np.uint8).reshape(len(blocks), SIDE, SIDE * SIDE)
        for layer in range(SIDE):
            bits[at : at + len(blocks)] |= some[:, layer] << np.uint8(layer)
        at += len(blocks)
    return Hit(bricks, bits)


def tops(hit: Hit) -> Surfaces:
    """The highest cube in each column of a brick, where the column of the 1.2 m above the brick was not hit."""
    return _first_of(hit, _HIGHEST, +1)


def undersides(hit: Hit) -> Surfaces:
    """The lowest cube in each column of a brick, where the column of the 1.2 m below the brick was not hit."""
    return _first_of(hit, _LOWEST, -1)


def find_levels(surfaces: Surfaces, heights: Counts, params: LevelParams | None = None) -> tuple[Level, ...]:
    """The levels, from the lowest up; heights: by BIN, of the points that the surfaces were made from."""
    params = params or LevelParams()
    first, cells = surfaces.by_layer()
    margin = int(_BESIDE.max()) + 1
    cells = np.pad(cells, margin).astype(np.float64)
    three: F64 = ndimage.convolve1d(cells, np.ones(3), mode="constant")
    peaks, _ = signal.find_peaks(
        three, height=params.min_area / CELL**2, distance=max(1, round(params.peak_gap / CELL))
    )
    beside = 3.0 * np.median(cells[peaks[:, None] + _BESIDE], axis=1)
    return tuple(
        Level(_exact((first - margin + peak + 0.5) * CELL, heights, params.blur), three[peak] * CELL**2)
        for peak in peaks[beside <= params.slope * three[peaks]].tolist()
    )


def count_near(heights: Counts, z: float, within: float) -> int:
    """Points of a height histogram at most `within` metres from `z`."""
    bins, counts = heights.items()
    return int(counts[slice(*np.searchsorted(bins, _bins(z, within)))].sum())


def _first_of(hit: Hit, pick: U8, way: int) -> Surfaces:
    """The bits that `pick` takes of each column, where the bricks on that side of it are empty."""
    padded = np.concatenate([hit.bits, np.zeros((1, SIDE * SIDE), np.uint8)])
    blocked = np.zeros_like(hit.bits)
    for step in range(1, _CLEAR + 1):
        blocked |= padded[_rows(hit.bricks, hit.bricks + way * step)]
    return Surfaces(hit.bricks, pick[hit.bits] * (blocked == 0))


def _rows(bricks: I64, wanted: I64) -> I64:
    """The row of each key; the number of rows where there is none."""
    row = np.searchsorted(bricks, wanted)
    there = row < len(bricks)
    there[there] = bricks[row[there]] == wanted[there]
    rows: I64 = np.where(there, row, len(bricks))
    return rows


def _exact(z: float, heights: Counts, blur: float) -> float:
    """The height seen most often within a few centimetres of `z`."""
    bins, counts = heights.items()
    low, high = _bins(z, _REFINE)
    at = slice(*np.searchsorted(bins, (low, high)))
    histogram = np.zeros(high - low)
    histogram[bins[at] - low] = counts[at]
    smooth = ndimage.gaussian_filter1d(histogram, blur, mode="constant")
    return (low + int(np.argmax(smooth)) + 0.5) * BIN if histogram.any() else z


def _bins(z: float, within: float) -> tuple[int, int]:
    return int(np.floor((z - within) / BIN)), int(np.floor((z + within) / BIN)) + 1
