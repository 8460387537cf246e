"""The client for code that does not await, beside a service in another thread's loop."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest

from ovip import codec
from ovip.client import Addresses, Client
from ovip.errors import NotFound
from ovip.scene.types import SceneMap
from ovip.serving import grpc_server
from ovip.v1 import mapper_pb2, mapper_pb2_grpc

NAME = mapper_pb2.DESCRIPTOR.services_by_name["MapperService"].full_name


class OneScene(mapper_pb2_grpc.MapperServiceServicer):
    async def GetMap(self, request: Any, context: Any) -> AsyncIterator[Any]:
        if request.scene != "kitchen":
            raise NotFound(f"there is no scene {request.scene!r}")
        for part in codec.map_parts(SceneMap("kitchen", 3, (), "", 0, 0, "0-0")):
            yield part


@pytest.fixture
async def addresses() -> AsyncIterator[Addresses]:
    def register(server: Any) -> None:
        mapper_pb2_grpc.add_MapperServiceServicer_to_server(OneScene(), server)

    async with grpc_server("mapper", NAME, register, "127.0.0.1", 0, "key") as port:
        yield Addresses(mapper=f"127.0.0.1:{port}", api_key="key")


async def test_a_map_is_read_without_awaiting(addresses: Addresses) -> None:
    def read() -> int:
        with Client(addresses) as client:
            return client.get_map("kitchen").version

    assert await asyncio.to_thread(read) == 3


async def test_errors_arrive_as_themselves(addresses: Addresses) -> None:
    def read() -> None:
        with Client(addresses) as client:
            client.get_map("attic")

    with pytest.raises(NotFound, match="no scene 'attic'"):
        await asyncio.to_thread(read)
