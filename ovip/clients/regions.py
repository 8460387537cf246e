"""The client of regions."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

from ovip import codec
from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, errors, read
from ovip.scene.grid import FloorGrid
from ovip.scene.types import Partition
from ovip.v1 import regions_pb2, regions_pb2_grpc


class RegionsClient:
    """Reads the partition of a scene and its navigation grids."""

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

    async def get_floor_grid(self, scene: str, floor: int) -> FloorGrid:
        request = regions_pb2.GetFloorGridRequest(scene=scene, floor=floor)
        return codec.floor_grid_value(
            await read(lambda: self._stub.GetFloorGrid(request, timeout=READ_SECONDS))
        )
