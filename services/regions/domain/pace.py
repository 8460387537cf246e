"""Pace: when a scene has changed enough to be partitioned again, a burst of changes once."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PaceParams:
    """burst: this many changes are enough, but not sooner than `min_interval_s` after the last partition.
    quiet_s: any change is enough once nothing has changed for so long."""

    burst: int = 10
    quiet_s: float = 2.0
    min_interval_s: float = 5.0


def is_due(changes: int, since_change_s: float, since_partition_s: float, params: PaceParams) -> bool:
    """Whether to partition now, `changes` after the last partition; never with none."""
    if changes <= 0:
        return False
    return since_change_s >= params.quiet_s or (
        changes >= params.burst and since_partition_s >= params.min_interval_s
    )
