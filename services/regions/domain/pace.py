"""Pace: when a scene has changed enough to be partitioned again, a burst of changes once."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PaceParams:
    """burst: this many changes are enough at once. quiet_s: any change is enough when nothing has changed for so
    long. min_interval_s: but never sooner than this after the last partition."""

    burst: int = 10
    quiet_s: float = 2.0
    min_interval_s: float = 5.0


def is_due(changes: int, since_change_s: float, since_partition_s: float, params: PaceParams) -> bool:
    """Whether to partition now, `changes` after the last partition; never with none."""
    if changes <= 0 or since_partition_s < params.min_interval_s:
        return False
    return changes >= params.burst or since_change_s >= params.quiet_s
