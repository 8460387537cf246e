"""Masks before lifting: cut to their boxes, told apart, shaved, thinned (SPEC 1.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ovip.scene.types import I64, Bools

_GOLDEN = 0.382


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A mask cut to its box: `inside` `(h, w)` bool, its corner at column x and row y of the image."""

    x: int
    y: int
    inside: Bools

    @property
    def area(self) -> int:
        """How many pixels are in the mask."""
        return int(cv2.countNonZero(self.inside.view(np.uint8)))

    @property
    def window(self) -> tuple[slice, slice]:
        """Where it lies in an image."""
        h, w = self.inside.shape
        return slice(self.y, self.y + h), slice(self.x, self.x + w)

    def pixels(self, width: int) -> I64:
        """Flat indices of its pixels in an image of that width, ascending."""
        index = np.flatnonzero(self.inside)
        rows = index // self.inside.shape[1]
        return np.asarray(index + rows * (width - self.inside.shape[1]) + (self.y * width + self.x), np.int64)

    def where(self, inside: Bools) -> Patch:
        """The same place with other pixels `(h, w)`."""
        return Patch(self.x, self.y, inside)


@dataclass(frozen=True, slots=True)
class ContainedParams:
    """A mask lies in another where more than `inside` of it does and it is smaller than `smaller` times the other."""

    inside: float = 0.8
    smaller: float = 0.7


def patch_of(mask: Bools) -> Patch:
    """The mask `(H, W)` cut to its box; 0 x 0 pixels for an empty one."""
    rows = np.flatnonzero(mask.any(axis=1))
    if len(rows) == 0:
        return Patch(0, 0, np.zeros((0, 0), np.bool_))
    band = mask[rows[0] : rows[-1] + 1]
    columns = np.flatnonzero(band.any(axis=0))
    x0, x1 = int(columns[0]), int(columns[-1]) + 1
    return Patch(x0, int(rows[0]), np.ascontiguousarray(band[:, x0:x1]))


def shaved(patch: Patch, edge: int) -> Patch:
    """Without its border of `edge` pixels, unless that leaves less than a third of it.

    At a mask's border colour and depth disagree: what lies there may be of something behind.
    """
    if edge == 0 or patch.inside.size == 0:
        return patch
    kernel = np.ones((2 * edge + 1,) * 2, np.uint8)
    inner = patch.where(cv2.erode(patch.inside.view(np.uint8), kernel, borderValue=0).astype(np.bool_))
    return inner if 3 * inner.area >= patch.area else patch


def without_contained(patches: Sequence[Patch], params: ContainedParams) -> list[Patch]:
    """The masks of one frame, the bigger ones without the smaller ones that lie in them.

    A detector's mask of a table often holds the cups on it. Where they have masks of their own, the pixels are
    theirs, and the table's points are the table's (ConceptGraphs' mask subtraction).
    """
    areas = np.array([patch.area for patch in patches])
    left = list(patches)
    for small, big in _may_contain(patches, areas, params):
        at_small, at_big = _common(patches[small], patches[big])
        shared = patches[small].inside[at_small] & patches[big].inside[at_big]
        if cv2.countNonZero(shared.view(np.uint8)) > params.inside * areas[small]:
            inside = left[big].inside.copy()
            inside[at_big] &= ~patches[small].inside[at_small]
            left[big] = left[big].where(inside)
    return left


def thinned(patch: Patch, step: int) -> Patch:
    """Every `step`-th pixel of each row, so shifted from row to row that what is left lies evenly.

    A surface seen at a grazing angle has few rows or few columns to a voxel; a square grid would lose it.
    """
    if step <= 1:
        return patch
    left = patch.inside.copy()
    columns, shift = np.arange(patch.x, patch.x + left.shape[1]), round(_GOLDEN * step)
    for row in range(min(step, left.shape[0])):
        left[row::step] &= (columns + shift * (patch.y + row)) % step == 0
    return patch.where(left)


def _may_contain(patches: Sequence[Patch], areas: I64, params: ContainedParams) -> list[tuple[int, int]]:
    """Pairs (small, big) of masks whose sizes and boxes allow that the one lies in the other."""
    if not patches:
        return []
    low = np.array([(patch.y, patch.x) for patch in patches])
    high = low + [patch.inside.shape for patch in patches]
    sides = np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None])
    overlap = np.prod(np.maximum(sides, 0), axis=-1)
    small = (areas[:, None] < params.smaller * areas[None]) & (overlap > params.inside * areas[:, None])
    return [(int(i), int(j)) for i, j in np.argwhere(small & (areas[:, None] > 0))]


def _common(a: Patch, b: Patch) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Where in each of them the part of the image lies that the boxes of both cover."""
    (ah, aw), (bh, bw) = a.inside.shape, b.inside.shape
    top, bottom = max(a.y, b.y), min(a.y + ah, b.y + bh)
    left, right = max(a.x, b.x), min(a.x + aw, b.x + bw)
    return (
        (slice(top - a.y, bottom - a.y), slice(left - a.x, right - a.x)),
        (slice(top - b.y, bottom - b.y), slice(left - b.x, right - b.x)),
    )
