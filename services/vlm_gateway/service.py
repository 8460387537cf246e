"""Asking a VLM: remember, share, admit, call, check, repair, fall back (SPEC section 5)."""

from __future__ import annotations

import asyncio
import json
import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ovip.errors import (
    DeadlineExceeded,
    Exhausted,
    InvalidInput,
    NotConfigured,
    OvipError,
    TooLarge,
    Unavailable,
)
from ovip.scene.answers import GatewayStatus, VlmReply
from ovip.store import Store
from ovip.telemetry import get_logger
from services.vlm_gateway import metrics
from services.vlm_gateway.domain.priority import share_of
from services.vlm_gateway.domain.question import Purpose, Question, fingerprint
from services.vlm_gateway.domain.retry import RetryParams, retry_delay
from services.vlm_gateway.domain.schema import Schema, check_reply, repair_prompt
from services.vlm_gateway.domain.tokens import estimate_tokens
from services.vlm_gateway.flights import Flights
from services.vlm_gateway.ports import Admission, Completion, Correction, Failure, Upstream

MAX_DEADLINE_S = 600.0
MAX_OUTPUT_TOKENS = 32_768
NOT_CONFIGURED = (
    "no VLM is configured: set OVIP_VLM_UPSTREAMS to a JSON list of OpenAI-compatible endpoints. Until then "
    "perception names objects from the encoder's bundled vocabulary, regions groups them by the bundled "
    "object-to-room table, retrieval confirms crops by encoder similarity and says so in its fallbacks"
)
_CALLS, _CACHE_HITS, _REFUSED = "vlm_gateway:calls", "vlm_gateway:cache_hits", "vlm_gateway:refused"
log = get_logger("vlm_gateway")


@dataclass(frozen=True, slots=True)
class Route:
    """An upstream behind its limits. timeout_s: the longest one call may take."""

    upstream: Upstream
    admission: Admission
    timeout_s: float


@dataclass(frozen=True, slots=True)
class GatewayParams:
    """deadline_s, max_output_tokens: what a caller gets who names none. cache_ttl_s: 0 keeps no replies."""

    deadline_s: float = 60.0
    max_output_tokens: int = 1024
    cache_ttl_s: float = 7 * 86400.0
    retry: RetryParams = field(default_factory=RetryParams)


class Gateway:
    """The only way out to a VLM: `ask` a question, get JSON that satisfies its schema, or say why not.

    clock: monotonic seconds. rng: jitters the retries.
    """

    def __init__(
        self,
        routes: Sequence[Route],
        store: Store,
        params: GatewayParams,
        rng: random.Random,
        clock: Callable[[], float],
    ) -> None:
        self._routes = tuple(routes)
        self._store = store
        self._params = params
        self._rng = rng
        self._clock = clock
        self._flights: Flights[VlmReply] = Flights(clock)

    async def ask(
        self,
        purpose: Purpose,
        prompt: str,
        images: Sequence[bytes],
        json_schema: str,
        max_output_tokens: int = 0,
        deadline_s: float = 0.0,
    ) -> VlmReply:
        """The reply of the first upstream that gives a good one, from the cache where it was asked before.

        Zeros stand for the gateway's defaults. Raises NotConfigured, InvalidInput, and where no upstream
        answered Exhausted (every limit is used up), DeadlineExceeded or Unavailable with each one's reason.
        """
        began = self._clock()
        try:
            until = began + self._seconds(deadline_s)
            question = self._question(prompt, images, json_schema, max_output_tokens)
            reply = await self._answer(purpose, question, until)
        except OvipError as error:
            await self._count_refused(purpose, error)
            raise
        metrics.QUESTIONS.labels(purpose.value, "cached" if reply.cached else "answered").inc()
        return replace(reply, ms=1000.0 * (self._clock() - began))

    async def status(self) -> GatewayStatus:
        """What all replicas together have done, and the routes of this one."""
        counted = await self._store.counters([_CALLS, _CACHE_HITS, _REFUSED])
        return GatewayStatus(
            configured=bool(self._routes),
            routes=tuple(route.upstream.name for route in self._routes),
            calls=int(counted[_CALLS]),
            cache_hits=int(counted[_CACHE_HITS]),
            refused=int(counted[_REFUSED]),
        )

    async def _answer(self, purpose: Purpose, question: Question, until: float) -> VlmReply:
        if not self._routes:
            raise NotConfigured(NOT_CONFIGURED)
        key = fingerprint(question, ((route.upstream.name, route.upstream.model) for route in self._routes))
        known = await self._recall(key)
        if known is not None:
            await self._count(_CACHE_HITS)
            return known
        return await self._flights.share(
            f"{purpose}:{key}", until, lambda: self._ask_and_remember(key, purpose, question, until)
        )

    async def _ask_and_remember(
        self, key: str, purpose: Purpose, question: Question, until: float
    ) -> VlmReply:
        reply = await self._ask_routes(purpose, question, until)
        await self._remember(key, reply)
        return reply

    async def _ask_routes(self, purpose: Purpose, question: Question, until: float) -> VlmReply:
        """Each route in turn, with its share of the time left, so that a slow one cannot starve the next."""
        failures: list[tuple[str, Failure]] = []
        for number, route in enumerate(self._routes):
            now = self._clock()
            share = share_of(until - now, len(self._routes) - number)
            outcome = await self._ask_route(route, purpose, question, now + share)
            if isinstance(outcome, VlmReply):
                return outcome
            failures.append((route.upstream.name, outcome))
            log.warning(
                "route_failed", route=route.upstream.name, purpose=purpose.value, reason=outcome.reason
            )
        raise _refusal(failures, late=self._clock() >= until)

    async def _ask_route(
        self, route: Route, purpose: Purpose, question: Question, until: float
    ) -> VlmReply | Failure:
        """Calls one upstream until it gives a good reply: jittered retries, one repair."""
        correction: Correction | None = None
        spent = (0, 0)
        calls = 0
        while True:
            outcome = await self._call(route, purpose, question, correction, until)
            calls += 1
            if isinstance(outcome, Completion):
                spent = (spent[0] + outcome.prompt_tokens, spent[1] + outcome.output_tokens)
                checked = await asyncio.to_thread(check_reply, outcome.text, question.schema)
                if not checked.violations:
                    return VlmReply(checked.value, False, route.upstream.name, *spent)
                if correction is not None:
                    return Failure(
                        f"off the schema after one repair: {'; '.join(checked.violations)[:300]}", "schema"
                    )
                correction = Correction(outcome.text, repair_prompt(checked.violations, question.schema))
                continue
            if not await self._may_retry(route, outcome, calls, until):
                return outcome

    async def _call(
        self, route: Route, purpose: Purpose, question: Question, correction: Correction | None, until: float
    ) -> Completion | Failure:
        """One call, once the route's limits admit it."""
        refused = await self._admit(route, purpose, question, until)
        if refused is not None:
            return refused
        began = self._clock()
        try:
            timeout = max(0.0, min(route.timeout_s, until - began))
            outcome = await route.upstream.complete(question, correction, timeout)
        finally:
            route.admission.leave()
        await self._count_call(route, outcome, self._clock() - began)
        return outcome

    async def _admit(
        self, route: Route, purpose: Purpose, question: Question, until: float
    ) -> Failure | None:
        began = self._clock()
        tokens = estimate_tokens(question, route.upstream.image_max_side)
        waiting = metrics.WAITING.labels(route.upstream.name)
        waiting.inc()
        try:
            wait = await route.admission.enter(purpose, tokens, until)
        except TooLarge as error:
            return Failure(str(error), "too_large")
        finally:
            waiting.dec()
        metrics.WAIT_SECONDS.labels(purpose.value).observe(self._clock() - began)
        if wait == 0.0:
            return None
        return Failure(
            f"its limits are used up; room in about {math.ceil(wait)} s", "exhausted", retry_after=wait
        )

    async def _may_retry(self, route: Route, failure: Failure, calls: int, until: float) -> bool:
        """Waits as long as the failure asks for; False where that helps nothing or takes too long."""
        if not failure.retryable:
            return False
        if failure.retry_after:
            route.admission.pause(failure.retry_after)
        delay = retry_delay(calls, failure.retry_after, until - self._clock(), self._rng, self._params.retry)
        if delay is None:
            return False
        await asyncio.sleep(delay)
        return True

    async def _recall(self, key: str) -> VlmReply | None:
        """The remembered reply; one that cannot be read counts as none."""
        data = await self._store.cache_get(f"vlm:{key}")
        if data is None:
            return None
        try:
            kept = json.loads(data)
            return VlmReply(kept["value"], True, kept["route"], kept["prompt_tokens"], kept["output_tokens"])
        except (ValueError, KeyError, TypeError):
            log.warning("cached_reply_unreadable", key=key)
            return None

    async def _remember(self, key: str, reply: VlmReply) -> None:
        if self._params.cache_ttl_s <= 0:
            return
        kept = {
            "value": reply.value,
            "route": reply.route,
            "prompt_tokens": reply.prompt_tokens,
            "output_tokens": reply.output_tokens,
        }
        await self._store.cache_put(f"vlm:{key}", json.dumps(kept).encode(), self._params.cache_ttl_s)

    async def _count_call(self, route: Route, outcome: Completion | Failure, seconds: float) -> None:
        name = route.upstream.name
        metrics.CALLS.labels(name, outcome.kind if isinstance(outcome, Failure) else "replied").inc()
        metrics.CALL_SECONDS.labels(name).observe(seconds)
        if isinstance(outcome, Completion):
            metrics.TOKENS.labels(name, "prompt").inc(outcome.prompt_tokens)
            metrics.TOKENS.labels(name, "output").inc(outcome.output_tokens)
        await self._count(_CALLS)

    async def _count_refused(self, purpose: Purpose, error: OvipError) -> None:
        metrics.QUESTIONS.labels(purpose.value, error.slug).inc()
        await self._count(_REFUSED)

    async def _count(self, name: str) -> None:
        """Adds one to a statistic; no answer fails because it could not be counted."""
        try:
            await self._store.counter_add(name, 1)
        except Unavailable as error:
            log.warning("not_counted", counter=name, reason=str(error))

    def _seconds(self, deadline_s: float) -> float:
        seconds = deadline_s or self._params.deadline_s
        if not 0.0 < seconds <= MAX_DEADLINE_S:
            raise InvalidInput(
                f"deadline_s: expected 0 (the default) to {MAX_DEADLINE_S:g} seconds, got {deadline_s:g}"
            )
        return seconds

    def _question(
        self, prompt: str, images: Sequence[bytes], json_schema: str, max_output_tokens: int
    ) -> Question:
        if max_output_tokens > MAX_OUTPUT_TOKENS:
            raise InvalidInput(f"max_output_tokens: at most {MAX_OUTPUT_TOKENS}, got {max_output_tokens}")
        return Question.build(
            prompt, images, Schema.parse(json_schema), max_output_tokens or self._params.max_output_tokens
        )


def _refusal(failures: Sequence[tuple[str, Failure]], late: bool) -> OvipError:
    """The error that all routes' failures together amount to."""
    reasons = "; ".join(f"{name}: {failure.reason}" for name, failure in failures)
    waits: list[Any] = [failure.retry_after for _, failure in failures if failure.kind == "exhausted"]
    if len(waits) == len(failures):
        return Exhausted(f"try again in about {math.ceil(min(waits))} s ({reasons})")
    if late:
        return DeadlineExceeded(f"the deadline passed before a VLM answered ({reasons})")
    return Unavailable(f"no VLM answered ({reasons})")
