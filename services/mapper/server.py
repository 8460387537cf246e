"""The gRPC face of the mapper: decodes, calls, encodes."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

import numpy as np

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

    async def GetMap(self, request: pb.GetMapRequest, context: Any) -> pb.GetMapResponse:
        return codec.map_message(await self._mapper.get_map(request.scene, request.include_unconfirmed))

    async def GetObject(self, request: pb.GetObjectRequest, context: Any) -> pb.GetObjectResponse:
        found, version = await self._mapper.get_object(request.scene, request.object_id)
        return pb.GetObjectResponse(object=codec.object_message(found), version=version)

    async def GetObjectPoints(
        self, request: pb.GetObjectPointsRequest, context: Any
    ) -> pb.GetObjectPointsResponse:
        version, clouds = await self._mapper.get_points(request.scene, request.object_ids, request.max_points)
        return pb.GetObjectPointsResponse(
            version=version,
            objects=[
                pb.ObjectPoints(
                    object_id=object_id,
                    points=codec.floats(points),
                    colors=np.ascontiguousarray(colors).tobytes(),
                )
                for object_id, (points, colors) in clouds.items()
            ],
        )

    async def WatchMap(self, request: pb.WatchMapRequest, context: Any) -> AsyncIterator[pb.WatchMapResponse]:
        async for delta in self._mapper.watch(request.scene, request.after_version):
            yield pb.WatchMapResponse(delta=codec.delta_message(delta))
