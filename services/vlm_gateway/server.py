"""The gateway over gRPC: decode, ask, encode."""

from __future__ import annotations

import json
from typing import Any

import grpc

from ovip.errors import InvalidInput
from ovip.v1 import vlm_pb2, vlm_pb2_grpc
from services.vlm_gateway.domain.question import Purpose
from services.vlm_gateway.service import Gateway

SERVICE_NAME = vlm_pb2.DESCRIPTOR.services_by_name["VlmGatewayService"].full_name
_PURPOSES = {
    vlm_pb2.AskRequest.PURPOSE_SEARCH: Purpose.SEARCH,
    vlm_pb2.AskRequest.PURPOSE_ENUMERATE: Purpose.ENUMERATE,
    vlm_pb2.AskRequest.PURPOSE_GROUP: Purpose.GROUP,
}


class VlmGatewayServicer(vlm_pb2_grpc.VlmGatewayServiceServicer):
    """Translates between protobuf and the gateway's use cases."""

    def __init__(self, gateway: Gateway) -> None:
        self._gateway = gateway

    async def Ask(self, request: vlm_pb2.AskRequest, context: Any) -> vlm_pb2.AskResponse:
        reply = await self._gateway.ask(
            _purpose(request.purpose),
            request.prompt,
            [image.data for image in request.images],
            request.json_schema,
            request.max_output_tokens,
            request.deadline_s,
        )
        return vlm_pb2.AskResponse(
            json=json.dumps(reply.value),
            cached=reply.cached,
            route=reply.route,
            prompt_tokens=reply.prompt_tokens,
            output_tokens=reply.output_tokens,
            milliseconds=reply.ms,
        )

    async def GetGatewayStatus(
        self, request: vlm_pb2.GetGatewayStatusRequest, context: Any
    ) -> vlm_pb2.GetGatewayStatusResponse:
        status = await self._gateway.status()
        return vlm_pb2.GetGatewayStatusResponse(
            configured=status.configured,
            routes=status.routes,
            calls=status.calls,
            cache_hits=status.cache_hits,
            refused=status.refused,
        )


def register(gateway: Gateway, server: grpc.aio.Server) -> None:
    """Puts the gateway on a server."""
    vlm_pb2_grpc.add_VlmGatewayServiceServicer_to_server(VlmGatewayServicer(gateway), server)  # type: ignore[no-untyped-call]


def _purpose(value: int) -> Purpose:
    try:
        return _PURPOSES[value]  # type: ignore[index]
    except KeyError:
        raise InvalidInput("purpose: expected PURPOSE_SEARCH, PURPOSE_ENUMERATE or PURPOSE_GROUP") from None
