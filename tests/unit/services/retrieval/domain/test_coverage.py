from __future__ import annotations

import numpy as np
import pytest

from services.retrieval.domain.coverage import (
    CoverageParams,
    View,
    assess,
    missed,
    posterior_present,
    region_cells,
    seen_share,
    times_seen,
)
from tests.unit.services.retrieval.builders import grid_of, region

GRID = grid_of("aaaabbbb", 0.5, {"a": "r1", "b": "r2"})


def test_a_view_through_half_the_floor_leaves_the_other_half() -> None:
    # from the left end, reach 1.5 m: cells 0..3 of 0.5 m, all of region a
    counts = times_seen(GRID, [View(0, 0.25, 0.25, 0.0, 2 * np.pi)], reach=1.5)
    assert counts[0].tolist() == [1, 1, 1, 1, 0, 0, 0, 0]
    assert seen_share(counts, region_cells(GRID, "r1")) == 1.0
    assert seen_share(counts, region_cells(GRID, "r2")) == 0.0


def test_the_chance_to_have_missed_falls_with_every_view() -> None:
    area = np.ones((1, 2), bool)
    # one cell unseen, one seen twice at d = .7: (1 + .09) / 2
    assert missed(np.array([[0, 2]]), area) == pytest.approx(0.545)
    assert missed(np.array([[0, 0]]), area) == 1.0
    assert missed(np.zeros((1, 2), int), np.zeros((1, 2), bool)) == 1.0


def test_the_posterior_by_hand() -> None:
    # p0 = .8; weights .8, .2; region 1 seen once everywhere (m = .3), region 2 not at all (m = 1)
    # M = .8*.3 + .2*1 = .44; .8*.44 / (.8*.44 + .2) = .352 / .552
    assert posterior_present([0.8, 0.2], [0.3, 1.0]) == pytest.approx(0.352 / 0.552)


def test_before_looking_the_posterior_is_the_prior() -> None:
    assert posterior_present([0.8, 0.2], [1.0, 1.0]) == pytest.approx(0.8)


def test_certainty_is_clipped_and_nothing_known_is_one_half() -> None:
    assert posterior_present([1.0], [1.0]) == pytest.approx(0.95)
    assert posterior_present([0.0], [1.0]) == pytest.approx(0.05)
    assert posterior_present([], []) == 0.5


def test_the_account_of_a_search() -> None:
    regions = [region("r1", "kitchen", area=1.0), region("r2", "bedroom", area=1.0)]
    views = [View(0, 0.25, 0.25, 0.0, 2 * np.pi)]
    coverage = assess(
        regions, {"r1": 0.8, "r2": 0.05}, {0: GRID}, views, (2, 1, 1), 1.5, CoverageParams(detection_rate=0.7)
    )
    assert [(r.region_id, r.seen, r.prior) for r in coverage.regions] == [("r1", 1.0, 0.8), ("r2", 0.0, 0.05)]
    # p0 .8; weights 16/17, 1/17; M = 16/17*.3 + 1/17
    m = 16 / 17 * 0.3 + 1 / 17
    assert coverage.posterior_present == pytest.approx(0.8 * m / (0.8 * m + 0.2))
    assert not coverage.complete


@pytest.mark.parametrize(("counted", "complete"), [((4, 4, 0), True), ((4, 3, 1), False), ((0, 0, 0), False)])
def test_complete_means_that_every_planned_viewpoint_was_visited(
    counted: tuple[int, int, int], complete: bool
) -> None:
    assert assess([], {}, {}, [], counted, 3.0).complete is complete


def test_a_region_without_a_grid_was_not_seen() -> None:
    coverage = assess([region("r1", "kitchen")], {"r1": 0.5}, {}, [], (1, 0, 0), 3.0)
    assert coverage.regions[0].seen == 0.0
    assert coverage.posterior_present == pytest.approx(0.5)


def test_views_of_another_floor_or_off_the_grid_do_not_count() -> None:
    views = [View(1, 0.25, 0.25, 0.0, 7.0), View(0, 99.0, 0.0, 0.0, 7.0)]
    assert times_seen(GRID, views, 3.0).sum() == 0
