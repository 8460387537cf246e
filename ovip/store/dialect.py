"""How the server is spoken to: its errors as ours, its replies as values, a step as a script's words."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Any

from redis.exceptions import ConnectionError as RedisConnectionError
from redis.exceptions import RedisError
from redis.exceptions import TimeoutError as RedisTimeoutError

from ovip.errors import Unavailable
from ovip.store.values import Append, Entry

CURSOR = "cursor"


@contextlib.asynccontextmanager
async def spoken() -> AsyncIterator[None]:
    """Turns the client library's errors into ours, and never lets it swallow a cancellation.

    Its wait_for can, and so can what it does about a lost connection: a service would go on trying for ever after it
    was told to stop. Only one that came meanwhile: what a cancelled task says on its way out still goes through.
    """
    task = asyncio.current_task()
    cancelled_before = task.cancelling() if task else 0
    try:
        yield
    except RedisError as error:
        if task and task.cancelling() > cancelled_before:
            raise asyncio.CancelledError from error
        lost = isinstance(error, RedisConnectionError | RedisTimeoutError)
        raise Unavailable(f"the store {'cannot be reached' if lost else 'refused'}: {error}") from error
    if task and task.cancelling() > cancelled_before:
        raise asyncio.CancelledError


def cursor_field(name: str) -> str:
    return name if name == CURSOR else f"{CURSOR}:{name}"


def words_of_step(
    inputs: Mapping[str, str], puts: Mapping[str, bytes | str | int], appends: Sequence[Append]
) -> list[bytes | str | int]:
    words: list[bytes | str | int] = [len(inputs)]
    for name, input_id in inputs.items():
        words.extend((cursor_field(name), input_id))
    words.append(len(puts))
    for put in puts.items():
        words.extend(put)
    for append in appends:
        words.extend((append.entry_id or "*", 2 * len(append.fields)))
        for field in append.fields.items():
            words.extend(field)
    return words


def logs_of(reply: Any) -> list[tuple[str, list[Any]]]:
    """Each log's rows in an XREAD reply, in the RESP2 (list) or RESP3 (dict) form."""
    if not reply:
        return []
    if isinstance(reply, dict):
        return [
            (log.decode(), [row for chunk in chunks for row in chunk] if _nested(chunks) else list(chunks))
            for log, chunks in reply.items()
        ]
    return [(log.decode(), list(rows)) for log, rows in reply]


def _nested(chunks: list[Any]) -> bool:
    return bool(chunks) and isinstance(chunks[0], list)


def entries_of(rows: list[Any]) -> list[Entry]:
    return [
        Entry(entry.decode(), {name.decode(): value for name, value in fields.items()})
        for entry, fields in rows
        if fields is not None
    ]
