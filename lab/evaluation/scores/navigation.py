"""Navigation: success rate, success weighted by path length, length of path (SR, SPL), over several start seeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

AS_SHORT = 1e-6
"""Metres by which a path may differ from the shortest and still count as the same."""


@dataclass(frozen=True, slots=True)
class Drive:
    """One drive. taken: metres driven. shortest: metres from its start to the nearest place that is a success.

    goal_is_truth: whether the goal was the very place that the scorer holds for true.
    """

    success: bool
    taken: float
    shortest: float
    goal_is_truth: bool = False


@dataclass(frozen=True, slots=True)
class DriveScore:
    """Means over start seeds, and the deviations of the seeds' own means (n in the denominator)."""

    sr: float
    sr_std: float
    spl: float
    spl_std: float
    path: float


def spl(drive: Drive) -> float:
    """success x shortest / taken; 1 for a success that needed no step, and never more than 1."""
    if not drive.success:
        return 0.0
    longest = max(drive.taken, drive.shortest)
    return drive.shortest / longest if longest > 0 else 1.0


def score_drives(by_seed: Mapping[int, Sequence[Drive]]) -> DriveScore:
    """SR, SPL and path of each seed's drives, mean and deviation over the seeds; zeros for none."""
    seeds = [drives for drives in by_seed.values() if drives]
    if not seeds:
        return DriveScore(0.0, 0.0, 0.0, 0.0, 0.0)
    rates = np.array([np.mean([d.success for d in drives]) for drives in seeds])
    weighted = np.array([np.mean([spl(d) for d in drives]) for drives in seeds])
    paths = np.array([np.mean([d.taken for d in drives]) for drives in seeds])
    return DriveScore(
        float(rates.mean()),
        float(rates.std()),
        float(weighted.mean()),
        float(weighted.std()),
        float(paths.mean()),
    )


def identities(drives: Sequence[Drive]) -> int:
    """Successful drives, of some length, that are exactly as long as the shortest: many mean that the protocol
    hands out its own answer.
    """
    same = [d for d in drives if d.success and d.taken > AS_SHORT and abs(d.taken - d.shortest) <= AS_SHORT]
    return len(same)
