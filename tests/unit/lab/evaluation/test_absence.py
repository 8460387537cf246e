from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.absence import Confusion, Decision, confusion, half_of, wilson, within_budget


def test_full_budget_row_of_the_paper() -> None:
    full = Confusion(tp=20, fn=2, tn=14, fp=8, located=10)
    assert round(full.sensitivity, 3) == 0.909
    assert round(full.absent_accuracy, 3) == 0.636
    assert round(full.balanced_accuracy, 3) == 0.773
    assert round(full.negative_precision, 3) == 0.875
    assert round(full.located_rate, 3) == 0.455


def test_half_budget_row_of_the_paper() -> None:
    half = Confusion(tp=19, fn=3, tn=14, fp=8, located=9)
    assert round(half.sensitivity, 3) == 0.864
    assert round(half.absent_accuracy, 3) == 0.636
    assert round(half.balanced_accuracy, 3) == 0.750
    assert round(half.located_rate, 3) == 0.409


@pytest.mark.parametrize(
    ("successes", "trials", "interval"),
    [(20, 22, (0.722, 0.975)), (14, 22, (0.430, 0.803)), (14, 16, (0.640, 0.965))],
)
def test_intervals_of_the_paper(successes: int, trials: int, interval: tuple[float, float]) -> None:
    assert tuple(round(end, 3) for end in wilson(successes, trials)) == interval


def test_no_trials_say_nothing() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    assert Confusion(0, 0, 0, 0).balanced_accuracy == 0.0


@given(st.integers(1, 500), st.data())
def test_an_interval_holds_its_rate_and_stays_within_0_and_1(trials: int, data: st.DataObject) -> None:
    successes = data.draw(st.integers(0, trials))
    low, high = wilson(successes, trials)
    assert 0.0 <= low <= successes / trials + 1e-12
    assert successes / trials - 1e-12 <= high <= 1.0


def test_decisions_are_counted_by_truth_and_located_within_a_metre() -> None:
    decisions = [
        Decision(present=True, declared=True, miss=1.0),
        Decision(present=True, declared=True, miss=1.1),
        Decision(present=True, declared=False),
        Decision(present=False, declared=False),
        Decision(present=False, declared=True),
        Decision(present=False, declared=True, miss=0.1),
    ]
    assert confusion(decisions) == Confusion(tp=2, fn=1, tn=1, fp=2, located=1)


def test_half_a_budget_is_the_prefix_of_the_full_trace() -> None:
    assert half_of(52) == 26
    assert half_of(7) == 3
    assert within_budget(26, half_of(52))
    assert not within_budget(27, half_of(52))
    assert not within_budget(None, 52)
