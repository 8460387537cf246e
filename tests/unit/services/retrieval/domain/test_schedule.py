from __future__ import annotations

import numpy as np
import pytest

from services.retrieval.domain.schedule import ScheduleParams, nearest, next_region, region_scores


def test_semantics_and_distance_are_traded_as_in_the_paper() -> None:
    # lambda .5, d_max 10: .5*.8 - .5*1 = -.1; .5*.4 - .5*.2 = .1
    np.testing.assert_allclose(region_scores([0.8, 0.4], [10.0, 2.0]), [-0.1, 0.1])
    assert next_region([0.8, 0.4], [10.0, 2.0]) == 1


def test_lambda_one_goes_by_likelihood_and_zero_by_distance() -> None:
    assert next_region([0.8, 0.4], [10.0, 2.0], ScheduleParams(balance=1.0)) == 0
    assert next_region([0.8, 0.9], [1.0, 2.0], ScheduleParams(balance=0.0)) == 0


def test_ties_go_to_the_nearer_then_to_the_first() -> None:
    assert next_region([0.5, 0.5], [3.0, 3.0]) == 0
    assert next_region([0.5, 0.5, 0.5], [3.0, 2.0, 2.0]) == 1
    assert next_region([0.5, 0.5], [3.0, 2.0], ScheduleParams(balance=1.0)) == 1


def test_what_cannot_be_reached_is_never_next() -> None:
    assert next_region([0.9, 0.1], [np.inf, 5.0]) == 1
    assert next_region([0.9], [np.inf]) is None
    assert next_region([], []) is None


def test_standing_in_every_region_at_once_leaves_distance_out() -> None:
    np.testing.assert_allclose(region_scores([0.2, 0.6], [0.0, 0.0]), [0.1, 0.3])


@pytest.mark.parametrize(
    ("distances", "index"), [([2.0, 1.0], 1), ([1.0, 1.0], 0), ([np.inf], None), ([], None)]
)
def test_the_nearest_waypoint_is_first(distances: list[float], index: int | None) -> None:
    assert nearest(distances) == index
