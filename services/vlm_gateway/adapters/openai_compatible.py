"""An upstream that speaks OpenAI's chat completions: Kimi, Qwen, GPT, vLLM, llama.cpp and their like."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

import httpx
from pydantic import BaseModel, Field, ValidationError

from services.vlm_gateway.adapters.images import data_url
from services.vlm_gateway.config import JsonMode, UpstreamSettings
from services.vlm_gateway.domain.question import Question
from services.vlm_gateway.domain.retry import parse_retry_after
from services.vlm_gateway.domain.schema import instruction, quoted
from services.vlm_gateway.ports import Completion, Correction, Failure

MAX_REPLY_BYTES = 1 << 20
MAX_ERROR_BYTES = 1 << 14
MAX_EXCERPT = 200
MAX_TOKENS_TOLD = 2**31
_PASSING = frozenset({408, 409, 425, 429})
_KEY_REFUSED = frozenset({401, 403})


class OpenAiCompatible:
    """One endpoint's `POST {base_url}/chat/completions`.

    Nothing the endpoint sends can raise: a status, a broken, huge or slow body each become a Failure. The key
    goes into the request's header and nowhere else; redirects are not followed, so that it goes nowhere else.
    """

    def __init__(
        self,
        settings: UpstreamSettings,
        client: httpx.AsyncClient,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        self.name = settings.name
        self.model = settings.model
        self.image_max_side = settings.image_max_side
        self._settings = settings
        self._client = client
        self._now = now

    async def complete(
        self, question: Question, correction: Correction | None, timeout_s: float
    ) -> Completion | Failure:
        """Asks once; raises InvalidInput only where an image of the question cannot be decoded."""
        try:
            async with asyncio.timeout(timeout_s):
                body = await asyncio.to_thread(self._body, question, correction)
                return await self._post(body, timeout_s)
        except TimeoutError:
            return Failure(f"no reply within {timeout_s:.1f} s", "timeout", retryable=True)
        except (httpx.HTTPError, httpx.StreamError) as error:
            return Failure(
                self._clean(f"cannot be reached: {type(error).__name__} {error}"), "network", retryable=True
            )

    async def _post(self, body: bytes, timeout_s: float) -> Completion | Failure:
        request = self._client.build_request(
            "POST",
            f"{self._settings.base_url}/chat/completions",
            content=body,
            headers=self._headers(),
            timeout=httpx.Timeout(timeout_s, connect=min(10.0, timeout_s)),
        )
        response = await self._client.send(request, stream=True, follow_redirects=False)
        try:
            if response.status_code != 200:
                return await self._refusal(response)
            raw = await _read(response, MAX_REPLY_BYTES)
        finally:
            await response.aclose()
        return raw if isinstance(raw, Failure) else self._completion(raw)

    def _headers(self) -> dict[str, str]:
        # identity: a compressed body could unpack to any size
        headers = {
            "Content-Type": "application/json",
            "Accept": "application/json",
            "Accept-Encoding": "identity",
        }
        if self._settings.api_key is not None:
            headers["Authorization"] = f"Bearer {self._settings.api_key.get_secret_value()}"
        return headers

    def _body(self, question: Question, correction: Correction | None) -> bytes:
        body: dict[str, Any] = {
            "model": self.model,
            "messages": self._messages(question, correction),
            self._settings.max_tokens_field: question.max_output_tokens,
        }
        if self._settings.json_mode is JsonMode.SCHEMA:
            body["response_format"] = {
                "type": "json_schema",
                "json_schema": {"name": "reply", "schema": question.schema.document},
            }
        elif self._settings.json_mode is JsonMode.OBJECT:
            body["response_format"] = {"type": "json_object"}
        return json.dumps({**body, **self._settings.extra_body}).encode()

    def _messages(self, question: Question, correction: Correction | None) -> list[dict[str, Any]]:
        words = question.prompt
        if self._settings.json_mode is not JsonMode.SCHEMA:
            words = f"{words}\n\n{instruction(question.schema)}"
        parts: list[dict[str, Any]] = [{"type": "text", "text": words}]
        for image in question.images:
            parts.append({"type": "image_url", "image_url": {"url": data_url(image, self.image_max_side)}})
        messages: list[dict[str, Any]] = [{"role": "user", "content": parts if question.images else words}]
        if correction is not None:
            messages.append({"role": "assistant", "content": quoted(correction.reply)})
            messages.append({"role": "user", "content": correction.request})
        return messages

    def _completion(self, raw: bytes) -> Completion | Failure:
        try:
            reply = _Reply.model_validate_json(raw)
        except ValidationError:
            return Failure("its reply is not a chat completion", "garbage")
        choice = reply.choices[0]
        if choice.finish_reason == "length":
            return Failure("its reply was cut short; ask for more with max_output_tokens", "truncated")
        if choice.message.refusal or choice.finish_reason == "content_filter":
            return Failure(self._clean(f"it declined to answer: {choice.message.refusal or ''}"), "declined")
        return Completion(
            choice.message.text(),
            _told(reply.usage, "prompt_tokens"),
            _told(reply.usage, "completion_tokens"),
        )

    async def _refusal(self, response: httpx.Response) -> Failure:
        status = response.status_code
        if status in _KEY_REFUSED:
            return Failure(f"it refuses the key (HTTP {status})", "key")
        if 300 <= status < 400:
            return Failure(
                f"it redirects elsewhere (HTTP {status}); set base_url to the final address", "redirect"
            )
        retry_after = parse_retry_after(response.headers.get("retry-after"), self._now())
        raw = await _read(response, MAX_ERROR_BYTES)
        said = "" if isinstance(raw, Failure) else _error_message(raw)
        reason = self._clean(f"HTTP {status}: {said}" if said else f"HTTP {status}")
        retryable = status in _PASSING or status >= 500
        return Failure(reason, f"http_{status}", retryable, retry_after if retryable else None)

    def _clean(self, text: str) -> str:
        """Text from outside as it may be logged and returned: printable, short, without the key."""
        if self._settings.api_key is not None:
            text = text.replace(self._settings.api_key.get_secret_value(), "***")
        return "".join(char if char.isprintable() else " " for char in text)[:MAX_EXCERPT].strip().rstrip(":")


class _Part(BaseModel):
    type: str = ""
    text: str = ""


class _Message(BaseModel):
    content: str | list[_Part] | None = None
    refusal: str | None = None

    def text(self) -> str:
        if isinstance(self.content, list):
            return "".join(part.text for part in self.content if part.type in ("text", "output_text"))
        return self.content or ""


class _Choice(BaseModel):
    message: _Message
    finish_reason: str | None = None


class _Reply(BaseModel):
    choices: list[_Choice] = Field(min_length=1)
    usage: Any = None


async def _read(response: httpx.Response, limit: int) -> bytes | Failure:
    """The body, never more than `limit` bytes of it."""
    if response.headers.get("content-encoding", "identity").lower() != "identity":
        return Failure("its reply is compressed although that was not asked for", "garbage")
    body = bytearray()
    async for chunk in response.aiter_raw():
        body += chunk
        if len(body) > limit:
            return Failure(f"its reply is larger than {limit} bytes", "too_large")
    return bytes(body)


def _told(usage: object, name: str) -> int:
    """A token count as the upstream tells it; 0 where it tells none that can be true."""
    count = usage.get(name) if isinstance(usage, dict) else None
    return count if isinstance(count, int) and 0 <= count < MAX_TOKENS_TOLD else 0


def _error_message(raw: bytes) -> str:
    """The `error.message` of an error body; empty where it has none."""
    try:
        body = json.loads(raw)
    except (ValueError, RecursionError):
        return ""
    error = body.get("error") if isinstance(body, dict) else None
    message = error.get("message") if isinstance(error, dict) else error
    return message if isinstance(message, str) else ""
