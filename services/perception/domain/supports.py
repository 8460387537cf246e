"""What a thing stands on: the level that goes on around its mask, taken off where the mask bled onto it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, Bools, Frame
from services.perception.domain.masks import Patch
from services.perception.domain.voxel_clouds import Clouds

_STEP = 4  # of rows and columns, one is looked at: a level is no small thing
_TALL_SHARE = 0.05  # of what stands over a level must be tall, for the thing to be
_FEWEST = (4, 8)  # pixels looked at, of a mask and around it, that can tell anything


@dataclass(frozen=True, slots=True)
class SupportParams:
    """around: how far beyond a mask's box is looked, share of its size. lowest: share of a mask's pixels below its
    low end. reach: metres from it within which the level around is looked for. share: of the pixels around that
    must lie there. level: metres over it that still belong to it. least: share of a mask's points that must stand
    over it. tall: metres over it at which a thing is tall. margin: metres around what stands over it.
    """

    around: float = 0.25
    lowest: float = 0.05
    reach: float = 0.03
    share: float = 0.15
    level: float = 0.02
    least: float = 0.15
    tall: float = 0.3
    margin: float = 0.02


def support_heights(frame: Frame, patches: Sequence[Patch], params: SupportParams) -> F64:
    """Height in metres of the level surface under each mask `(M,)`; NaN where none goes on around it.

    It lies at the mask's low end: a table's top under a cup, the floor under a table. A mask that ends at its
    thing's lower edge has the level there too, for the thing stands on it. Levels are seen from above: what is not
    below the camera is none.
    """
    heights, eye = _heights(frame), frame.world_from_camera[2, 3]
    found = np.array([_support(heights, patch, params) for patch in patches])
    return np.where(found < eye, found, np.nan)


def standing(clouds: Clouds, supports: F64, least_points: int, params: SupportParams) -> Bools:
    """Which points `(V,)` are of the things themselves, not of what they stand on. supports: by owner, NaN for none.

    Of the points at the support's level, a tall thing loses all (between its legs one sees the floor), another those
    beside what stands over the level (a cup keeps its foot). Nothing is taken where too little stands over it: a
    rug, a book, a table's top are level themselves.
    """
    x, y, z = clouds.points.T
    level = supports[clouds.owners]
    over, low = z > level + params.level, z <= level + params.level  # both False without a support
    count = len(supports)
    total, standing_over = np.bincount(clouds.owners, minlength=count), _count(clouds, over, count)
    enough = standing_over >= np.maximum(least_points, params.least * total)
    tall = _count(clouds, z > level + params.tall, count) >= np.maximum(1.0, _TALL_SHARE * standing_over)
    beside = np.zeros(len(z), np.bool_)
    for axis in (x, y):
        lowest, highest = _range(axis, over, clouds, count)
        beside |= axis < (lowest - params.margin)[clouds.owners]
        beside |= axis > (highest + params.margin)[clouds.owners]
    return np.asarray(~(low & enough[clouds.owners] & (tall[clouds.owners] | beside)), np.bool_)


def _heights(frame: Frame) -> F32:
    """World heights `(h, w)` of every few pixels, NaN without depth."""
    k, pose = frame.intrinsics, frame.world_from_camera
    depth = frame.depth[::_STEP, ::_STEP]
    across = pose[2, 0] * ((np.arange(0, k.width, _STEP) - k.cx) / k.fx)
    down = pose[2, 1] * ((np.arange(0, k.height, _STEP) - k.cy) / k.fy) + pose[2, 2]
    heights = (across[None, :] + down[:, None]) * depth + pose[2, 3]
    return np.where(depth > 0, heights, np.nan).astype(np.float32)


def _support(heights: F32, patch: Patch, params: SupportParams) -> float:
    rows, columns, inside = _looked_at(heights.shape, patch, params.around)
    seen = heights[rows, columns]
    known = ~np.isnan(seen)
    own, around = seen[inside & known], seen[~inside & known]
    if len(own) < _FEWEST[0] or len(around) < _FEWEST[1]:
        return np.nan
    low = _ranked(own, params.lowest)
    level = around[np.abs(around - low) <= params.reach]
    return np.nan if len(level) < params.share * len(around) else _ranked(level, 0.5)


def _ranked(values: F32, share: float) -> float:
    """The least of the values `(N,)` that `share` of them lie below."""
    nth = int(share * len(values))
    return float(np.partition(values, nth)[nth])


def _looked_at(shape: tuple[int, ...], patch: Patch, around: float) -> tuple[slice, slice, Bools]:
    """The part of the coarse image in and around a mask, and which of its pixels `(h, w)` are in it."""
    first_row, first_column = -(-patch.y // _STEP), -(-patch.x // _STEP)
    own = patch.inside[first_row * _STEP - patch.y :: _STEP, first_column * _STEP - patch.x :: _STEP]
    more_rows, more_columns = (max(3, int(around * side)) for side in own.shape)
    top, left = max(0, first_row - more_rows), max(0, first_column - more_columns)
    bottom = min(shape[0], first_row + own.shape[0] + more_rows)
    right = min(shape[1], first_column + own.shape[1] + more_columns)
    inside = np.zeros((bottom - top, right - left), np.bool_)
    inside[first_row - top :, first_column - left :][: own.shape[0], : own.shape[1]] = own
    return slice(top, bottom), slice(left, right), inside


def _count(clouds: Clouds, which: Bools, count: int) -> F64:
    """How many of the points `(V,)` each owner has."""
    return np.bincount(clouds.owners[which], minlength=count).astype(np.float64)


def _range(axis: F32, which: Bools, clouds: Clouds, count: int) -> tuple[F64, F64]:
    """Least and largest of the coordinates `(V,)` of each owner's points; infinite where it has none."""
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    values, owners = axis[which], clouds.owners[which]
    if len(values):
        starts = np.flatnonzero(np.diff(owners, prepend=-1))
        low[owners[starts]] = np.minimum.reduceat(values, starts)
        high[owners[starts]] = np.maximum.reduceat(values, starts)
    return low, high
