"""Feature vectors: float32, unit length."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32


def normalize(features: F32) -> F32:
    """`(..., D)` features scaled to unit length; a zero vector stays zero."""
    wide = np.asarray(features, dtype=np.float64)  # squares of large or tiny numbers leave float32
    length = np.linalg.norm(wide, axis=-1, keepdims=True)
    unit = np.divide(wide, length, out=np.zeros_like(wide), where=length > 0)
    return np.asarray(unit, dtype=np.float32)


def cosine(a: F32, b: F32) -> F32:
    """Cosine of unit features `(M, D)` and `(N, D)` -> `(M, N)`."""
    return np.asarray(a @ b.T, dtype=np.float32)
