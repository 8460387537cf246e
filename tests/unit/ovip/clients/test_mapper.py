"""The mapper's client: whole maps out of parts, streams that break, edits sent again. Real servers, real channels."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from typing import Any

import grpc
import pytest

from ovip import codec
from ovip.clients import MAX_MESSAGE_BYTES, MapperClient, connect
from ovip.errors import Conflict, Corrupt, Unavailable
from ovip.scene.edits import EditRequest, Rename
from ovip.scene.types import MapDelta, SceneMap, StepKind
from ovip.serving import grpc_server
from ovip.v1 import mapper_pb2, mapper_pb2_grpc
from tests.builders import same
from tests.unit.ovip.map_objects import scene_map

NAME = mapper_pb2.DESCRIPTOR.services_by_name["MapperService"].full_name
SMALL = scene_map(6, 4)


class Kitchen(mapper_pb2_grpc.MapperServiceServicer):
    """Serves one map in parts; `between` runs before each part but the first, told how many were sent."""

    def __init__(
        self, served: SceneMap, part_bytes: int, between: Callable[[int], Any] = lambda _: None
    ) -> None:
        self._served = served
        self._part_bytes = part_bytes
        self._between = between
        self.calls = 0
        self.edits: list[str] = []

    async def GetMap(self, request: Any, context: Any) -> AsyncIterator[Any]:
        self.calls += 1
        for sent, part in enumerate(codec.map_parts(self._served, self._part_bytes)):
            if sent:
                await _done(self._between(sent))
            yield part

    async def EditMap(self, request: Any, context: Any) -> Any:
        self.edits.append(codec.edit_request_value(request).edit_id)
        await _done(self._between(len(self.edits)))
        return mapper_pb2.EditMapResponse(delta=codec.delta_message(MapDelta(8, "", StepKind.EDIT)))


async def _done(result: Any) -> None:
    if asyncio.iscoroutine(result):
        await result


@contextlib.asynccontextmanager
async def mapper_of(kitchen: Kitchen) -> AsyncIterator[MapperClient]:
    def register(server: grpc.aio.Server) -> None:
        mapper_pb2_grpc.add_MapperServiceServicer_to_server(kitchen, server)

    async with grpc_server("mapper", NAME, register, "127.0.0.1", 0, None) as port:
        channel = connect(f"127.0.0.1:{port}")
        try:
            yield MapperClient(channel)
        finally:
            await channel.close()


async def test_a_map_larger_than_any_message_arrives_whole() -> None:
    large = scene_map(2400, 2048)
    assert sum(o.feature.nbytes for o in large.objects) > MAX_MESSAGE_BYTES

    async with mapper_of(Kitchen(large, codec.PART_BYTES)) as mapper:
        assert same(await mapper.get_map("kitchen"), large)


async def test_a_stream_that_breaks_half_way_is_read_again_from_its_start() -> None:
    def breaks_once(sent: int) -> None:
        if sent == 3 and kitchen.calls == 1:
            raise Unavailable("going down")

    kitchen = Kitchen(SMALL, 1, breaks_once)
    async with mapper_of(kitchen) as mapper:
        assert same(await mapper.get_map("kitchen"), SMALL)

    assert kitchen.calls == 2


async def test_a_service_that_keeps_breaking_is_unavailable_in_the_end() -> None:
    def breaks(_sent: int) -> None:
        raise Unavailable("going down")

    kitchen = Kitchen(SMALL, 1, breaks)
    async with mapper_of(kitchen) as mapper:
        with pytest.raises(Unavailable, match="going down"):
            await mapper.get_map("kitchen")

    assert kitchen.calls == 4


async def test_a_map_is_read_over_a_restart_of_the_service() -> None:
    started = asyncio.Event()

    async def hangs(_sent: int) -> None:
        started.set()
        await asyncio.Event().wait()

    async with _serving(Kitchen(SMALL, 1, hangs)) as (server, port):
        channel = connect(f"127.0.0.1:{port}")
        reading = asyncio.create_task(MapperClient(channel).get_map("kitchen"))
        await started.wait()
        await server.stop(grace=0)
    async with _serving(Kitchen(SMALL, 1), port):
        assert same(await reading, SMALL)
        await channel.close()


@contextlib.asynccontextmanager
async def _serving(kitchen: Kitchen, port: int = 0) -> AsyncIterator[tuple[grpc.aio.Server, int]]:
    """A server to be stopped in the middle of a call."""
    server = grpc.aio.server(options=[("grpc.so_reuseport", 0)])
    mapper_pb2_grpc.add_MapperServiceServicer_to_server(kitchen, server)
    bound = server.add_insecure_port(f"127.0.0.1:{port}")
    await server.start()
    try:
        yield server, bound
    finally:
        await server.stop(grace=None)


async def test_parts_of_two_versions_are_no_map() -> None:
    class Moving(Kitchen):
        async def GetMap(self, request: Any, context: Any) -> AsyncIterator[Any]:
            for version in (7, 8):
                for part in codec.map_parts(scene_map(1, 4, version)):
                    yield part

    async with mapper_of(Moving(SMALL, 1)) as mapper:
        with pytest.raises(Corrupt, match="expected parts of one version"):
            await mapper.get_map("kitchen")


async def test_an_edit_is_sent_again_under_its_id_and_a_conflict_is_not() -> None:
    request = EditRequest("e1", 7, "ada", Rename("o000001", "mug"))

    def acts(times: int) -> None:
        if times == 1:
            raise Unavailable("going down")
        if times == 3:
            raise Conflict("o000001 has changed since version 7")

    kitchen = Kitchen(SMALL, 1, acts)
    async with mapper_of(kitchen) as mapper:
        assert (await mapper.edit("kitchen", request)).kind is StepKind.EDIT
        with pytest.raises(Conflict, match="has changed since version 7"):
            await mapper.edit("kitchen", request)

    assert kitchen.edits == ["e1", "e1", "e1"]
