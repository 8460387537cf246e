"""Events go to standard error, whichever that is when something is said."""

from __future__ import annotations

import io
import sys

import pytest
import structlog

from ovip.telemetry import configure_logging, get_logger


def test_an_event_goes_to_the_standard_error_of_its_moment_though_that_of_the_start_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first, second = io.StringIO(), io.StringIO()
    monkeypatch.setattr(sys, "stderr", first)
    try:
        configure_logging("info", as_json=True)
        first.close()
        monkeypatch.setattr(sys, "stderr", second)
        get_logger("mapper").info("frame_applied", version=7)
    finally:
        structlog.reset_defaults()

    assert '"event": "frame_applied"' in second.getvalue()
    assert '"version": 7' in second.getvalue()
