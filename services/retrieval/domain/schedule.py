"""Which region is searched next, and which waypoint in it (CARA, Eq. region scheduling).

r* = argmax_r  lambda S(goal | r) - (1 - lambda) g(p_cur, c_r) / d_max
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64


@dataclass(frozen=True, slots=True)
class ScheduleParams:
    """balance is the paper's lambda, whose value it does not give: 1 goes by likelihood alone, 0 by distance
    alone.
    """

    balance: float = 0.5


def region_scores(
    priors: Sequence[float], distances: Sequence[float], params: ScheduleParams | None = None
) -> F64:
    """Each region's score `(R,)` from S and geodesic metres g to its centroid; -inf where it cannot be
    reached.

    d_max is the greatest finite distance of those given; where that is 0 the distances do not count.
    """
    params = params or ScheduleParams()
    prior, g = np.asarray(priors, np.float64), np.asarray(distances, np.float64)
    finite = np.isfinite(g)
    d_max = float(g[finite].max(initial=0.0))
    far = np.where(finite, g, 0.0) / d_max if d_max > 0 else np.zeros_like(g)
    score = params.balance * prior - (1.0 - params.balance) * far
    return np.where(finite, score, -np.inf)


def next_region(
    priors: Sequence[float], distances: Sequence[float], params: ScheduleParams | None = None
) -> int | None:
    """Index of the region to search next; ties go to the nearer, then the first. None where none can be
    reached.
    """
    scores = region_scores(priors, distances, params)
    if not len(scores) or not np.isfinite(scores).any():
        return None
    return min(range(len(scores)), key=lambda k: (-scores[k], distances[k], k))


def nearest(distances: Sequence[float]) -> int | None:
    """Index of the nearest reachable waypoint; ties go to the first. None where none can be reached."""
    if not len(distances) or not np.isfinite(distances).any():
        return None
    return int(np.argmin(distances))
