"""Pace: when a scene is partitioned again; a burst of changes once, a steady stream every so often."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PaceParams:
    """quiet_s: a change is answered once nothing has changed for so long, so that a burst is answered once.

    min_interval_s: never sooner than this after the last partition. No change waits longer for quiet than the
    greater of the two, so that a stream of changes that never pauses is answered at that interval.
    """

    quiet_s: float = 2.0
    min_interval_s: float = 5.0


def is_due(since_first_s: float, since_last_s: float, since_partition_s: float, params: PaceParams) -> bool:
    """Whether to partition now: seconds since the first and the last change that no partition has seen, and
    since the last partition (infinite where there was none)."""
    if since_partition_s < params.min_interval_s:
        return False
    patience = max(params.quiet_s, params.min_interval_s)
    return since_last_s >= params.quiet_s or since_first_s >= patience
