"""The key that every /v1 call carries, where one is set."""

from __future__ import annotations

import hmac
from collections.abc import Callable, Coroutine
from typing import Annotated, Any

from fastapi import Depends
from fastapi.security import APIKeyQuery, HTTPAuthorizationCredentials, HTTPBearer

from ovip.errors import NotAuthorized

_BEARER = HTTPBearer(auto_error=False, description="the stack's OVIP_API_KEY")
_QUERY = APIKeyQuery(
    name="key", auto_error=False, description="the same key, for links, images and EventSource"
)


def key_check(api_key: str | None) -> Callable[..., Coroutine[Any, Any, None]]:
    """A dependency that raises NotAuthorized without the right key; keys are compared in constant time."""

    async def check(
        bearer: Annotated[HTTPAuthorizationCredentials | None, Depends(_BEARER)],
        query: Annotated[str | None, Depends(_QUERY)],
    ) -> None:
        if not api_key:
            return
        given = bearer.credentials.encode("latin-1") if bearer else (query or "").encode()
        if not hmac.compare_digest(given, api_key.encode()):
            raise NotAuthorized(
                "expected the stack's OVIP_API_KEY as 'Authorization: Bearer KEY' or '?key=KEY'"
            )

    return check
