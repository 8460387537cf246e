"""What the paper leads one to expect of KGSW beside its baselines, and whether it came out (its tables of regions).

Each is computed from the mean rows of an evaluation, in the evaluator's own way and in the strict one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from lab.evaluation.experiment import Row

OURS = "KGSW"
BASELINES = ("HOV-SG", "SysNav", "auto-K")

Means = Mapping[str, Row]
"""A mean row by method."""

Value = Callable[[Means], float | None]
"""A figure of the mean rows; None where one that it takes is missing."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """A value that should be at least, or else at most, so much; neither: it is reported beside another."""

    name: str
    value: Value
    least: float | None = None
    most: float | None = None

    @property
    def bound(self) -> str:
        """As a table shows it."""
        if self.least is not None:
            return f">= {self.least:g}"
        return "" if self.most is None else f"<= {self.most:g}"

    def is_met(self, value: float | None) -> bool | None:
        """Whether a value is within the bound; None where there is no value, or no bound."""
        if value is None or not self.bound:
            return None
        return value >= self.least if self.least is not None else value <= (self.most or 0.0)


def expectations(rows: Sequence[Row]) -> list[Row]:
    """Each expectation with its bound, value and whether it is met, in mean rows and in their "strict" ones."""
    compat = {row["config"]: row for row in rows}
    strict = {config: row.get("strict", {}) for config, row in compat.items()}
    judged = []
    for expected in EXPECTED:
        value, honest = expected.value(compat), expected.value(strict)
        judged.append(
            {
                "expectation": expected.name,
                "bound": expected.bound,
                "value": value,
                "met": expected.is_met(value),
                "strict_value": honest,
                "strict_met": expected.is_met(honest),
            }
        )
    return judged


def _above(column: str, method: str) -> Value:
    """Ours less another method's."""

    def value(means: Means) -> float | None:
        ours, other = _figure(means, OURS, column), _figure(means, method, column)
        return None if ours is None or other is None else ours - other

    return value


def _times(column: str, method: str) -> Value:
    """How many times ours another method's is."""

    def value(means: Means) -> float | None:
        ours, other = _figure(means, OURS, column), _figure(means, method, column)
        return None if not ours or other is None else other / ours

    return value


def _beside(column: str, best: Callable[[Sequence[float]], float]) -> Value:
    """Ours less the best of the baselines'."""

    def value(means: Means) -> float | None:
        ours, others = _figure(means, OURS, column), [_figure(means, name, column) for name in BASELINES]
        there = [other for other in others if other is not None]
        return None if ours is None or len(there) < len(BASELINES) else ours - best(there)

    return value


def _lost_to_floors(means: Means) -> float | None:
    one, more = (_figure(means, OURS, column) for column in ("HydP_one_floor", "HydP_more_floors"))
    return None if one is None or more is None else one - more


def _figure(means: Means, method: str, column: str) -> float | None:
    figure: float | None = means.get(method, {}).get(column)
    return figure


EXPECTED = (
    Expectation("containment, ours less HOV-SG's", _above("containment", "HOV-SG"), least=-0.03),
    Expectation("area of the unit, HOV-SG's over ours", _times("area", "HOV-SG"), least=1.5),
    Expectation("the same in the open, SysNav's over ours", _times("open_area", "SysNav"), least=3.0),
    Expectation("the same in the open, HOV-SG's over ours", _times("open_area", "HOV-SG")),
    Expectation("mean acc, ours less the best baseline's", _beside("acc", max), least=0.0),
    Expectation("acc_std, ours less the least baseline's", _beside("acc_std", min), most=0.0),
    Expectation("HydP, one floor's less that of more", _lost_to_floors, most=0.03),
)
