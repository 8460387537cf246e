"""Arrays as little-endian bytes."""

from __future__ import annotations

import numpy as np

from ovip.errors import Corrupt
from ovip.scene.types import F32, U8


def floats(array: F32) -> bytes:
    return np.ascontiguousarray(array, dtype="<f4").tobytes()


def floats_value(data: bytes, columns: int = 0) -> F32:
    """float32 bytes -> `(N,)`, or `(N, columns)`."""
    if len(data) % (4 * max(columns, 1)):
        raise Corrupt(f"expected a multiple of {4 * max(columns, 1)} bytes of float32, got {len(data)}")
    array = np.frombuffer(data, dtype="<f4").astype(np.float32)
    return array.reshape(-1, columns) if columns else array


def colors(array: U8) -> bytes:
    return np.ascontiguousarray(array, dtype=np.uint8).tobytes()


def colors_value(data: bytes) -> U8:
    """uint8 bytes -> `(N, 3)`."""
    if len(data) % 3:
        raise Corrupt(f"expected a multiple of 3 bytes of RGB, got {len(data)}")
    return np.frombuffer(data, dtype=np.uint8).reshape(-1, 3)
