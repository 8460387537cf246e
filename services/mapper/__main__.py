"""Wires the mapper and runs it."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator

from ovip.serving import background, grpc_server, run_alone
from ovip.stages import follow_scenes
from ovip.store import Store
from ovip.v1 import mapper_pb2, mapper_pb2_grpc
from services.mapper.adapters.alignment import IcpAligner
from services.mapper.config import Settings
from services.mapper.server import MapperServicer
from services.mapper.service import STAGE, Mapper


@contextlib.asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:
    """The mapper, running; yields its port."""
    mapper = Mapper(
        store,
        settings.map_params(),
        settings.snapshot_every,
        settings.settle_after_s,
        aligner=IcpAligner(),
    )
    name = mapper_pb2.DESCRIPTOR.services_by_name["MapperService"].full_name
    async with (
        background("mapper worker", lambda: follow_scenes(store, STAGE, mapper.follow)),
        grpc_server(
            "mapper",
            name,
            lambda server: mapper_pb2_grpc.add_MapperServiceServicer_to_server(
                MapperServicer(mapper), server
            ),
            settings.host,
            settings.port,
            settings.api_key,
        ) as port,
    ):
        yield port


if __name__ == "__main__":
    run_alone("mapper", Settings, serve)
