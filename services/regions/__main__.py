"""Wires regions and runs it: `python -m services.regions`."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import AsyncIterator

from ovip.clients import MapperClient, PerceptionClient, VlmClient, connect
from ovip.serving import background, grpc_server, run_alone
from ovip.stages import follow_scenes
from ovip.store import Store
from services.regions.adapters.table_grouping import TableGrouper
from services.regions.adapters.vlm_grouping import VlmGrouper
from services.regions.config import Settings
from services.regions.follower import RegionsFollower
from services.regions.partitioner import CutParams
from services.regions.server import SERVICE_NAME, register
from services.regions.service import Regions
from services.regions.shelf import STAGE


@contextlib.asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:
    """Regions, following every scene and answering until the block ends; yields the bound port."""
    async with (
        connect(settings.mapper_address, settings.api_key) as mapper,
        connect(settings.perception_address, settings.api_key) as perception,
        connect(settings.vlm_gateway_address, settings.api_key) as gateway,
    ):
        follower = RegionsFollower(
            store,
            MapperClient(mapper),
            (
                VlmGrouper(VlmClient(gateway), settings.regions_vlm_deadline_s),
                TableGrouper(PerceptionClient(perception)),
            ),
            settings.pace,
            CutParams(settings.partition, settings.staleness),
            settings.regions_checkpoint_frames,
        )
        regions = Regions(
            store, settings.regions_recompute_timeout_s, robot_radius=settings.regions_robot_radius
        )
        async with (
            background("regions follower", lambda: follow_scenes(store, STAGE, follower.follow)),
            grpc_server(
                "regions",
                SERVICE_NAME,
                functools.partial(register, regions),
                settings.host,
                settings.port,
                settings.api_key,
            ) as port,
        ):
            yield port


if __name__ == "__main__":
    run_alone("regions", Settings, serve)
