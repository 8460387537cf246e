"""Wires retrieval: `python -m services.retrieval`."""

from __future__ import annotations

import contextlib
import functools
import time
from collections.abc import AsyncIterator

from ovip.clients import MapperClient, PerceptionClient, RegionsClient, VlmClient, connect
from ovip.ids import uuid7
from ovip.serving import grpc_server, run_alone
from ovip.store import Store
from services.retrieval.adapters.crops import OpenCvCrops
from services.retrieval.adapters.searches import StoredSearches
from services.retrieval.case import Limits
from services.retrieval.config import Settings
from services.retrieval.domain.schedule import ScheduleParams
from services.retrieval.domain.viewpoints import ViewpointParams
from services.retrieval.evidence import FrameHistory, Sources, TextSpace
from services.retrieval.opening import Desk
from services.retrieval.server import SERVICE_NAME, register
from services.retrieval.service import Retrieval


@contextlib.asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:
    """Retrieval answering on its port until the block ends; yields the bound port."""
    async with contextlib.AsyncExitStack() as channels:
        mapper, perception, regions, gateway = [
            await channels.enter_async_context(connect(address, settings.api_key))
            for address in (
                settings.mapper_address,
                settings.perception_address,
                settings.regions_address,
                settings.vlm_gateway_address,
            )
        ]
        seen = PerceptionClient(perception)
        sources = Sources(MapperClient(mapper), seen, seen, RegionsClient(regions))
        retrieval = build(settings, store, sources, VlmClient(gateway))
        async with grpc_server(
            "retrieval",
            SERVICE_NAME,
            functools.partial(register, retrieval),
            settings.host,
            settings.port,
            settings.api_key,
        ) as port:
            yield port


def build(settings: Settings, store: Store, sources: Sources, vlm: VlmClient) -> Retrieval:
    """The use cases over their sources, with the numbers of the settings."""
    limits = Limits(
        history_frames=settings.retrieval_history_frames,
        ground_batch=settings.retrieval_ground_batch,
        viewpoints=settings.retrieval_max_viewpoints,
        radius=settings.retrieval_robot_radius,
        detection_rate=settings.retrieval_detection_rate,
        schedule=ScheduleParams(balance=settings.retrieval_balance),
        viewpoint=ViewpointParams(reach=settings.retrieval_reach),
    )
    desk = Desk(
        sources=sources,
        scenes=store,
        vlm=vlm,
        crops=OpenCvCrops(),
        limits=limits,
        max_vlm_calls=settings.retrieval_max_vlm_calls,
        text_space=TextSpace(sources.grounder),
        history=FrameHistory(sources.frames),
    )
    searches = StoredSearches(store, settings.retrieval_keep_answers_s)
    return Retrieval(desk, searches, time.perf_counter, uuid7)


if __name__ == "__main__":
    run_alone("retrieval", Settings, serve)
