"""Spreads of samples."""

from __future__ import annotations

import pytest

from lab.bench.rows import spread


def test_a_spread_names_median_tail_and_mean() -> None:
    assert spread([1.0, 2.0, 3.0, 4.0, 90.0]) == {
        "p50_ms": 3.0,
        "p99_ms": pytest.approx(86.56),
        "mean_ms": 20.0,
    }


def test_one_sample_is_its_own_spread_and_columns_take_a_name() -> None:
    assert spread([7.0], "ack") == {"ack_p50_ms": 7.0, "ack_p99_ms": 7.0, "ack_mean_ms": 7.0}
