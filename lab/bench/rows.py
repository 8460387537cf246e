"""A measurement as a row of plain values, and the spread of many samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Row = dict[str, str | int | float]


def spread(samples_ms: Sequence[float], name: str = "") -> Row:
    """Median, 99th percentile and mean in milliseconds; `name` before each column's. Needs one sample or more."""
    prefix = f"{name}_" if name else ""
    p50, p99 = np.percentile(samples_ms, [50, 99])
    return {
        f"{prefix}p50_ms": round(float(p50), 3),
        f"{prefix}p99_ms": round(float(p99), 3),
        f"{prefix}mean_ms": round(float(np.mean(samples_ms)), 3),
    }
