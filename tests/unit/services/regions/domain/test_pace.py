"""Pace: a burst is one partition, a stream that never pauses is not starved."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from services.regions.domain.pace import PaceParams, is_due

PACE = PaceParams(quiet_s=2.0, min_interval_s=5.0)


def test_a_change_waits_for_quiet() -> None:
    assert not is_due(1.9, 1.9, 100.0, PACE)
    assert is_due(2.0, 2.0, 100.0, PACE)


def test_changes_that_keep_coming_wait_no_longer_than_the_interval() -> None:
    assert not is_due(4.9, 0.1, 100.0, PACE)
    assert is_due(5.0, 0.1, 100.0, PACE)


def test_nothing_is_due_sooner_than_the_interval_after_the_last_partition() -> None:
    assert not is_due(60.0, 60.0, 4.9, PACE)
    assert is_due(60.0, 60.0, 5.0, PACE)


def test_an_interval_shorter_than_the_quiet_is_no_reason_not_to_wait_for_quiet() -> None:
    assert not is_due(1.9, 0.0, 100.0, PaceParams(quiet_s=2.0, min_interval_s=0.0))
    assert is_due(2.0, 0.0, 100.0, PaceParams(quiet_s=2.0, min_interval_s=0.0))


@given(gaps=st.lists(st.floats(0.01, 1.9), min_size=1, max_size=200))
def test_a_stream_without_a_pause_is_answered_at_every_interval_and_a_short_one_once(
    gaps: list[float],
) -> None:
    answered = partitions_of(gaps)
    length = sum(gaps[1:])
    assert answered[0] <= 5.0 + 1.9
    assert all(5.0 <= later - earlier <= 5.0 + 1.9 + 2.0 for earlier, later in pairwise(answered))
    assert answered[-1] >= length
    if length < 5.0:
        assert len(answered) == 1


def partitions_of(gaps: list[float]) -> list[float]:
    """When partitions are made of changes with these gaps between them, the first change at 0; looked at every
    hundredth of a second, as a follower does that has nothing else to do."""
    times = [sum(gaps[1 : k + 1]) for k in range(len(gaps))]
    made: list[float] = []
    seen, tick = 0, 0
    while seen < len(times):
        now = tick / 100
        waiting = [t for t in times[seen:] if t <= now]
        last = made[-1] if made else float("-inf")
        if waiting and is_due(now - waiting[0], now - waiting[-1], now - last, PACE):
            made.append(now)
            seen += len(waiting)
        tick += 1
    return made
