"""How many partitions the stage's pace makes of many changes, and how busy they keep it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from lab.bench.rows import Row
from services.regions.domain.pace import PaceParams, is_due

_LOOK_S = 0.05  # seconds between two looks at the clock
BURST = tuple(0.002 * number for number in range(1_000))
"""When a thousand changes come that are made at once, seconds."""
STREAM = tuple(0.1 * number for number in range(600))
"""When the changes of a minute's walk come, ten a second."""


@dataclass(frozen=True, slots=True)
class Paced:
    """partitions: how many were made until nothing was left to see; busy: share of that time spent on them, 0..1."""

    partitions: int
    busy: float


def paced(changes: Sequence[float], cost_s: float, pace: PaceParams) -> Paced:
    """Plays changes, seconds rising, to a stage whose partitions take `cost_s` each and are made one at a time."""
    now, made, ended, seen = 0.0, 0, -math.inf, 0
    while seen < len(changes):
        come = sum(change <= now for change in changes[seen:]) + seen
        if come > seen and is_due(now - changes[seen], now - changes[come - 1], now - ended, pace):
            now, made, seen = now + cost_s, made + 1, come
            ended = now
        else:
            now += _LOOK_S
    return Paced(made, made * cost_s / max(now, 1e-9))


def burst_columns(cost_s: float, pace: PaceParams) -> Row:
    """What a burst and a stream cost where a partition after a change takes so many seconds."""
    burst, stream = paced(BURST, cost_s, pace), paced(STREAM, cost_s, pace)
    return {
        "burst_partitions": burst.partitions,
        "stream_partitions": stream.partitions,
        "stream_busy": round(stream.busy, 3),
    }
