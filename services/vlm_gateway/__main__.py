"""Wires the VLM gateway: `python -m services.vlm_gateway`."""

from __future__ import annotations

import contextlib
import functools
import random
import time
from collections.abc import AsyncIterator

import httpx

from ovip.serving import grpc_server, run_alone
from ovip.store import Store
from services.vlm_gateway.adapters.admission import SharedAdmission
from services.vlm_gateway.adapters.openai_compatible import OpenAiCompatible
from services.vlm_gateway.config import Settings, UpstreamSettings
from services.vlm_gateway.domain.retry import RetryParams
from services.vlm_gateway.server import SERVICE_NAME, register
from services.vlm_gateway.service import Gateway, GatewayParams, Route


@contextlib.asynccontextmanager
async def serve(settings: Settings, store: Store) -> AsyncIterator[int]:
    """The gateway answering on its port until the block ends; yields the bound port."""
    async with httpx.AsyncClient() as client:
        gateway = build_gateway(settings, store, client)
        async with grpc_server(
            "vlm_gateway",
            SERVICE_NAME,
            functools.partial(register, gateway),
            settings.host,
            settings.port,
            settings.api_key,
        ) as port:
            yield port


def build_gateway(settings: Settings, store: Store, client: httpx.AsyncClient) -> Gateway:
    """The gateway over its configured upstreams, each behind limits shared through the store."""
    params = GatewayParams(
        deadline_s=settings.vlm_deadline_s,
        max_output_tokens=settings.vlm_max_output_tokens,
        cache_ttl_s=settings.vlm_cache_ttl_s,
        retry=RetryParams(attempts=settings.vlm_attempts),
    )
    routes = [_route(upstream, store, client) for upstream in settings.vlm_upstreams]
    return Gateway(routes, store, params, random.Random(settings.vlm_jitter_seed), time.monotonic)


def _route(upstream: UpstreamSettings, store: Store, client: httpx.AsyncClient) -> Route:
    return Route(
        OpenAiCompatible(upstream, client),
        SharedAdmission(upstream, store, time.monotonic),
        upstream.timeout_s,
    )


if __name__ == "__main__":
    run_alone("vlm_gateway", Settings, serve)
