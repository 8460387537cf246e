"""Wires perception and runs it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

from ovip.clients import VlmClient, connect
from ovip.scene.words import normalize_word
from ovip.serving import background, grpc_server, run_alone
from ovip.stages import follow_scenes
from ovip.store import Store
from ovip.v1 import perception_pb2, perception_pb2_grpc
from services.perception.adapters.model_sets import open_models
from services.perception.config import Settings
from services.perception.detecting import Detecting
from services.perception.domain.gate import DEFAULT_BLACKLIST, GateParams
from services.perception.domain.lifting import LiftParams
from services.perception.history import STAGE, FrameHistory
from services.perception.server import PerceptionServicer
from services.perception.service import Perception
from services.perception.worker import PerceptionWorker


@contextlib.asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:
    """Perception, running; yields its port."""
    gateway = connect(settings.vlm_gateway_address, settings.api_key)
    models = await asyncio.to_thread(open_models, settings, VlmClient(gateway))
    lift = LiftParams(min_confidence=settings.min_confidence, max_depth=settings.max_depth)
    detecting = Detecting(models, lift)
    extra = frozenset(filter(None, map(normalize_word, settings.gate_blacklist.split(","))))
    gate = GateParams(settings.gate_n_min, DEFAULT_BLACKLIST | extra)
    history = FrameHistory(store)
    worker = PerceptionWorker(store, detecting, gate, history)
    servicer = PerceptionServicer(Perception(store, detecting, settings, history))
    name = perception_pb2.DESCRIPTOR.services_by_name["PerceptionService"].full_name
    async with (
        background("perception worker", lambda: follow_scenes(store, STAGE, worker.follow)),
        grpc_server(
            "perception",
            name,
            lambda server: perception_pb2_grpc.add_PerceptionServiceServicer_to_server(servicer, server),
            settings.host,
            settings.port,
            settings.api_key,
        ) as port,
    ):
        yield port
    await gateway.close()


if __name__ == "__main__":
    run_alone("perception", Settings, serve)
