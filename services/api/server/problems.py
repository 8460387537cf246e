"""Errors as problem details (RFC 9457): type, title, status, and a detail that says what was expected."""

from __future__ import annotations

import http
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from ovip.errors import OvipError

MEDIA_TYPE = "application/problem+json"
_TYPE = "urn:ovip:problem:"
_MAX_INPUT_SHOWN = 80


def problem_of(error: OvipError) -> dict[str, Any]:
    """The problem that one of our errors stands for."""
    return _problem(error.slug, error.http, str(error) or (type(error).__doc__ or error.slug))


def internal_problem() -> JSONResponse:
    """What a caller is told of an error that nobody raised on purpose."""
    return _response(_problem("internal", 500, "an error of ours, written to the log of the api service"))


def install_problem_handlers(app: FastAPI) -> None:
    """Every error that was raised on purpose leaves the app as a problem."""

    async def ours(_request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, OvipError)
        return _response(problem_of(error))

    async def invalid(_request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, RequestValidationError)
        faults = [_fault(fault) for fault in error.errors()]
        detail = "; ".join(f"{fault['where']}: {fault['expected']}" for fault in faults)
        return _response(_problem("invalid-input", 422, detail) | {"errors": faults})

    async def plain(request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, HTTPException)
        phrase = http.HTTPStatus(error.status_code).phrase
        detail = str(error.detail)
        if error.status_code == 404:
            detail = f"{request.url.path}: no such path; /openapi.json lists the paths there are"
        if error.status_code == 405:
            allowed = (error.headers or {}).get("Allow", "another method")
            detail = f"{request.method} {request.url.path}: expected {allowed}"
        return _response(_problem(phrase.lower().replace(" ", "-"), error.status_code, detail), error.headers)

    app.add_exception_handler(OvipError, ours)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(HTTPException, plain)


def _problem(slug: str, status: int, detail: str) -> dict[str, Any]:
    return {"type": _TYPE + slug, "title": http.HTTPStatus(status).phrase, "status": status, "detail": detail}


def _response(problem: dict[str, Any], headers: Any = None) -> JSONResponse:
    extra = dict(headers or {})
    if problem["status"] == 401:
        extra["WWW-Authenticate"] = "Bearer"
    return JSONResponse(problem, problem["status"], extra, MEDIA_TYPE)


def _fault(fault: Any) -> dict[str, str]:
    where = ".".join(str(part) for part in fault["loc"]) or "body"
    expected = str(fault["msg"])
    given = fault.get("input")
    if isinstance(given, str | int | float | bool):
        expected += f" (got {str(given)[:_MAX_INPUT_SHOWN]!r})"
    return {"where": where, "expected": expected}
