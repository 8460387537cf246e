"""What encoders are shown of a box."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import U8
from services.perception.domain.boxes2d import ScoredBox
from services.perception.domain.segmentation import pixels_of

_MARGIN = 0.1  # context around the box, share of its size


def crop(rgb: U8, box: ScoredBox) -> U8:
    """The box with some of what is around it; at least one pixel."""
    height, width = rgb.shape[:2]
    x0, y0, x1, y1 = pixels_of(box.box, rgb.shape)
    dx, dy = round(_MARGIN * (x1 - x0)), round(_MARGIN * (y1 - y0))
    left, top = min(max(x0 - dx, 0), width - 1), min(max(y0 - dy, 0), height - 1)
    return np.ascontiguousarray(rgb[top : max(y1 + dy, top + 1), left : max(x1 + dx, left + 1)])
