"""What the gateway counts for Prometheus, by route and outcome; never by content."""

from __future__ import annotations

from prometheus_client import Counter, Gauge, Histogram

CALLS = Counter("ovip_vlm_gateway_calls_total", "Calls to an upstream", ["route", "outcome"])
QUESTIONS = Counter("ovip_vlm_gateway_questions_total", "Questions by how they ended", ["purpose", "outcome"])
TOKENS = Counter("ovip_vlm_gateway_tokens_total", "Tokens as the upstream told them", ["route", "direction"])
CALL_SECONDS = Histogram(
    "ovip_vlm_gateway_call_seconds",
    "Time of one upstream call",
    ["route"],
    buckets=(0.1, 0.3, 1, 3, 10, 30, 60, 120),
)
WAIT_SECONDS = Histogram(
    "ovip_vlm_gateway_wait_seconds",
    "Time until a question was admitted",
    ["purpose"],
    buckets=(0.01, 0.1, 1, 5, 15, 60),
)
WAITING = Gauge("ovip_vlm_gateway_waiting_questions", "Questions waiting for an upstream's limits", ["route"])
