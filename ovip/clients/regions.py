"""The client of regions."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

from ovip import codec
from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, errors, read
from ovip.scene.grid import FloorGrid
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import F64, Partition
from ovip.v1 import regions_pb2, regions_pb2_grpc


class RegionsClient:
    """Reads the partition of a scene and its navigation grids, and asks for ways."""

    def __init__(self, channel: Any) -> None:
        self._stub = regions_pb2_grpc.RegionsServiceStub(channel)

    async def get_partition(self, scene: str) -> Partition:
        """The newest partition; revision 0 and no regions before the first."""
        request = regions_pb2.GetRegionsRequest(scene=scene)
        reply = await read(lambda: self._stub.GetRegions(request, timeout=READ_SECONDS))
        return codec.partition_value(reply.partition)

    async def recompute(self, scene: str) -> Partition:
        request = regions_pb2.RecomputeRequest(scene=scene)
        reply = await read(lambda: self._stub.Recompute(request, timeout=SLOW_SECONDS))
        return codec.partition_value(reply.partition)

    async def watch(self, scene: str, after_revision: int = 0) -> AsyncIterator[Partition]:
        """The newest partition above a revision, then each new one, until the caller stops."""
        request = regions_pb2.WatchRegionsRequest(scene=scene, after_revision=after_revision)
        with errors():
            async for reply in self._stub.WatchRegions(request):
                yield codec.partition_value(reply.partition)

    async def get_floor_grid(self, scene: str, floor: int, robot_radius: float = 0.0) -> FloorGrid:
        """A storey's grid; above radius 0 (metres), free cells where such a robot does not fit are occupied."""
        request = regions_pb2.GetFloorGridRequest(scene=scene, floor=floor, robot_radius=robot_radius)
        return codec.floor_grid_value(
            await read(lambda: self._stub.GetFloorGrid(request, timeout=READ_SECONDS))
        )

    async def plan_route(self, scene: str, start: F64, goal: F64, robot_radius: float = 0.0) -> Route:
        """The shortest way between two points `(3,)`, world metres; robot_radius 0: the service's own setting.

        Where there is no way `why` says so.
        """
        request = regions_pb2.PlanRouteRequest(
            scene=scene,
            start=codec.vector_message(start),
            goal=codec.vector_message(goal),
            robot_radius=robot_radius,
        )
        return codec.route_value(await read(lambda: self._stub.PlanRoute(request, timeout=SLOW_SECONDS)))

    async def get_route_graph(self, scene: str, robot_radius: float = 0.0) -> RouteGraph:
        """The passages of the building and the walks between them; robot_radius 0: the service's own setting."""
        request = regions_pb2.GetRouteGraphRequest(scene=scene, robot_radius=robot_radius)
        return codec.route_graph_value(
            await read(lambda: self._stub.GetRouteGraph(request, timeout=SLOW_SECONDS))
        )
