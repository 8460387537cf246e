"""Backoff and Retry-After."""

from __future__ import annotations

import random
from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.vlm_gateway.domain.retry import RetryParams, parse_retry_after, retry_delay

NOW = datetime(2026, 3, 1, 12, 0, 0, tzinfo=UTC)


@given(st.integers(1, 9), st.integers(0, 2**32))
def test_delay_stays_under_its_doubling_ceiling(attempt: int, seed: int) -> None:
    params = RetryParams(attempts=10, base_s=0.5, cap_s=20.0)
    delay = retry_delay(attempt, None, 1e9, random.Random(seed), params)
    assert delay is not None and 0.0 <= delay <= min(20.0, 0.5 * 2 ** (attempt - 1))


@given(st.floats(0.0, 100.0), st.integers(0, 2**32))
def test_what_the_upstream_asked_for_is_waited_in_full(asked: float, seed: int) -> None:
    delay = retry_delay(1, asked, 1e9, random.Random(seed), RetryParams())
    assert delay is not None and asked <= delay <= asked + 0.5


def test_same_seed_same_delay() -> None:
    assert retry_delay(2, None, 9.0, random.Random(7), RetryParams()) == retry_delay(
        2, None, 9.0, random.Random(7), RetryParams()
    )


def test_gives_up_after_the_last_attempt_and_before_the_deadline() -> None:
    assert retry_delay(4, None, 1e9, random.Random(0), RetryParams(attempts=4)) is None
    assert retry_delay(1, 30.0, 29.0, random.Random(0), RetryParams()) is None


@pytest.mark.parametrize(
    ("value", "seconds"),
    [
        ("7", 7.0),
        ("1.5", 1.5),
        ("-3", 0.0),
        ("Sun, 01 Mar 2026 12:00:30 GMT", 30.0),
        ("Sun, 01 Mar 2026 11:00:00 GMT", 0.0),
        (None, None),
        ("", None),
        ("soon", None),
        ("nan", None),
        ("inf", None),
        ("Sun, 99 Mar 2026 12:00:30 GMT", None),
    ],
)
def test_retry_after_is_seconds_or_a_date(value: str | None, seconds: float | None) -> None:
    assert parse_retry_after(value, NOW) == seconds


@given(st.text(max_size=40))
def test_no_header_value_does_worse_than_say_nothing(value: str) -> None:
    seconds = parse_retry_after(value, NOW)
    assert seconds is None or seconds >= 0.0
