from __future__ import annotations

import functools
from collections.abc import AsyncIterator

import grpc
import numpy as np
import pytest
import pytest_asyncio

from ovip.clients import RetrievalClient, connect
from ovip.errors import InvalidInput, NotFound
from ovip.scene.answers import Answer, Observation, Outcome, Query, SearchEvent, Viewpoint
from ovip.serving import grpc_server
from ovip.store import Store
from ovip.v1 import retrieval_pb2, retrieval_pb2_grpc
from services.retrieval.server import SERVICE_NAME, register
from tests.unit.services.retrieval.builders import pose_at
from tests.unit.services.retrieval.test_service import START, Robot, build, kettle_world, kitchen


@pytest_asyncio.fixture
async def channel(store: Store) -> AsyncIterator[grpc.aio.Channel]:
    await store.add_scene("home")
    serving = functools.partial(register, build(store, kitchen()))
    async with (
        grpc_server("retrieval", SERVICE_NAME, serving, "127.0.0.1", 0, None) as port,
        connect(f"127.0.0.1:{port}") as channel,
    ):
        yield channel


async def test_an_answer_crosses_the_wire_whole(channel: grpc.aio.Channel) -> None:
    client = RetrievalClient(channel)
    pairs = [pair async for pair in client.find(Query("home", "white mug", pose_at(5.0, 1.0, 0.0)))]
    search_id, answer = pairs[-1]
    assert isinstance(answer, Answer)
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    assert answer.object.object_id == "cup2"
    assert answer.goal is not None
    np.testing.assert_allclose(answer.path[-1], answer.goal.position)
    text, done, again = await client.get_search("home", search_id)
    assert (text, done) == ("white mug", True)
    assert again.object.object_id == "cup2"


async def test_errors_cross_the_wire_as_themselves(channel: grpc.aio.Channel) -> None:
    client = RetrievalClient(channel)
    with pytest.raises(InvalidInput, match="expected a thing to look for"):
        [pair async for pair in client.find(Query("home", "  "))]
    with pytest.raises(NotFound, match="nowhere"):
        [pair async for pair in client.find(Query("nowhere", "mug"))]
    with pytest.raises(NotFound):
        await client.get_search("home", "none")


async def test_a_search_with_a_robot_runs_over_one_stream(store: Store) -> None:
    await store.add_scene("home")
    world = kettle_world()
    robot = Robot(world)

    async def observe(event: SearchEvent) -> Observation | None:
        assert isinstance(event, Viewpoint)
        return robot.look(event)

    serving = functools.partial(register, build(store, world))
    async with (
        grpc_server("retrieval", SERVICE_NAME, serving, "127.0.0.1", 0, None) as port,
        connect(f"127.0.0.1:{port}") as channel,
    ):
        pairs = [pair async for pair in RetrievalClient(channel).search(START, observe)]
        search_id, answer = pairs[-1]
        assert isinstance(answer, Answer)
        assert answer.outcome is Outcome.ABSENT
        resumed = [e async for _, e in RetrievalClient(channel).search(f"home/{search_id}", observe)]
    assert [type(event) for event in resumed] == [Answer]


async def test_an_empty_message_is_refused(channel: grpc.aio.Channel) -> None:
    call = retrieval_pb2_grpc.RetrievalServiceStub(channel).Search()
    await call.write(retrieval_pb2.SearchRequest())
    with pytest.raises(grpc.aio.AioRpcError, match="expected start"):
        await call.read()
