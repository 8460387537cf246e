"""Entity tags: a body that is still the newest is not sent again."""

from __future__ import annotations

from typing import Any

from fastapi import Request, Response
from fastapi.responses import JSONResponse

_HEADERS = {"Cache-Control": "private, no-cache"}


def etag_of(*versions: int) -> str:
    """The tag of what is made from these versions: map version first, then the regions revision."""
    return '"' + "-".join(str(version) for version in versions) + '"'


def not_modified(request: Request, etag: str) -> Response | None:
    """A 304 where the caller already holds `etag`, else None."""
    held = [tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")]
    if etag not in held and "*" not in held:
        return None
    return Response(status_code=304, headers={"ETag": etag} | _HEADERS)


def tagged_file(content: bytes, media_type: str, etag: str, name: str = "") -> Response:
    """Bytes with their tag; a file to be saved where it has a name."""
    saved = {"Content-Disposition": f'attachment; filename="{name}"'} if name else {}
    return Response(content, media_type=media_type, headers={"ETag": etag} | _HEADERS | saved)


def tagged(body: Any, etag: str) -> JSONResponse:
    """`body` with its tag."""
    return JSONResponse(body, headers={"ETag": etag} | _HEADERS)
