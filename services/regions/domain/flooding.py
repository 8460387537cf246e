"""Flooding: the clearance D of free space, and the watersheds that share it out (KGSW, Algorithm 1 lines 1, 4, 26)."""

from __future__ import annotations

import cv2
import numpy as np
from scipy import ndimage
from skimage.graph import MCP_Geometric
from skimage.segmentation import watershed

from ovip.scene.types import F32, F64, I32, Bools


def clearance_of(free: Bools, resolution: float) -> F32:
    """D: metres from each free cell to the nearest that is not, the grid's edge included -> `(R, C)`."""
    if not free.size:
        return np.zeros(free.shape, np.float32)
    bordered = np.pad(free, 1).astype(np.uint8)
    cells = cv2.distanceTransform(bordered, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    return np.asarray(cells * np.float32(resolution), np.float32)


def flood(relief: F32 | F64, markers: I32, mask: Bools) -> I32:
    """Watershed(relief, markers; mask): each cell of the mask goes to the marker that floods it first -> `(R, C)`.

    Cells connect by edges; a piece of the mask without a marker stays 0. What a marker encloses is flooded already
    and is spared the queue, which is most of a floor.
    """
    enclosed = _enclosed(markers)
    flooded = watershed(relief, np.where(enclosed, 0, markers), mask=mask & ~enclosed)
    labels: I32 = np.where(enclosed & mask, markers, flooded).astype(np.int32)
    return labels


def share_by_distance(markers: I32, mask: Bools) -> I32:
    """Each cell of the mask goes to the marker nearest to it by a way inside the mask -> `(R, C)`.

    A piece of the mask without a marker stays 0.
    """
    starts = np.argwhere((markers > 0) & mask & ~_enclosed(markers))
    if not len(starts):
        return np.zeros(mask.shape, np.int32)
    metres, _ = MCP_Geometric(np.where(mask, 1.0, -1.0)).find_costs(starts)
    return flood(np.where(np.isfinite(metres), metres, 0.0), markers, mask)


def components(mask: Bools, min_cells: float) -> I32:
    """Pieces of the mask connected by edges, in row-major order of their first cells, smaller ones left out."""
    pieces, _ = ndimage.label(mask)
    sizes = np.bincount(pieces.ravel()) if pieces.size else np.zeros(1, np.int64)
    return renumber(pieces, [k for k in range(1, len(sizes)) if sizes[k] >= min_cells])


def renumber(labels: I32, kept: list[int]) -> I32:
    """Labels in `kept` become 1, 2, .. in that order; all others 0."""
    table = np.zeros(int(labels.max(initial=0)) + 1, np.int32)
    table[kept] = np.arange(1, len(kept) + 1)
    return table[labels]


def _enclosed(markers: I32) -> Bools:
    """Cells whose four neighbours bear the same marker."""
    enclosed = np.zeros(markers.shape, dtype=bool)
    if min(markers.shape) < 3:
        return enclosed
    middle = markers[1:-1, 1:-1]
    enclosed[1:-1, 1:-1] = (
        (middle > 0)
        & (markers[:-2, 1:-1] == middle)
        & (markers[2:, 1:-1] == middle)
        & (markers[1:-1, :-2] == middle)
        & (markers[1:-1, 2:] == middle)
    )
    return enclosed
