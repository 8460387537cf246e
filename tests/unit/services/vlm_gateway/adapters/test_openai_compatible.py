"""The OpenAI-compatible adapter against a real HTTP upstream that behaves and misbehaves."""

from __future__ import annotations

import base64
import json
import socket
import time

import httpx
import pytest

from ovip.errors import InvalidInput
from services.vlm_gateway.adapters.openai_compatible import MAX_REPLY_BYTES, OpenAiCompatible
from services.vlm_gateway.domain.images import image_size
from services.vlm_gateway.domain.question import Question
from services.vlm_gateway.domain.schema import Schema
from services.vlm_gateway.ports import Completion, Correction, Failure
from tests.unit.services.vlm_gateway.local_upstream import KEY, Answer, LocalUpstream, picture, refuses, says

SCHEMA = Schema.parse('{"type": "object", "properties": {"words": {"type": "array"}}, "required": ["words"]}')


def question(*images: bytes) -> Question:
    return Question.build("Name what you see.", images, SCHEMA, 64)


async def call(
    upstream: LocalUpstream, client: httpx.AsyncClient, timeout_s: float = 5.0
) -> Completion | Failure:
    return await OpenAiCompatible(upstream.settings(), client).complete(question(), None, timeout_s)


async def failure(upstream: LocalUpstream, client: httpx.AsyncClient, timeout_s: float = 5.0) -> Failure:
    outcome = await call(upstream, client, timeout_s)
    assert isinstance(outcome, Failure)
    return outcome


async def test_question_goes_out_as_a_chat_completion(
    upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(says({"words": ["mug"]}))
    outcome = await OpenAiCompatible(upstream.settings(image_max_side=128), client).complete(
        question(picture(256, 192)), None, 5.0
    )
    assert outcome == Completion('{"words": ["mug"]}', 40, 7)
    (request,) = upstream.received
    assert request.path == "/v1/chat/completions"
    assert request.headers["Authorization"] == f"Bearer {KEY}"
    assert request.body["model"] == "tiny-vl" and request.body["max_tokens"] == 64
    assert request.body["response_format"]["json_schema"]["schema"] == SCHEMA.document
    text, image = request.body["messages"][0]["content"]
    assert text == {"type": "text", "text": "Name what you see."}
    url = image["image_url"]["url"]
    assert url.startswith("data:image/jpeg;base64,")


async def test_image_is_shrunk_to_the_routes_limit(
    upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(says({"words": []}))
    await OpenAiCompatible(upstream.settings(image_max_side=128), client).complete(
        question(picture(256, 192)), None, 5.0
    )
    url = upstream.received[0].body["messages"][0]["content"][1]["image_url"]["url"]
    assert image_size(base64.b64decode(url.partition(",")[2])).width == 128


@pytest.mark.parametrize(("mode", "wanted"), [("object", {"type": "json_object"}), ("prompt", None)])
async def test_without_schema_support_the_schema_goes_in_words(
    upstream: LocalUpstream, client: httpx.AsyncClient, mode: str, wanted: object
) -> None:
    upstream.script(says({"words": []}))
    await OpenAiCompatible(upstream.settings(json_mode=mode), client).complete(question(), None, 5.0)
    body = upstream.received[0].body
    assert body.get("response_format") == wanted
    assert SCHEMA.text in body["messages"][0]["content"]


async def test_settings_of_the_upstream_go_along(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says({"words": []}))
    settings = upstream.settings(max_tokens_field="max_completion_tokens", extra_body={"temperature": 0})
    await OpenAiCompatible(settings, client).complete(question(), None, 5.0)
    body = upstream.received[0].body
    assert body["max_completion_tokens"] == 64 and "max_tokens" not in body and body["temperature"] == 0


async def test_upstream_without_a_key_gets_none(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says({"words": []}))
    await OpenAiCompatible(upstream.settings(api_key=None), client).complete(question(), None, 5.0)
    assert "Authorization" not in upstream.received[0].headers


async def test_correction_quotes_the_bad_reply_and_asks_again(
    upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(says({"words": []}))
    bad = "no \ud800 JSON"
    await OpenAiCompatible(upstream.settings(), client).complete(question(), Correction(bad, "mend it"), 5.0)
    roles = [message["role"] for message in upstream.received[0].body["messages"]]
    assert roles == ["user", "assistant", "user"]
    assert upstream.received[0].body["messages"][2]["content"] == "mend it"


async def test_content_in_parts_is_joined(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    parts = [{"type": "text", "text": '{"words"'}, {"type": "text", "text": ": []}"}]
    body = {"choices": [{"message": {"content": parts}, "finish_reason": "stop"}]}
    upstream.script(Answer(body=json.dumps(body).encode()))
    assert await call(upstream, client) == Completion('{"words": []}', 0, 0)


@pytest.mark.parametrize(
    "usage", [None, 3, "many", {}, {"prompt_tokens": -1}, {"prompt_tokens": 10**12}, {"prompt_tokens": "9"}]
)
async def test_token_counts_that_cannot_be_true_count_as_none(
    upstream: LocalUpstream, client: httpx.AsyncClient, usage: object
) -> None:
    body = {"choices": [{"message": {"content": "{}"}}], "usage": usage}
    upstream.script(Answer(body=json.dumps(body).encode()))
    assert await call(upstream, client) == Completion("{}", 0, 0)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"<html>504</html>",
        b"\xff\xfe\x00garbage",
        b"[]",
        b"{}",
        b'{"choices": []}',
        b'{"choices": [{}]}',
        b'{"choices": [{"message": {"content": 7}}]}',
        b"[" * 200_000,
        b'{"choices": [{"message": {"content": "\\ud800"}}]}',
    ],
)
async def test_garbage_is_a_failure_not_a_crash(
    upstream: LocalUpstream, client: httpx.AsyncClient, body: bytes
) -> None:
    upstream.script(Answer(body=body))
    assert await failure(upstream, client) == Failure("its reply is not a chat completion", "garbage")


async def test_huge_body_is_cut_off(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(Answer(body=b"x" * (8 * MAX_REPLY_BYTES)))
    assert (await failure(upstream, client)).kind == "too_large"


async def test_huge_error_body_is_cut_off(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(Answer(500, b"x" * (8 * MAX_REPLY_BYTES)))
    assert await failure(upstream, client) == Failure("HTTP 500", "http_500", retryable=True)


async def test_compressed_body_is_refused_unread(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(Answer(body=bytes(100), headers={"Content-Encoding": "gzip"}))
    assert "compressed" in (await failure(upstream, client)).reason
    assert upstream.received[0].headers["Accept-Encoding"] == "identity"


async def test_limit_reached_carries_the_wait_asked_for(
    upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(refuses(429, "slow down", {"Retry-After": "12"}))
    assert await failure(upstream, client) == Failure("HTTP 429: slow down", "http_429", True, 12.0)


@pytest.mark.parametrize("status", [408, 500, 502, 503, 504, 529])
async def test_passing_faults_may_be_retried(
    upstream: LocalUpstream, client: httpx.AsyncClient, status: int
) -> None:
    upstream.script(refuses(status, "busy"))
    assert (await failure(upstream, client)).retryable


@pytest.mark.parametrize("status", [400, 404, 413, 422])
async def test_refused_question_is_not_retried(
    upstream: LocalUpstream, client: httpx.AsyncClient, status: int
) -> None:
    upstream.script(refuses(status, "no such model", {"Retry-After": "3"}))
    assert await failure(upstream, client) == Failure(f"HTTP {status}: no such model", f"http_{status}")


@pytest.mark.parametrize("status", [401, 403])
async def test_refused_key_says_so_without_the_key(
    upstream: LocalUpstream, client: httpx.AsyncClient, status: int
) -> None:
    upstream.script(refuses(status, f"Incorrect API key provided: {KEY}"))
    outcome = await failure(upstream, client)
    assert outcome.kind == "key" and not outcome.retryable and KEY not in repr(outcome)


async def test_key_echoed_by_the_upstream_is_struck_out(
    upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(refuses(400, f"bad header Bearer {KEY}\r\n\x1b[31m" + "y" * 900))
    reason = (await failure(upstream, client)).reason
    assert KEY not in reason and "***" in reason and "\x1b" not in reason and len(reason) <= 200


async def test_redirect_is_not_followed(
    upstream: LocalUpstream, second_upstream: LocalUpstream, client: httpx.AsyncClient
) -> None:
    upstream.script(Answer(307, b"", {"Location": f"{second_upstream.base_url}/chat/completions"}))
    second_upstream.script(says({"words": []}))
    assert (await failure(upstream, client)).kind == "redirect"
    assert not second_upstream.received


async def test_slow_upstream_is_left_in_time(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says({"words": []}, delay_s=2.0))
    began = time.monotonic()
    outcome = await failure(upstream, client, timeout_s=0.3)
    assert outcome.kind == "timeout" and outcome.retryable and time.monotonic() - began < 1.0


async def test_dripping_upstream_is_left_in_time(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says({"words": []}, drip_s=0.02))
    began = time.monotonic()
    assert (await failure(upstream, client, timeout_s=0.3)).kind == "timeout"
    assert time.monotonic() - began < 1.0


async def test_upstream_that_is_not_there_is_a_failure(client: httpx.AsyncClient) -> None:
    with socket.socket() as held:  # bound but not listening: refuses every connection
        held.bind(("127.0.0.1", 0))
        lost = LocalUpstream(held.getsockname()[1])
        outcome = await failure(lost, client)
    assert outcome.kind == "network" and outcome.retryable and "cannot be reached" in outcome.reason


async def test_cut_off_reply_says_what_to_raise(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says('{"words": ["mu', finish="length"))
    assert "max_output_tokens" in (await failure(upstream, client)).reason


async def test_refusal_of_the_model_is_told(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    body = {"choices": [{"message": {"content": None, "refusal": "I cannot look at this."}}]}
    upstream.script(Answer(body=json.dumps(body).encode()))
    assert (await failure(upstream, client)).reason == "it declined to answer: I cannot look at this."


async def test_broken_image_is_the_callers_fault(upstream: LocalUpstream, client: httpx.AsyncClient) -> None:
    upstream.script(says({"words": []}))
    image = picture(64, 48, ".png")
    broken = image[:33] + bytes(len(image) - 33 - 12) + image[-12:]
    with pytest.raises(InvalidInput, match="cannot be decoded"):
        await OpenAiCompatible(upstream.settings(), client).complete(question(broken), None, 5.0)
    assert not upstream.received
