"""Depth units per metre that recordings use, and which of them a depth image in metres was counted in."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32

KNOWN_SCALES = (1000.0, 5000.0, 6553.5, 4000.0, 10000.0, 256.0)
"""Millimetres; TUM and ICL; Replica; RealSense L515; tenths of millimetres; KITTI."""
_WHOLE = 0.02
_MOST = 65535


def scale_of(metres: F32) -> float:
    """The first known scale in which all of `(H, W)` metres is whole units; else the finest that holds the farthest."""
    there = metres[metres > 0].astype(np.float64)
    for scale in KNOWN_SCALES:
        units = there * scale
        if (np.abs(units - units.round()) < _WHOLE).all() and units.max(initial=0) < _MOST + _WHOLE:
            return scale
    holding = [scale for scale in KNOWN_SCALES if there.max() * scale < _MOST + _WHOLE]
    return max(holding, default=min(KNOWN_SCALES))
