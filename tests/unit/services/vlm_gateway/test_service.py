"""The gateway's use cases over real upstreams and the real store."""

from __future__ import annotations

import asyncio
import json
import random
import time
from typing import Any

import httpx
import pytest

from ovip.errors import DeadlineExceeded, Exhausted, InvalidInput, NotConfigured, Unavailable
from ovip.scene.answers import VlmReply
from ovip.store import Store
from services.vlm_gateway.adapters.admission import SharedAdmission
from services.vlm_gateway.adapters.openai_compatible import OpenAiCompatible
from services.vlm_gateway.config import UpstreamSettings
from services.vlm_gateway.domain.question import Purpose
from services.vlm_gateway.domain.retry import RetryParams
from services.vlm_gateway.service import Gateway, GatewayParams, Route
from tests.unit.services.vlm_gateway.local_upstream import KEY, Answer, LocalUpstream, picture, refuses, says

SCHEMA = json.dumps(
    {
        "type": "object",
        "properties": {"words": {"type": "array", "items": {"type": "string"}}},
        "required": ["words"],
    }
)
GOOD, BAD = {"words": ["mug"]}, {"words": [3]}
QUICK = GatewayParams(deadline_s=5.0, retry=RetryParams(attempts=3, base_s=0.02, cap_s=0.05))


def gateway(
    store: Store, client: httpx.AsyncClient, *upstreams: UpstreamSettings, params: GatewayParams = QUICK
) -> Gateway:
    routes = [
        Route(OpenAiCompatible(each, client), SharedAdmission(each, store, time.monotonic), each.timeout_s)
        for each in upstreams
    ]
    return Gateway(routes, store, params, random.Random(0), time.monotonic)


async def ask(asked: Gateway, prompt: str = "Name what you see.", **more: Any) -> VlmReply:
    purpose = more.pop("purpose", Purpose.ENUMERATE)
    return await asked.ask(purpose, prompt, more.pop("images", ()), more.pop("json_schema", SCHEMA), **more)


async def test_without_upstreams_the_setting_and_the_fallbacks_are_named(
    store: Store, client: httpx.AsyncClient
) -> None:
    asked = gateway(store, client)
    with pytest.raises(
        NotConfigured, match=r"OVIP_VLM_UPSTREAMS.*bundled vocabulary.*object-to-room.*similarity"
    ):
        await ask(asked)
    status = await asked.status()
    assert (status.configured, status.routes, status.refused) == (False, (), 1)


async def test_good_reply_comes_back_parsed_with_its_account(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    reply = await ask(gateway(store, client, upstream.settings()), images=(picture(64, 48),))
    assert (reply.value, reply.cached, reply.route) == (GOOD, False, "local")
    assert (reply.prompt_tokens, reply.output_tokens) == (40, 7) and reply.ms > 0.0


async def test_same_question_again_is_answered_from_the_cache_for_every_replica(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    one, other = gateway(store, client, upstream.settings()), gateway(store, client, upstream.settings())
    first = await ask(one, images=(picture(64, 48),))
    again = await ask(other, images=(picture(64, 48),), purpose=Purpose.SEARCH)
    different = await ask(one, images=(picture(48, 64),))
    assert (first.cached, again.cached, different.cached) == (False, True, False)
    assert again.value == GOOD and again.route == "local" and len(upstream.received) == 2
    status = await one.status()
    assert (status.calls, status.cache_hits, status.refused) == (2, 1, 0)


async def test_cache_can_be_switched_off(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    asked = gateway(store, client, upstream.settings(), params=GatewayParams(cache_ttl_s=0.0))
    assert not (await ask(asked)).cached and not (await ask(asked)).cached
    assert len(upstream.received) == 2


async def test_cached_bytes_that_cannot_be_read_are_asked_anew(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream, monkeypatch: pytest.MonkeyPatch
) -> None:
    upstream.script(says(GOOD))
    monkeypatch.setattr("services.vlm_gateway.service.fingerprint", lambda *_: "known")
    for broken in (b"\xff", b"[]", b'{"value": 1}'):
        await store.cache_put("vlm:known", broken, 60.0)
        assert not (await ask(gateway(store, client, upstream.settings()))).cached
    assert len(upstream.received) == 3


async def test_identical_questions_in_flight_are_asked_once(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD, delay_s=0.1))
    asked = gateway(store, client, upstream.settings())
    replies = await asyncio.gather(*(ask(asked) for _ in range(8)))
    assert all(reply.value == GOOD for reply in replies) and len(upstream.received) == 1


async def test_reply_off_the_schema_gets_one_repair(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(BAD), says(GOOD))
    reply = await ask(gateway(store, client, upstream.settings()))
    assert reply.value == GOOD and (reply.prompt_tokens, reply.output_tokens) == (80, 14)
    repair = upstream.received[1].body["messages"]
    assert (
        repair[1]["content"] == json.dumps(BAD)
        and "$.words[0]: 3 is not of type 'string'" in repair[2]["content"]
    )


async def test_prose_is_repaired_like_any_other_violation(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says("I see a mug."), says(GOOD))
    assert (await ask(gateway(store, client, upstream.settings()))).value == GOOD


async def test_second_bad_reply_ends_the_route_with_its_reason(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(BAD))
    with pytest.raises(Unavailable, match=r"local: off the schema after one repair: at \$.words\[0\]"):
        await ask(gateway(store, client, upstream.settings()))
    assert len(upstream.received) == 2


async def test_bad_replies_are_not_remembered(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(BAD), says(BAD), says(GOOD))
    asked = gateway(store, client, upstream.settings())
    with pytest.raises(Unavailable):
        await ask(asked)
    assert (await ask(asked)).value == GOOD


async def test_passing_fault_is_tried_again(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(refuses(500), refuses(503), says(GOOD))
    assert (await ask(gateway(store, client, upstream.settings()))).value == GOOD
    assert len(upstream.received) == 3


async def test_retries_end(store: Store, client: httpx.AsyncClient, upstream: LocalUpstream) -> None:
    upstream.script(refuses(500, "boom"))
    with pytest.raises(Unavailable, match="local: HTTP 500: boom"):
        await ask(gateway(store, client, upstream.settings()))
    assert len(upstream.received) == QUICK.retry.attempts


async def test_retry_after_is_honoured_for_every_question_of_the_route(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(refuses(429, "slow down", {"Retry-After": "0.5"}), says(GOOD))
    asked = gateway(store, client, upstream.settings())

    async def another() -> VlmReply:
        await asyncio.sleep(0.1)
        return await ask(asked, "And what is that?")

    await asyncio.gather(ask(asked), another())
    first, *later = (request.at for request in upstream.received)
    assert len(later) == 2 and min(later) - first >= 0.5


async def test_retry_after_beyond_the_deadline_is_not_waited_for(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(refuses(429, "slow down", {"Retry-After": "60"}))
    began = time.monotonic()
    with pytest.raises(Unavailable, match="HTTP 429"):
        await ask(gateway(store, client, upstream.settings()))
    assert time.monotonic() - began < 50.0 and len(upstream.received) == 1


@pytest.mark.parametrize(
    "answer",
    [
        refuses(500),
        refuses(401),
        refuses(429, "", {"Retry-After": "3600"}),
        Answer(body=b"garbage"),
        Answer(body=b"x" * 3_000_000),
        says(BAD),
        says(None),
        says('{"wo', finish="length"),
    ],
)
async def test_next_upstream_answers_whatever_is_wrong_with_the_first(
    store: Store,
    client: httpx.AsyncClient,
    upstream: LocalUpstream,
    second_upstream: LocalUpstream,
    answer: Answer,
) -> None:
    upstream.script(answer)
    second_upstream.script(says(GOOD))
    asked = gateway(store, client, upstream.settings(), second_upstream.settings(name="second"))
    reply = await ask(asked)
    assert (reply.value, reply.route) == (GOOD, "second")


async def test_slow_upstream_leaves_the_next_its_share_of_the_time(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream, second_upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD, delay_s=120.0))
    second_upstream.script(says(GOOD))
    asked = gateway(store, client, upstream.settings(), second_upstream.settings(name="second"))
    began = time.monotonic()
    assert (await ask(asked, deadline_s=4.0)).route == "second"
    assert 1.6 <= time.monotonic() - began < 60.0


async def test_all_upstreams_reasons_are_told(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream, second_upstream: LocalUpstream
) -> None:
    upstream.script(refuses(401))
    second_upstream.script(Answer(body=b"garbage"))
    asked = gateway(store, client, upstream.settings(), second_upstream.settings(name="second"))
    with pytest.raises(
        Unavailable, match=r"local: it refuses the key \(HTTP 401\); second: its reply is not a chat"
    ):
        await ask(asked)


async def test_deadline_holds_over_slow_upstreams(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD, delay_s=120.0))
    began = time.monotonic()
    with pytest.raises(DeadlineExceeded, match="local: no reply within"):
        await ask(gateway(store, client, upstream.settings()), deadline_s=0.4)
    assert time.monotonic() - began < 60.0


async def test_used_up_limits_say_when_to_try_again(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    asked = gateway(store, client, upstream.settings(requests_per_minute=1))
    await ask(asked)
    with pytest.raises(Exhausted, match=r"try again in about (59|60) s"):
        await ask(asked, "And what is that?")
    assert len(upstream.received) == 1


async def test_used_up_route_gives_way_to_the_next(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream, second_upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    second_upstream.script(says(GOOD))
    asked = gateway(
        store, client, upstream.settings(requests_per_minute=1), second_upstream.settings(name="second")
    )
    assert [(await ask(asked, f"{n}?")).route for n in range(3)] == ["local", "second", "second"]


async def test_question_that_never_fits_a_limit_says_so(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD))
    with pytest.raises(Unavailable, match="its limit is 500 a minute"):
        await ask(gateway(store, client, upstream.settings(tokens_per_minute=500)))
    assert not upstream.received


async def test_no_more_calls_at_once_than_the_route_takes(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD, delay_s=0.05))
    asked = gateway(store, client, upstream.settings(max_concurrent=2))
    await asyncio.gather(*(ask(asked, f"{n}?") for n in range(8)))
    assert len(upstream.received) == 8 and upstream.most_at_once <= 2


async def test_caller_who_leaves_stops_the_call_and_frees_its_place(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    upstream.script(says(GOOD, delay_s=120.0), says(GOOD))
    asked = gateway(store, client, upstream.settings(max_concurrent=1))
    leaving = asyncio.create_task(ask(asked))
    await asyncio.sleep(0.2)
    leaving.cancel()
    began = time.monotonic()
    assert (await ask(asked, "And what is that?")).value == GOOD
    assert time.monotonic() - began < 60.0


@pytest.mark.parametrize("deadline", [-1.0, float("nan"), float("inf"), 601.0])
async def test_impossible_deadline_is_refused(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream, deadline: float
) -> None:
    with pytest.raises(InvalidInput, match="deadline_s"):
        await ask(gateway(store, client, upstream.settings()), deadline_s=deadline)


async def test_bad_question_is_refused_before_it_is_asked(
    store: Store, client: httpx.AsyncClient, upstream: LocalUpstream
) -> None:
    asked = gateway(store, client, upstream.settings())
    for wrong in ({"json_schema": "{"}, {"images": (b"",)}, {"prompt": ""}, {"max_output_tokens": 10**6}):
        with pytest.raises(InvalidInput):
            await ask(asked, **wrong)
    assert not upstream.received and (await asked.status()).refused == 4


async def test_key_shows_in_no_log_and_no_error(
    store: Store,
    client: httpx.AsyncClient,
    upstream: LocalUpstream,
    capfd: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("DEBUG")
    upstream.script(refuses(400, f"what is {KEY}?"))
    asked = gateway(store, client, upstream.settings())
    with pytest.raises(Unavailable) as caught:
        await ask(asked)
    captured = capfd.readouterr()
    assert KEY not in str(caught.value) + captured.out + captured.err + caplog.text
