"""Reading server-sent events in tests."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from typing import Any

import httpx

Read = tuple[str, Any, str]


async def events_of(response: httpx.Response) -> AsyncIterator[Read]:
    """(name, body, id) of each event; comments are left out."""
    fields: dict[str, str] = {}
    async for line in response.aiter_lines():
        if not line and "data" in fields:
            yield fields.get("event", "message"), json.loads(fields["data"]), fields.get("id", "")
        if not line:
            fields = {}
            continue
        name, _, value = line.partition(": ")
        if name:
            fields[name] = value
