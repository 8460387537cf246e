"""The mapper's gRPC face over a stand-in that notes what it is asked and answers with known values."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Sequence
from typing import Any, cast

import grpc
import numpy as np

from ovip.clients import MapperClient, connect
from ovip.errors import Conflict, NotFound
from ovip.scene.answers import SceneSummary
from ovip.scene.edits import EditRequest
from ovip.scene.types import F32, F64, U8, MapDelta, MapObject, SceneMap, StepKind
from ovip.scene.versions import Alignment, MapDiff, ObjectChange, Verification
from ovip.serving import grpc_server
from ovip.v1 import mapper_pb2, mapper_pb2_grpc
from services.mapper.server import MapperServicer
from services.mapper.service import Mapper
from tests.builders import pose
from tests.unit.ovip.map_objects import map_object, scene_map

NAME = mapper_pb2.DESCRIPTOR.services_by_name["MapperService"].full_name
KITCHEN = scene_map(3, 4)
TRANSFORM = pose(1, 2, 0, 0.4)
EDITED = MapDelta(8, "", StepKind.EDIT, updated=("o000001",))
JOINED = MapDelta(9, "", StepKind.JOIN, created=("o000003",))
DIFF = MapDiff(3, 7, (ObjectChange("o1", None, map_object("o1", feature=np.zeros(0, np.float32))),))


class Recorded:
    """Stands where the mapper stands: notes what it is asked, and answers with known values."""

    def __init__(self) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.map = KITCHEN
        self.difference = DIFF
        self.verification = Verification(7, "ab", "ab", 2, (), 70)
        self.alignment = Alignment(TRANSFORM, 0.75, 0.0125)

    async def list_scenes(self) -> list[SceneSummary]:
        return [SceneSummary("kitchen", 7, 3, 60, 600)]

    async def get_map(
        self,
        scene: str,
        include_unconfirmed: bool = False,
        at_version: int = 0,
        include_departed: bool = False,
    ) -> SceneMap:
        self.asked.append((scene, include_unconfirmed, at_version, include_departed))
        return self.map

    async def get_object(self, scene: str, object_id: str) -> tuple[MapObject, int]:
        if object_id == "o000077":
            raise NotFound(f"object {object_id!r} is not in scene {scene} at version 7")
        return map_object(object_id), 7

    async def get_points(
        self, scene: str, object_ids: Sequence[str], max_points: int
    ) -> tuple[int, dict[str, tuple[F32, U8]]]:
        self.asked.append((scene, tuple(object_ids), max_points))
        xyz = np.arange(3 * 200_000, dtype=np.float32).reshape(-1, 3)
        return 7, {
            "o000001": (xyz, np.full(xyz.shape, 9, np.uint8)),
            "o000002": (xyz[:0], np.zeros((0, 3), np.uint8)),
        }

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        self.asked.append((scene, after_version))
        yield EDITED
        yield JOINED

    async def diff(self, scene: str, from_version: int, to_version: int = 0) -> MapDiff:
        self.asked.append((scene, from_version, to_version))
        return self.difference

    async def verify(self, scene: str) -> Verification:
        return self.verification

    async def edit(self, scene: str, request: EditRequest) -> MapDelta:
        self.asked.append((scene, request))
        if request.made_on_version < 7:
            raise Conflict("o000001 has changed at version 7; made on version 3")
        return EDITED

    async def join(
        self, scene: str, other_scene: str, world_from_other: F64, edit_id: str
    ) -> tuple[MapDelta, dict[str, str]]:
        self.asked.append((scene, other_scene, world_from_other, edit_id))
        return JOINED, {"o000001": "o000003"}

    async def align(self, scene: str, other_scene: str, guess: F64 | None) -> Alignment:
        self.asked.append((scene, other_scene, guess))
        return self.alignment


@contextlib.asynccontextmanager
async def mapper_port(mapper: Recorded) -> AsyncIterator[int]:
    """A running server; yields its port."""

    def register(server: grpc.aio.Server) -> None:
        mapper_pb2_grpc.add_MapperServiceServicer_to_server(MapperServicer(cast(Mapper, mapper)), server)

    async with grpc_server("mapper", NAME, register, "127.0.0.1", 0, None) as port:
        yield port


@contextlib.asynccontextmanager
async def served(mapper: Recorded) -> AsyncIterator[tuple[MapperClient, Any]]:
    """The client, and the bare channel."""
    async with mapper_port(mapper) as port:
        channel = connect(f"127.0.0.1:{port}")
        try:
            yield MapperClient(channel), channel
        finally:
            await channel.close()
