"""How services stand up and how errors travel: real servers on free ports, real clients."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from typing import Any

import grpc
import pytest

from ovip import codec, errors
from ovip.clients import MapperClient, connect
from ovip.errors import InvalidInput, NotAuthorized, NotFound, OvipError, TooLarge, Unavailable
from ovip.healthcheck import is_well
from ovip.scene.types import MapDelta, SceneMap
from ovip.serving import background, check_exposure, grpc_server
from ovip.v1 import mapper_pb2, mapper_pb2_grpc
from tests.builders import same
from tests.unit.ovip.map_objects import map_object

NAME = mapper_pb2.DESCRIPTOR.services_by_name["MapperService"].full_name
EMPTY = SceneMap("kitchen", 3, (), "", 0, 0, "0-0")
CUP = map_object("o000001", version=3)


class Answering(mapper_pb2_grpc.MapperServiceServicer):
    """A service that does as its test says."""

    def __init__(self, act: Callable[[], Any]) -> None:
        self._act = act

    async def GetObject(self, request: Any, context: Any) -> Any:
        self._act()
        return mapper_pb2.GetObjectResponse(object=codec.object_message(CUP), version=3)

    async def GetMap(self, request: Any, context: Any) -> AsyncIterator[Any]:
        self._act()
        for part in codec.map_parts(EMPTY):
            yield part

    async def WatchMap(self, request: Any, context: Any) -> AsyncIterator[Any]:
        yield mapper_pb2.WatchMapResponse(delta=codec.delta_message(MapDelta(1, "f")))
        self._act()


@contextlib.asynccontextmanager
async def serving(
    act: Callable[[], Any] = lambda: None, key: str | None = None, port: int = 0
) -> AsyncIterator[int]:
    def register(server: grpc.aio.Server) -> None:
        mapper_pb2_grpc.add_MapperServiceServicer_to_server(Answering(act), server)

    async with grpc_server("mapper", NAME, register, "127.0.0.1", port, key) as bound:
        yield bound


@contextlib.asynccontextmanager
async def mapper_at(port: int, key: str | None = None) -> AsyncIterator[MapperClient]:
    channel = connect(f"127.0.0.1:{port}", key)
    try:
        yield MapperClient(channel)
    finally:
        await channel.close()


def _raise(error: Exception) -> Callable[[], None]:
    def act() -> None:
        raise error

    return act


def _kinds(kind: type[OvipError] = OvipError) -> list[type[OvipError]]:
    return [kind, *(deep for child in kind.__subclasses__() for deep in _kinds(child))]


async def test_a_call_is_answered() -> None:
    async with serving() as port, mapper_at(port) as mapper:
        assert same(await mapper.get_object("kitchen", "o000001"), CUP)
        assert await mapper.get_map("kitchen") == EMPTY


@pytest.mark.parametrize("kind", [k for k in _kinds() if k not in (OvipError, errors.Unavailable)])
async def test_every_error_arrives_as_itself_with_its_words(kind: type[OvipError]) -> None:
    async with serving(_raise(kind("expected this, got that"))) as port, mapper_at(port) as mapper:
        with pytest.raises(OvipError, match=r"^expected this, got that$") as arrived:
            await mapper.get_object("kitchen", "o000001")
        with pytest.raises(OvipError, match=r"^expected this, got that$") as streamed:
            await mapper.get_map("kitchen")

    assert type(arrived.value) is type(streamed.value) is kind


async def test_an_error_ends_a_stream_after_what_was_sent_before() -> None:
    async with serving(_raise(NotFound("no such scene"))) as port, mapper_at(port) as mapper:
        seen = []
        with pytest.raises(NotFound, match="no such scene"):
            async for delta in mapper.watch("kitchen", 0):
                seen.append(delta.version)

    assert seen == [1]


async def test_a_crash_is_an_internal_error_that_tells_nothing_and_the_service_goes_on() -> None:
    acts = iter([_raise(KeyError("the password is hunter2")), lambda: None])
    async with serving(lambda: next(acts)()) as port, mapper_at(port) as mapper:
        with pytest.raises(OvipError, match="an internal error, logged by the service") as crashed:
            await mapper.get_object("kitchen", "o000001")

        assert "hunter2" not in str(crashed.value)
        assert (await mapper.get_object("kitchen", "o000001")).version == 3


async def test_a_read_is_tried_again_while_the_service_is_away() -> None:
    acts = iter([_raise(Unavailable("starting")), _raise(Unavailable("starting")), lambda: None])
    async with serving(lambda: next(acts)()) as port, mapper_at(port) as mapper:
        assert (await mapper.get_object("kitchen", "o000001")).version == 3


async def test_a_message_over_16_mb_is_too_large_in_words_and_the_service_goes_on() -> None:
    async with serving() as port:
        channel = grpc.aio.insecure_channel(f"127.0.0.1:{port}", [("grpc.enable_http_proxy", 0)])
        stub = mapper_pb2_grpc.MapperServiceStub(channel)
        with pytest.raises(grpc.aio.AioRpcError) as refused:
            await stub.GetObject(mapper_pb2.GetObjectRequest(scene="x" * 20_000_000))
        await channel.close()

        assert refused.value.code() is grpc.StatusCode.RESOURCE_EXHAUSTED
        assert "larger than max" in refused.value.details()
        async with mapper_at(port) as mapper:
            with pytest.raises(TooLarge, match="larger than max"):
                await mapper.get_object("x" * 20_000_000, "o000001")
            assert (await mapper.get_object("kitchen", "o000001")).version == 3


# The key


@pytest.mark.parametrize("given", [None, "wrong", "k", "key2", "Key"])
async def test_without_the_key_every_call_is_refused_in_words(given: str | None) -> None:
    async with serving(key="key") as port, mapper_at(port, given) as mapper:
        with pytest.raises(NotAuthorized, match="authorization: Bearer KEY"):
            await mapper.get_object("kitchen", "o000001")
        with pytest.raises(NotAuthorized, match="authorization: Bearer KEY"):
            async for _ in mapper.watch("kitchen", 0):
                pass


async def test_with_the_key_calls_and_streams_are_answered() -> None:
    async with serving(key="key") as port, mapper_at(port, "key") as mapper:
        assert (await mapper.get_object("kitchen", "o000001")).version == 3
        assert [d.version async for d in mapper.watch("kitchen", 0)] == [1]


async def test_health_is_open_to_all_and_says_serving() -> None:
    async with serving(key="key") as port:
        assert await asyncio.to_thread(is_well, f"127.0.0.1:{port}")

    assert not await asyncio.to_thread(is_well, f"127.0.0.1:{port}")


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "robot.local"])
def test_listening_beyond_this_machine_needs_a_key(host: str) -> None:
    with pytest.raises(InvalidInput, match="set OVIP_API_KEY before listening beyond this machine"):
        check_exposure(host, None)
    with pytest.raises(InvalidInput):
        check_exposure(host, "")
    check_exposure(host, "key")


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1"])
def test_listening_on_this_machine_needs_no_key(host: str) -> None:
    check_exposure(host, None)


async def test_a_port_in_use_is_refused_naming_its_setting() -> None:
    async with serving() as port:
        with pytest.raises(InvalidInput, match=f"mapper: port {port} .* is taken.*OVIP_MAPPER_PORT"):
            async with serving(port=port):
                pass


# Background work


async def test_background_work_that_fails_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    _no_waiting(monkeypatch)
    runs = []
    done = asyncio.Event()

    async def work() -> None:
        runs.append(len(runs))
        if len(runs) == 1:
            raise Unavailable("the store is away")
        if len(runs) == 2:
            raise ValueError("a bug")
        done.set()

    async with background("test", work):
        await asyncio.wait_for(done.wait(), 5)

    assert runs == [0, 1, 2]


async def test_background_work_ends_with_its_block() -> None:
    ended = asyncio.Event()

    async def work() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            ended.set()

    async with background("test", work):
        await asyncio.sleep(0)

    assert ended.is_set()


def _no_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    sleep = asyncio.sleep

    async def at_once(seconds: float) -> None:
        await sleep(0)

    monkeypatch.setattr("ovip.serving.asyncio.sleep", at_once)
