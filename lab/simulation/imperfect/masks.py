"""How masks go wrong: borders off, cut short, in parts, or with a piece of something else."""

from __future__ import annotations

import cv2
import numpy as np

from lab.simulation.imperfect.frames import SeenFrame
from lab.simulation.imperfect.streams import stream
from ovip.scene.camera import lift_pixels
from ovip.scene.types import F64, I64, Bools, Box2

_SMALLEST_PART = 0.05  # share of the thing's pixels
_MOST_SPLIT = 3  # parts delivered in place of a thing


def box_of_mask(mask: Bools) -> Box2:
    """The box around a mask `(H, W)` that is not empty."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return Box2(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))


def on_border(mask: Bools) -> bool:
    """Whether a mask reaches the image's border."""
    return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())


def with_border_error(mask: Bools, pixels: int) -> Bools:
    """The mask grown (or shrunk, where negative) by `pixels`; unchanged where nothing would be left."""
    if pixels == 0:
        return mask
    kernel = np.ones((2 * abs(pixels) + 1,) * 2, np.uint8)
    change = cv2.dilate if pixels > 0 else cv2.erode
    changed = np.asarray(change(mask.astype(np.uint8), kernel), dtype=np.bool_)
    return changed if changed.any() else mask


def cut_short(mask: Bools, rng: np.random.Generator) -> Bools:
    """The mask with 30 to 60 % of its width or height cut off at one side."""
    box = box_of_mask(mask)
    share, side = rng.uniform(0.3, 0.6), int(rng.integers(4))
    x = box.x0 + (box.x1 - box.x0) * (share if side == 0 else 1 - share)
    y = box.y0 + (box.y1 - box.y0) * (share if side == 2 else 1 - share)
    left = mask.copy()
    if side < 2:
        left[:, slice(0, round(x)) if side == 0 else slice(round(x), None)] = False
    else:
        left[slice(0, round(y)) if side == 2 else slice(round(y), None)] = False
    return left if left.any() else mask


def parts(seen: SeenFrame, mask: Bools, object_id: int, seed: int, size: tuple[float, float]) -> list[Bools]:
    """The visible parts of a thing, largest first: what of it lies in each cell of a turned grid of its own.

    The grid is the thing's own in the world, so that a part is the same part in every view; its cells are `size`
    (smallest, largest) metres wide. At most three parts; none where only one is large enough.
    """
    index = np.flatnonzero(mask & (seen.depth > 0))
    if len(index) == 0:
        return []
    cells = _cells(seen, index, object_id, seed, size)
    keys, inverse, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    large = [i for i in np.argsort(-counts, kind="stable") if counts[i] >= _SMALLEST_PART * len(index)]
    if len(large) < 2 or len(keys) < 2:
        return []
    return [_painted(mask, index[inverse == i]) for i in large[:_MOST_SPLIT]]


def patch_of(other: Bools, mask: Bools, rng: np.random.Generator) -> Bools:
    """What of `other` lies in the mask's box, grown by 15 to 50 % of its size at each side."""
    box = box_of_mask(mask)
    grow = rng.uniform(0.15, 0.5, 4)
    w, h = box.x1 - box.x0, box.y1 - box.y0
    height, width = mask.shape
    left, right = max(0, round(box.x0 - grow[0] * w)), min(width, round(box.x1 + grow[1] * w))
    top, bottom = max(0, round(box.y0 - grow[2] * h)), min(height, round(box.y1 + grow[3] * h))
    patch = np.zeros_like(mask)
    patch[top:bottom, left:right] = other[top:bottom, left:right]
    return patch


def _cells(seen: SeenFrame, index: I64, object_id: int, seed: int, size: tuple[float, float]) -> I64:
    """The grid cell `(N, 3)` of each pixel's world point."""
    rng = stream(seed, "parts", object_id)
    points = lift_pixels(index, seen.depth.ravel()[index], seen.intrinsics, seen.world_from_camera)
    turn, edge, offset = rng.uniform(0, np.pi / 2), rng.uniform(*size), rng.uniform(0, 1, 3)
    grid: F64 = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return np.floor(points.astype(np.float64) @ grid / edge + offset).astype(np.int64)


def _painted(like: Bools, index: I64) -> Bools:
    mask = np.zeros(like.size, dtype=np.bool_)
    mask[index] = True
    return mask.reshape(like.shape)
