"""The mapper's gRPC face, called by the real client: every call reaches the mapper as it was meant, and back."""

from __future__ import annotations

from typing import Any

import grpc
import numpy as np
import pytest

from ovip.errors import Conflict, InvalidInput
from ovip.scene.answers import SceneSummary
from ovip.scene.edits import Delete, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.versions import Alignment, Verification
from ovip.v1 import mapper_pb2, mapper_pb2_grpc
from tests.builders import same
from tests.unit.ovip.map_objects import map_object
from tests.unit.services.mapper.recorded import DIFF, EDITED, JOINED, KITCHEN, TRANSFORM, Recorded, served


async def test_a_map_is_asked_for_as_it_stands_without_what_departed_unless_told() -> None:
    mapper = Recorded()
    async with served(mapper) as (client, _):
        assert same(await client.get_map("kitchen"), KITCHEN)
        await client.get_map("kitchen", include_unconfirmed=True, at_version=5, include_departed=True)

    assert mapper.asked == [("kitchen", False, 0, False), ("kitchen", True, 5, True)]


async def test_points_come_in_parts_and_are_whole_again() -> None:
    mapper = Recorded()
    async with served(mapper) as (client, channel):
        clouds = await client.get_points("kitchen", ["o000001", "o000002"], 300_000)
        stub = mapper_pb2_grpc.MapperServiceStub(channel)
        request = mapper_pb2.GetObjectPointsRequest(scene="kitchen")
        parts = [part async for part in stub.GetObjectPoints(request)]

    assert list(clouds) == ["o000001", "o000002"]
    assert clouds["o000001"][0].ravel().tolist() == list(range(600_000))
    assert clouds["o000002"][0].shape == (0, 3)
    assert len(parts) > 2
    assert mapper.asked[0] == ("kitchen", ("o000001", "o000002"), 300_000)


async def test_scenes_objects_deltas_differences_and_proofs_arrive_as_they_are() -> None:
    mapper = Recorded()
    async with served(mapper) as (client, _):
        assert await client.list_scenes() == [SceneSummary("kitchen", 7, 3, 60, 600)]
        assert same(await client.get_object("kitchen", "o000001"), map_object("o000001"))
        assert [delta async for delta in client.watch("kitchen", 7)] == [EDITED, JOINED]
        assert same(await client.diff("kitchen", 3), DIFF)
        assert same(await client.diff("kitchen", 3, 5), DIFF)
        assert await client.verify("kitchen") == Verification(7, "ab", "ab", 2, (), 70)

    assert mapper.asked == [("kitchen", 7), ("kitchen", 3, 0), ("kitchen", 3, 5)]


EDITS = (
    Rename("o000001", "mug"),
    Merge("o000001", ("o000002",)),
    Split("o000001", np.arange(6.0), "lid"),
    Delete("o000001"),
    Pin("o000001", pinned=False),
)


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: type(edit).__name__)
async def test_an_edit_arrives_with_its_id_its_version_and_its_operator(edit: Any) -> None:
    mapper, request = Recorded(), EditRequest("e1", 7, "ada", edit)
    async with served(mapper) as (client, _):
        assert await client.edit("kitchen", request) == EDITED

    ((scene, arrived),) = mapper.asked
    assert scene == "kitchen"
    assert same(arrived, request)


async def test_an_edit_made_on_an_older_map_is_a_conflict_in_the_mappers_words() -> None:
    async with served(Recorded()) as (client, channel):
        with pytest.raises(Conflict, match="has changed at version 7; made on version 3"):
            await client.edit("kitchen", EditRequest("e1", 3, "ada", Delete("o000001")))
        stub = mapper_pb2_grpc.MapperServiceStub(channel)
        with pytest.raises(grpc.aio.AioRpcError) as refused:
            await stub.EditMap(mapper_pb2.EditMapRequest(scene="kitchen", rename=mapper_pb2.RenameEdit()))

    assert refused.value.code() is grpc.StatusCode.ABORTED


async def test_a_request_without_an_edit_is_refused_before_it_reaches_the_mapper() -> None:
    mapper = Recorded()
    async with served(mapper) as (_, channel):
        stub = mapper_pb2_grpc.MapperServiceStub(channel)
        with pytest.raises(grpc.aio.AioRpcError) as refused:
            await stub.EditMap(mapper_pb2.EditMapRequest(scene="kitchen", edit_id="e1"))

    assert refused.value.code() is grpc.StatusCode.INVALID_ARGUMENT
    assert mapper.asked == []


async def test_maps_are_joined_and_aligned_by_transforms_that_arrive_exactly() -> None:
    mapper = Recorded()
    async with served(mapper) as (client, _):
        assert await client.join("kitchen", "attic", TRANSFORM, "j1") == (JOINED, {"o000001": "o000003"})
        assert same(await client.align("kitchen", "attic"), Alignment(TRANSFORM, 0.75, 0.0125))
        await client.align("kitchen", "attic", TRANSFORM)
        with pytest.raises(InvalidInput, match="world_from_other: expected 16 numbers .* got 9"):
            await client.join("kitchen", "attic", np.eye(3), "j2")

    assert same(
        mapper.asked,
        [("kitchen", "attic", TRANSFORM, "j1"), ("kitchen", "attic", None), ("kitchen", "attic", TRANSFORM)],
    )
