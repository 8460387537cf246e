"""Masks gated by depth: what belongs to the thing in the box, by where its surface jumps (SPEC 1.4)."""

from __future__ import annotations

import cv2
import numpy as np

from ovip.scene.types import F32, Bools, Box2

JUMP = 0.025  # relative depth step between neighbours that ends a surface
_CENTRE = 0.5  # share of the box, around its centre, that must hold the thing


def surface_mask(depth: F32, box: Box2) -> Bools:
    """The connected surfaces `(H, W)` inside a box that reach its central part, most of it first.

    depth: `(H, W)` metres, 0 = none. Neighbouring pixels are connected where their depths differ by less than
    `JUMP` of their distance. The component with the most pixels in the middle half of the box is the thing.
    """
    mask = np.zeros(depth.shape, dtype=bool)
    x0, y0, x1, y1 = pixels_of(box, depth.shape)
    patch = depth[y0:y1, x0:x1]
    if patch.size == 0 or not (patch > 0).any():
        return mask
    labels = _surfaces(patch)
    h, w = patch.shape
    top, left = int(h * (1 - _CENTRE) / 2), int(w * (1 - _CENTRE) / 2)
    middle = labels[top : max(h - top, top + 1), left : max(w - left, left + 1)]
    counts = np.bincount(middle.ravel(), minlength=labels.max() + 1)
    counts[0] = 0
    if counts.max() == 0:
        return mask
    mask[y0:y1, x0:x1] = labels == counts.argmax()
    return mask


def pixels_of(box: Box2, shape: tuple[int, ...]) -> tuple[int, int, int, int]:
    """Whole pixels x0, y0, x1, y1 of a box, inside an image of `shape`."""
    return (
        int(np.clip(np.floor(box.x0), 0, shape[1])),
        int(np.clip(np.floor(box.y0), 0, shape[0])),
        int(np.clip(np.ceil(box.x1), 0, shape[1])),
        int(np.clip(np.ceil(box.y1), 0, shape[0])),
    )


def _surfaces(patch: F32) -> np.ndarray[tuple[int, int], np.dtype[np.int32]]:
    """Connected surfaces `(h, w)`: 0 = no depth or an edge, else a number."""
    jump = JUMP * patch
    edge = patch <= 0
    across = np.abs(np.diff(patch, axis=1)) > jump[:, 1:]
    down = np.abs(np.diff(patch, axis=0)) > jump[1:]
    edge[:, 1:] |= across
    edge[1:] |= down
    _, labels = cv2.connectedComponents((~edge).astype(np.uint8), connectivity=4)
    return np.asarray(labels, np.int32)
