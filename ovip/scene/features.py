"""Feature vectors: float32, unit length."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import F32


def normalize(features: F32) -> F32:
    """`(..., D)` features scaled to unit length; a zero vector stays zero."""
    features = np.asarray(features, dtype=np.float32)
    length = np.linalg.norm(features, axis=-1, keepdims=True)
    unit: F32 = np.divide(features, length, out=np.zeros_like(features), where=length > 0)
    return unit


def cosine(a: F32, b: F32) -> F32:
    """Cosine of unit features `(M, D)` and `(N, D)` -> `(M, N)`."""
    return np.asarray(a @ b.T, dtype=np.float32)
