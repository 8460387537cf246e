"""The client of the VLM gateway."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from ovip.clients.connection import READ_SECONDS, SLOW_SECONDS, errors, read
from ovip.scene.answers import GatewayStatus, VlmReply
from ovip.v1 import types_pb2, vlm_pb2, vlm_pb2_grpc

_PURPOSES = {
    "search": vlm_pb2.AskRequest.PURPOSE_SEARCH,
    "enumerate": vlm_pb2.AskRequest.PURPOSE_ENUMERATE,
    "group": vlm_pb2.AskRequest.PURPOSE_GROUP,
}


class VlmClient:
    """Asks the VLM gateway."""

    def __init__(self, channel: Any) -> None:
        self._stub = vlm_pb2_grpc.VlmGatewayServiceStub(channel)

    async def ask(
        self,
        purpose: str,
        prompt: str,
        images: Sequence[bytes] = (),
        schema: dict[str, Any] | None = None,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        """A reply that satisfies `schema`. images: JPEG bytes. NotConfigured where there is no upstream."""
        request = vlm_pb2.AskRequest(
            purpose=_PURPOSES[purpose],
            prompt=prompt,
            images=[types_pb2.Image(encoding=types_pb2.Image.ENCODING_JPEG, data=data) for data in images],
            json_schema=json.dumps(schema or {}),
            max_output_tokens=max_output_tokens,
            deadline_s=deadline_s,
        )
        with errors():
            reply = await self._stub.Ask(request, timeout=(deadline_s or SLOW_SECONDS) + 5.0)
        return VlmReply(
            value=json.loads(reply.json),
            cached=reply.cached,
            route=reply.route,
            prompt_tokens=reply.prompt_tokens,
            output_tokens=reply.output_tokens,
            ms=reply.milliseconds,
        )

    async def status(self) -> GatewayStatus:
        request = vlm_pb2.GetGatewayStatusRequest()
        reply = await read(lambda: self._stub.GetGatewayStatus(request, timeout=READ_SECONDS))
        return GatewayStatus(
            reply.configured, tuple(reply.routes), reply.calls, reply.cache_hits, reply.refused
        )
