"""The other services through their gRPC clients."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping
from typing import Any

from ovip.clients import MapperClient, PerceptionClient, RegionsClient, RetrievalClient, VlmClient, connect
from services.api.config import Settings
from services.api.ports import Backends


@contextlib.asynccontextmanager
async def connected(settings: Settings) -> AsyncIterator[Backends]:
    """Clients of all services at the addresses of the settings; their channels close at the end."""
    addresses = {
        "perception": settings.perception_address,
        "mapper": settings.mapper_address,
        "regions": settings.regions_address,
        "retrieval": settings.retrieval_address,
        "vlm_gateway": settings.vlm_gateway_address,
    }
    channels = {name: connect(address, settings.api_key) for name, address in addresses.items()}
    mapper = MapperClient(channels["mapper"])
    try:
        yield Backends(
            frames=PerceptionClient(channels["perception"]),
            objects=mapper,
            map_log=mapper,
            regions=RegionsClient(channels["regions"]),
            searches=RetrievalClient(channels["retrieval"]),
            gateway=VlmClient(channels["vlm_gateway"]),
            readiness=_Channels(channels, settings.api_ready_timeout_s),
        )
    finally:
        await asyncio.gather(*(channel.close() for channel in channels.values()))


class _Channels:
    """A service counts as reachable when its channel connects in time."""

    def __init__(self, channels: Mapping[str, Any], timeout_s: float) -> None:
        self._channels = channels
        self._timeout_s = timeout_s

    async def reachable(self) -> Mapping[str, bool]:
        states = await asyncio.gather(*(self._connects(channel) for channel in self._channels.values()))
        return dict(zip(self._channels, states, strict=True))

    async def _connects(self, channel: Any) -> bool:
        try:
            await asyncio.wait_for(channel.channel_ready(), self._timeout_s)
        except TimeoutError:
            return False
        return True
