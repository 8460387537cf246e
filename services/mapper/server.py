"""The gRPC face of the mapper: decodes, calls, encodes."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

from ovip import codec
from ovip.v1 import mapper_pb2 as pb
from ovip.v1 import mapper_pb2_grpc
from services.mapper.service import Mapper


class MapperServicer(mapper_pb2_grpc.MapperServiceServicer):
    """Translates between messages and `Mapper`."""

    def __init__(self, mapper: Mapper) -> None:
        self._mapper = mapper

    async def ListScenes(self, request: pb.ListScenesRequest, context: Any) -> pb.ListScenesResponse:
        return pb.ListScenesResponse(
            scenes=[
                pb.SceneSummary(
                    scene=s.scene,
                    map_version=s.map_version,
                    objects=s.objects,
                    frames=s.frames,
                    detections=s.detections,
                )
                for s in await self._mapper.list_scenes()
            ]
        )

    async def GetMap(self, request: pb.GetMapRequest, context: Any) -> AsyncIterator[pb.GetMapResponse]:
        scene_map = await self._mapper.get_map(
            request.scene, request.include_unconfirmed, request.at_version, request.include_departed
        )
        for part in codec.map_parts(scene_map):
            yield part

    async def GetObject(self, request: pb.GetObjectRequest, context: Any) -> pb.GetObjectResponse:
        found, version = await self._mapper.get_object(request.scene, request.object_id)
        return pb.GetObjectResponse(object=codec.object_message(found), version=version)

    async def GetObjectPoints(
        self, request: pb.GetObjectPointsRequest, context: Any
    ) -> AsyncIterator[pb.GetObjectPointsResponse]:
        version, clouds = await self._mapper.get_points(request.scene, request.object_ids, request.max_points)
        for part in codec.points_parts(version, clouds):
            yield part

    async def WatchMap(self, request: pb.WatchMapRequest, context: Any) -> AsyncIterator[pb.WatchMapResponse]:
        async for delta in self._mapper.watch(request.scene, request.after_version):
            yield pb.WatchMapResponse(delta=codec.delta_message(delta))

    async def DiffMap(self, request: pb.DiffMapRequest, context: Any) -> pb.DiffMapResponse:
        return codec.diff_message(
            await self._mapper.diff(request.scene, request.from_version, request.to_version)
        )

    async def VerifyMap(self, request: pb.VerifyMapRequest, context: Any) -> pb.VerifyMapResponse:
        return codec.verification_message(await self._mapper.verify(request.scene))

    async def EditMap(self, request: pb.EditMapRequest, context: Any) -> pb.EditMapResponse:
        delta = await self._mapper.edit(request.scene, codec.edit_request_value(request))
        return pb.EditMapResponse(delta=codec.delta_message(delta))

    async def JoinMap(self, request: pb.JoinMapRequest, context: Any) -> pb.JoinMapResponse:
        transform = codec.matrix_value(request.world_from_other, "world_from_other")
        delta, ids = await self._mapper.join(request.scene, request.other_scene, transform, request.edit_id)
        return pb.JoinMapResponse(delta=codec.delta_message(delta), ids=ids)

    async def AlignMap(self, request: pb.AlignMapRequest, context: Any) -> pb.AlignMapResponse:
        guess = codec.matrix_or_none(request.world_from_other, "world_from_other")
        return codec.alignment_message(await self._mapper.align(request.scene, request.other_scene, guess))
