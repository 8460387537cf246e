"""Fixtures of the gateway's tests: real upstreams on this machine and the client that asks them."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator

import httpx
import pytest
import pytest_asyncio

from tests.unit.services.vlm_gateway.local_upstream import LocalUpstream, local_upstream


@pytest.fixture
def upstream() -> Iterator[LocalUpstream]:
    with local_upstream() as running:
        yield running


@pytest.fixture
def second_upstream() -> Iterator[LocalUpstream]:
    with local_upstream() as running:
        yield running


@pytest_asyncio.fixture
async def client() -> AsyncIterator[httpx.AsyncClient]:
    async with httpx.AsyncClient(trust_env=False) as running:
        yield running
