"""The client library's errors as ours, and a cancellation that it may not keep to itself."""

from __future__ import annotations

import asyncio

import pytest
from redis.exceptions import ConnectionError as RedisConnectionError
from redis.exceptions import ResponseError

from ovip.errors import Unavailable
from ovip.store.dialect import spoken


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (RedisConnectionError("gone"), "the store cannot be reached: gone"),
        (ResponseError("WRONGTYPE"), "the store refused: WRONGTYPE"),
    ],
)
async def test_its_errors_become_ours_in_words(error: Exception, words: str) -> None:
    with pytest.raises(Unavailable, match=words):
        async with spoken():
            raise error


@pytest.mark.parametrize("instead", [None, RedisConnectionError("gone")])
async def test_a_cancellation_that_the_library_swallowed_still_ends_the_task(
    instead: Exception | None,
) -> None:
    """It waits with a timeout of its own, and tries again where the connection is lost: either may eat it."""

    async def ask() -> None:
        async with spoken():
            try:
                await asyncio.sleep(10)
            except asyncio.CancelledError:
                if instead:
                    raise instead from None

    task = asyncio.create_task(ask())
    await asyncio.sleep(0)
    task.cancel()

    with pytest.raises(asyncio.CancelledError):
        await task
    assert task.cancelled()


async def test_what_a_cancelled_task_says_on_its_way_out_goes_through() -> None:
    said = []

    async def leave() -> None:
        try:
            await asyncio.sleep(10)
        finally:
            async with spoken():
                said.append("released")

    task = asyncio.create_task(leave())
    await asyncio.sleep(0)
    task.cancel()

    with pytest.raises(asyncio.CancelledError):
        await task
    assert said == ["released"]
