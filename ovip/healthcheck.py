"""Asks a service whether it is well: `python -m ovip.healthcheck HOST:PORT | URL`; exit status 0 where it is."""

from __future__ import annotations

import sys

import grpc
import httpx
from grpc_health.v1 import health_pb2, health_pb2_grpc

_SECONDS = 3.0


def is_well(target: str) -> bool:
    """Whether the gRPC service at `host:port`, or the page at an http URL, answers that it is serving."""
    if target.startswith("http"):
        try:
            return httpx.get(target, timeout=_SECONDS, trust_env=False).is_success
        except httpx.HTTPError:
            return False
    with grpc.insecure_channel(target, options=[("grpc.enable_http_proxy", 0)]) as channel:
        try:
            reply = health_pb2_grpc.HealthStub(channel).Check(
                health_pb2.HealthCheckRequest(), timeout=_SECONDS
            )
        except grpc.RpcError:
            return False
    return bool(reply.status == health_pb2.HealthCheckResponse.SERVING)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit("usage: python -m ovip.healthcheck HOST:PORT | URL")
    raise SystemExit(0 if is_well(sys.argv[1]) else 1)
