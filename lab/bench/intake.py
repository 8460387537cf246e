"""`python -m lab.bench.intake`: perception's front door on a store of its own, with nothing behind it.

The same server, checks, blobs and log as in a stack; frames become durable and are not looked at.
"""

from __future__ import annotations

import asyncio
import json

from ovip.clients import VlmClient, connect
from ovip.serving import grpc_server, until_told
from ovip.store import Store
from ovip.telemetry import configure_logging
from ovip.v1 import perception_pb2, perception_pb2_grpc
from services.perception.adapters.model_sets import open_models
from services.perception.config import Settings
from services.perception.detecting import Detecting
from services.perception.domain.lifting import LiftParams
from services.perception.server import PerceptionServicer
from services.perception.service import Perception

_NO_BACKLOG_LIMIT = 10**9


async def run() -> None:
    """Says its address as one JSON line, then serves until told to stop."""
    settings = Settings().model_copy(update={"max_backlog": _NO_BACKLOG_LIMIT, "api_key": None})
    configure_logging(settings.log_level, settings.log_json)
    gateway = connect(settings.vlm_gateway_address, None)
    models = await asyncio.to_thread(open_models, settings, VlmClient(gateway))
    store = await Store.connect(settings)
    servicer = PerceptionServicer(Perception(store, Detecting(models, LiftParams()), settings))
    name = perception_pb2.DESCRIPTOR.services_by_name["PerceptionService"].full_name

    def register(server: object) -> None:
        perception_pb2_grpc.add_PerceptionServiceServicer_to_server(servicer, server)

    try:
        async with grpc_server("intake", name, register, "127.0.0.1", 0, None) as port:
            print(json.dumps({"address": f"127.0.0.1:{port}"}), flush=True)
            await until_told()
    finally:
        await store.close()
        await gateway.close()


if __name__ == "__main__":
    asyncio.run(run())
