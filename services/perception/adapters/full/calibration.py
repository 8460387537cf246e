"""What a backend's own scores mean: confidence on the scale that perception's threshold is set on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32

KEEP = 0.35
"""Confidence at which a box is just kept where OVIP_MIN_CONFIDENCE is left as it is."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """threshold: the backend's own score, above 0 and below 1, at which it keeps a box by default."""

    threshold: float

    def confidence(self, score: F32) -> F32:
        """Own scores `(N,)` as confidences `(N,)`: 0 to 0, `threshold` to KEEP, 1 to 1, straight between."""
        return np.interp(score, [0.0, self.threshold, 1.0], [0.0, KEEP, 1.0]).astype(np.float32)
