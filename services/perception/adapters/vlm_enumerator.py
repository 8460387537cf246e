"""Enumeration by a VLM through the gateway (E2G, SPEC 1.1)."""

from __future__ import annotations

import asyncio
import time

import cv2

from ovip.clients import VlmClient
from ovip.errors import DeadlineExceeded, Exhausted, NotConfigured, Unavailable
from ovip.scene.types import U8, Frame
from ovip.scene.words import normalize_word
from ovip.telemetry import get_logger
from services.perception.ports import Enumerator

PROMPT = (
    "List every type of object visible in this indoor image, small and attached things too (switches, wall plugs, "
    "handles, vases, pictures). Use short common nouns in the singular, one entry a type, no colours, no counts, no "
    "rooms, no abstract words."
)
SCHEMA = {
    "type": "object",
    "properties": {
        "objects": {"type": "array", "items": {"type": "string", "maxLength": 60}, "maxItems": 100}
    },
    "required": ["objects"],
    "additionalProperties": False,
}
_ASK_AGAIN_SECONDS = 60.0
log = get_logger("perception")


class VlmEnumerator:
    """Asks the VLM; where none answers, the fallback names what it can (SPEC 6), or, without one, the error goes on."""

    def __init__(self, vlm: VlmClient, fallback: Enumerator | None) -> None:
        self._vlm = vlm
        self._fallback = fallback
        self._silent_until = 0.0

    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        if self._fallback and time.monotonic() < self._silent_until:
            return await self._fallback.enumerate(frame)
        try:
            image = await asyncio.to_thread(_jpeg, frame.rgb)
            reply = await self._vlm.ask("enumerate", PROMPT, [image], SCHEMA, max_output_tokens=800)
        except (NotConfigured, Unavailable, Exhausted, DeadlineExceeded) as error:
            if self._fallback is None:
                raise
            log.info("enumerator_fallback", reason=str(error))
            self._silent_until = time.monotonic() + _ASK_AGAIN_SECONDS
            return await self._fallback.enumerate(frame)
        assert isinstance(reply.value, dict)  # the gateway checked it against SCHEMA
        words = (normalize_word(word) for word in reply.value["objects"])
        return tuple(sorted({word for word in words if word}))


def _jpeg(rgb: U8) -> bytes:
    _, data = cv2.imencode(".jpg", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, 90])
    return data.tobytes()
