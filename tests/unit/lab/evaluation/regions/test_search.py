"""Regions as units of search, on three regions whose shares are round numbers."""

from __future__ import annotations

import numpy as np
import pytest

from lab.evaluation.scores.region_search import (
    Units,
    open_targets,
    oracle_units,
    routing,
    strict_units,
)

NONE = np.zeros(0, np.int64)


def home() -> Units:
    """Ground floor: regions 0 (60 of 100 m²) and 1 (40); upper floor: region 2 (25 of 50, the rest is no region)."""
    return Units(
        floor=np.array([0, 0, 1]),
        area=np.array([60.0, 40.0, 25.0]),
        viewpoints=np.array([6.0, 2.0, 1.0]),
        objects=np.array([10.0, 30.0, 5.0]),
        whole_area=np.array([100.0, 50.0]),
        whole_viewpoints=np.array([8.0, 2.0]),
        whole_objects=np.array([40.0, 10.0]),
    )


def test_a_targets_unit_is_its_regions_share_of_that_floor() -> None:
    score = oracle_units(home(), np.array([0, 1, 2]), np.array([True, False, False]))
    assert score.containment == 1.0
    assert score.area == pytest.approx((0.6 + 0.4 + 0.5) / 3)
    assert score.viewpoints == pytest.approx((6 / 8 + 2 / 8 + 1 / 2) / 3)
    assert score.objects == pytest.approx((0.25 + 0.75 + 0.5) / 3)
    assert score.open_area == pytest.approx(0.6)


def test_a_target_in_no_region_is_left_out_or_strictly_costs_the_floor() -> None:
    holder, in_the_open = np.array([1, -1]), np.array([False, True])
    compat, strict = oracle_units(home(), holder, in_the_open), strict_units(home(), holder, in_the_open)
    assert compat.containment == strict.containment == 0.5
    assert compat.area == pytest.approx(0.4)
    assert compat.open_area is None
    assert strict.area == pytest.approx((0.4 + 1.0) / 2)
    assert strict.open_area == pytest.approx(1.0)


def test_the_open_is_where_the_geometric_region_is_over_three_tenths() -> None:
    units = home()
    assert open_targets(units, np.array([0, 2, -1])).tolist() == [True, True, False]
    small = Units(**{**{f: getattr(units, f) for f in Units.__slots__}, "area": np.array([30.0, 31.0, 1.0])})
    assert open_targets(small, np.array([0, 1, 2])).tolist() == [False, True, False]


def test_a_route_that_holds_the_target_costs_its_viewpoints_and_one_that_does_not_the_whole_home() -> None:
    score = routing(home(), np.array([1, 0]), [(1, 2), (2,)])
    assert score.success == 0.5
    assert score.area == pytest.approx(((40 + 25) / 150 + 25 / 150) / 2)
    assert score.cost == pytest.approx(((2 + 1) / 10 + 1.0) / 2)


def test_a_query_without_a_route_goes_everywhere() -> None:
    score = routing(home(), np.array([1]), [()])
    assert (score.success, score.area, score.cost) == (0.0, 1.0, 1.0)


def test_without_targets_there_are_no_shares() -> None:
    nobody = np.zeros(0, np.bool_)
    assert set(oracle_units(home(), NONE, nobody).columns.values()) == {0.0, None}
    assert routing(home(), NONE, []).cost == 1.0


def test_without_regions_every_target_is_everywhere() -> None:
    none = Units(NONE, *([np.zeros(0)] * 3), *([np.array([10.0])] * 3))
    lost = np.array([-1])
    assert oracle_units(none, lost, np.array([False])).area is None
    assert strict_units(none, lost, np.array([True])).area == 1.0
    assert not open_targets(none, lost).any()
    assert routing(none, lost, [()]).cost == 1.0
