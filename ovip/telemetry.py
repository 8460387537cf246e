"""Logs as events with fields, and the metrics registry."""

from __future__ import annotations

import logging
import sys
from typing import Any

import structlog


class _StandardError:
    """Whatever standard error is when something is said; it may be another than at the start, or that one closed."""

    def write(self, text: str) -> int:
        return sys.stderr.write(text)

    def flush(self) -> None:
        sys.stderr.flush()


def configure_logging(level: str, as_json: bool) -> None:
    """Once, at the start of a process: events go to standard error."""
    renderer: Any = (
        structlog.processors.JSONRenderer() if as_json else structlog.dev.ConsoleRenderer(colors=False)
    )
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            structlog.processors.format_exc_info,
            renderer,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(getattr(logging, level.upper())),
        logger_factory=structlog.PrintLoggerFactory(_StandardError()),  # type: ignore[arg-type]
        cache_logger_on_first_use=False,
    )


def get_logger(name: str) -> Any:
    """A logger that says which part speaks: `log.info("frame_durable", scene=..., frame_id=...)`."""
    return structlog.get_logger(part=name)  # lazy: takes the configuration of when it first speaks
