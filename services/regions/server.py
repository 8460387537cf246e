"""The gRPC face of regions: decodes, calls, encodes."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

import grpc

from ovip import codec
from ovip.v1 import regions_pb2 as pb
from ovip.v1 import regions_pb2_grpc
from services.regions.service import Regions

SERVICE_NAME = pb.DESCRIPTOR.services_by_name["RegionsService"].full_name


class RegionsServicer(regions_pb2_grpc.RegionsServiceServicer):
    """Translates between messages and `Regions`."""

    def __init__(self, regions: Regions) -> None:
        self._regions = regions

    async def GetRegions(self, request: pb.GetRegionsRequest, context: Any) -> pb.GetRegionsResponse:
        return pb.GetRegionsResponse(
            partition=codec.partition_message(await self._regions.partition(request.scene))
        )

    async def Recompute(self, request: pb.RecomputeRequest, context: Any) -> pb.RecomputeResponse:
        return pb.RecomputeResponse(
            partition=codec.partition_message(await self._regions.recompute(request.scene))
        )

    async def WatchRegions(
        self, request: pb.WatchRegionsRequest, context: Any
    ) -> AsyncIterator[pb.WatchRegionsResponse]:
        async for partition in self._regions.watch(request.scene, request.after_revision):
            yield pb.WatchRegionsResponse(partition=codec.partition_message(partition))

    async def GetFloorGrid(self, request: pb.GetFloorGridRequest, context: Any) -> pb.GetFloorGridResponse:
        return codec.floor_grid_message(
            await self._regions.floor_grid(request.scene, request.floor, request.robot_radius)
        )

    async def PlanRoute(self, request: pb.PlanRouteRequest, context: Any) -> pb.PlanRouteResponse:
        ends = codec.vector_value(request.start), codec.vector_value(request.goal)
        return codec.route_message(await self._regions.route(request.scene, *ends, request.robot_radius))

    async def GetRouteGraph(self, request: pb.GetRouteGraphRequest, context: Any) -> pb.GetRouteGraphResponse:
        return codec.route_graph_message(await self._regions.route_graph(request.scene, request.robot_radius))


def register(regions: Regions, server: grpc.aio.Server) -> None:
    """Puts regions on a server."""
    regions_pb2_grpc.add_RegionsServiceServicer_to_server(RegionsServicer(regions), server)  # type: ignore[no-untyped-call]
