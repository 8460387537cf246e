"""Absence: confusion counts of declared presence, their rates with Wilson intervals, and exact prefixes of a trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Z95 = 1.959963984540054
"""The normal distribution's 97.5% point."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What was decided of one question. present: the truth. declared: that the target was found.

    miss: metres from the place that was given to the nearest instance, infinite for none.
    """

    present: bool
    declared: bool
    miss: float = float("inf")


@dataclass(frozen=True, slots=True)
class Confusion:
    """tp, fn of the present, tn, fp of the absent; located: of the present, those given within a metre."""

    tp: int
    fn: int
    tn: int
    fp: int
    located: int = 0

    @property
    def sensitivity(self) -> float:
        """TP / (TP + FN)."""
        return _ratio(self.tp, self.tp + self.fn)

    @property
    def absent_accuracy(self) -> float:
        """TN / (TN + FP)."""
        return _ratio(self.tn, self.tn + self.fp)

    @property
    def balanced_accuracy(self) -> float:
        """Mean of sensitivity and absent accuracy."""
        return (self.sensitivity + self.absent_accuracy) / 2

    @property
    def negative_precision(self) -> float:
        """TN / (TN + FN)."""
        return _ratio(self.tn, self.tn + self.fn)

    @property
    def located_rate(self) -> float:
        """Located / (TP + FN)."""
        return _ratio(self.located, self.tp + self.fn)


def confusion(decisions: Sequence[Decision], within: float = 1.0) -> Confusion:
    """Counts over decisions; `within` metres a target counts as located."""
    present = [d for d in decisions if d.present]
    absent = [d for d in decisions if not d.present]
    tp, fp = sum(d.declared for d in present), sum(d.declared for d in absent)
    located = sum(d.declared and d.miss <= within for d in present)
    return Confusion(tp, len(present) - tp, len(absent) - fp, fp, located)


def wilson(successes: int, trials: int, z: float = Z95) -> tuple[float, float]:
    """Wilson's score interval of a rate; (0, 1) for no trials.

    (p + z²/2n ± z sqrt(p (1 - p) / n + z²/4n²)) / (1 + z²/n)
    """
    if not trials:
        return 0.0, 1.0
    p = successes / trials
    middle = p + z**2 / (2 * trials)
    half = z * float(np.sqrt(p * (1 - p) / trials + z**2 / (4 * trials**2)))
    whole = 1 + z**2 / trials
    return max(0.0, (middle - half) / whole), min(1.0, (middle + half) / whole)


def half_of(planned: int) -> int:
    """How many of a plan's viewpoints half the budget is: the smaller half."""
    return planned // 2


def within_budget(declared_at: int | None, budget: int) -> bool:
    """Whether the first `budget` viewpoints of a full trace had found it already.

    declared_at: the viewpoint, from 1, at which the full trace did; None for never. The order of viewpoints does not
    depend on the budget, so a run with that budget would have seen exactly those.
    """
    return declared_at is not None and declared_at <= budget


def _ratio(part: int, whole: int) -> float:
    return part / whole if whole else 0.0
