"""Pace: a burst is one partition."""

from __future__ import annotations

from services.regions.domain.pace import PaceParams, is_due

PACE = PaceParams(burst=10, quiet_s=2.0, min_interval_s=5.0)


def test_without_a_change_nothing_is_due() -> None:
    assert not is_due(0, 100.0, 100.0, PACE)


def test_one_change_waits_for_quiet() -> None:
    assert not is_due(1, 1.9, 100.0, PACE)
    assert is_due(1, 2.0, 100.0, PACE)


def test_a_burst_does_not_wait_for_quiet_but_keeps_the_interval() -> None:
    assert is_due(10, 0.0, 5.0, PACE)
    assert not is_due(10, 0.0, 4.9, PACE)
    assert not is_due(9, 0.0, 100.0, PACE)


def test_changes_that_come_slowly_keep_the_interval_too() -> None:
    assert not is_due(1, 3.0, 3.0, PACE)
    assert is_due(1, 3.0, 5.0, PACE)
