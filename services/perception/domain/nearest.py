"""What a frame saw through: the nearest depth of each block of pixels (SPEC 2.8)."""

from __future__ import annotations

from functools import reduce

import numpy as np

from ovip.scene.types import F32, NEAREST_BLOCK


def nearest_depth(depth: F32, block: int = NEAREST_BLOCK, farthest: float = np.inf) -> F32:
    """Nearest depth in metres of each block of `block` x `block` pixels, `(ceil(H / block), ceil(W / block))`.

    depth: `(H, W)` metres, 0 = none; beyond `farthest` counts as none. A block of which less than half has depth
    is 0: nothing is known of it. What a block lacks at the image's right and lower border counts as without depth.
    """
    height, width = depth.shape
    rows, columns = -(-height // block), -(-width // block)
    known = np.zeros((rows * block, columns * block), np.bool_)
    known[:height, :width] = (depth > 0) & (depth <= farthest)
    full = np.full(known.shape, np.inf, np.float32)
    np.copyto(full[:height, :width], depth, where=known[:height, :width])
    nearest = _over_columns(np.minimum, full.reshape(rows, block, columns * block).min(axis=1), block)
    count = _over_columns(
        np.add, known.reshape(rows, block, columns * block).sum(axis=1, dtype=np.uint16), block
    )
    return np.where(2 * count >= block * block, nearest, np.float32(0))


def _over_columns(combine: np.ufunc, values: np.ndarray, block: int) -> np.ndarray:  # type: ignore[type-arg]
    """Each `block` neighbouring columns of `(R, C * block)` made one."""
    return reduce(combine, (values[:, i::block] for i in range(block)))
