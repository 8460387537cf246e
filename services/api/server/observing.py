"""What every request passes through: metrics, headers that keep the page to itself, the last net."""

from __future__ import annotations

import time
from typing import Any

from prometheus_client import Counter, Histogram
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ovip.telemetry import get_logger
from services.api.server.problems import internal_problem

_REQUESTS = Counter("ovip_api_requests_total", "REST requests answered", ["method", "route", "status"])
_SECONDS = Histogram(
    "ovip_api_request_seconds", "Time until the first byte of an answer", ["method", "route"]
)
_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


class Observing:
    """ASGI middleware. Routes are counted by their pattern, so that names in paths make no new series."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._log = get_logger("api")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began = time.perf_counter()
        answered = False

        async def observed(message: Message) -> None:
            nonlocal answered
            if message["type"] == "http.response.start":
                answered = True
                MutableHeaders(scope=message).update(_HEADERS)
                _count(scope, message["status"], time.perf_counter() - began)
            await send(message)

        try:
            await self._app(scope, receive, observed)
        except Exception as error:  # the one place that turns whatever is left into a problem
            self._log.error("request_failed", method=scope["method"], path=scope["path"], exc_info=error)
            if not answered:
                await internal_problem()(scope, receive, observed)


def _count(scope: Scope, status: int, seconds: float) -> None:
    pattern = _pattern(scope)
    _REQUESTS.labels(scope["method"], pattern, str(status)).inc()
    _SECONDS.labels(scope["method"], pattern).observe(seconds)


def _pattern(scope: Scope) -> str:
    """The route's path with its names in braces; FastAPI gives it with or without the router's prefix."""
    route: Any = scope.get("route")
    pattern: str = getattr(route, "path", "none")
    below_v1 = route is not None and scope["path"].startswith("/v1/") and not pattern.startswith("/v1/")
    return f"/v1{pattern}" if below_v1 else pattern
