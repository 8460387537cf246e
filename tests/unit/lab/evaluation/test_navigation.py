from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.navigation import Drive, DriveScore, identities, score_drives, spl


def test_spl_is_success_times_shortest_over_taken() -> None:
    assert spl(Drive(True, taken=8.0, shortest=6.0)) == 0.75
    assert spl(Drive(False, taken=8.0, shortest=6.0)) == 0.0


def test_who_starts_at_the_goal_and_stays_does_perfectly() -> None:
    assert spl(Drive(True, taken=0.0, shortest=0.0)) == 1.0


def test_three_seeds_give_mean_and_deviation_of_their_rates() -> None:
    good, lost = Drive(True, 10.0, 5.0), Drive(False, 4.0, 2.0)
    score = score_drives({710: [good, good], 711: [good, lost], 712: [lost, lost]})
    assert score.sr == pytest.approx(0.5)
    assert score.sr_std == pytest.approx((1 / 6) ** 0.5)  # of 1, 0.5, 0
    assert score.spl == pytest.approx(0.25)
    assert score.spl_std == pytest.approx((1 / 24) ** 0.5)  # of 0.5, 0.25, 0
    assert score.path == pytest.approx(7.0)


def test_no_drives_score_nothing() -> None:
    assert score_drives({}) == score_drives({710: []}) == DriveScore(0.0, 0.0, 0.0, 0.0, 0.0)


def test_only_successes_of_some_length_exactly_as_short_as_the_shortest_are_suspicious() -> None:
    drives = [Drive(True, 3.0, 3.0), Drive(True, 0.0, 0.0), Drive(False, 3.0, 3.0), Drive(True, 3.05, 3.0)]
    assert identities(drives) == 1


@given(st.booleans(), st.floats(0, 1e3), st.floats(0, 1e3))
def test_spl_lies_between_nothing_and_success(success: bool, taken: float, shortest: float) -> None:
    assert 0.0 <= spl(Drive(success, taken, shortest)) <= float(success)
