"""When to ask an upstream again: exponential backoff with full jitter, bounded by the time left."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime


@dataclass(frozen=True, slots=True)
class RetryParams:
    """attempts: calls at most, the first included. base_s, cap_s: the jitter's first and largest ceiling."""

    attempts: int = 4
    base_s: float = 0.5
    cap_s: float = 20.0


def retry_delay(
    attempt: int, retry_after: float | None, remaining: float, rng: random.Random, params: RetryParams
) -> float | None:
    """Seconds to wait before the next call, or None to give this upstream up.

    attempt: calls made so far (1 after the first). retry_after: what the upstream asked for, kept in full.
    delay = retry_after + U(0, min(cap, base * 2^(attempt - 1))); None where it reaches past `remaining`.
    """
    if attempt >= params.attempts:
        return None
    ceiling = min(params.cap_s, params.base_s * 2.0 ** (attempt - 1))
    delay = (retry_after or 0.0) + rng.uniform(0.0, ceiling)
    return delay if delay < remaining else None


def parse_retry_after(value: str | None, now: datetime) -> float | None:
    """Seconds that a `Retry-After` header asks for (RFC 9110: number or date); None where there is none."""
    if value is None:
        return None
    seconds = _seconds(value)
    if seconds is None:
        seconds = _seconds_until(value, now)
    return None if seconds is None or not math.isfinite(seconds) else max(0.0, seconds)


def _seconds(value: str) -> float | None:
    try:
        return float(value)
    except ValueError:
        return None


def _seconds_until(value: str, now: datetime) -> float | None:
    try:
        moment = parsedate_to_datetime(value)
    except (ValueError, TypeError, OverflowError):
        return None
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=UTC)
    return (moment - now).total_seconds()
