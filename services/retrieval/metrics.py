"""Metrics of retrieval."""

from __future__ import annotations

from prometheus_client import Counter, Histogram

ANSWERS = Counter(
    "ovip_retrieval_answers_total", "Answers given, by outcome and deciding tier.", ["outcome", "tier"]
)
TIER_SECONDS = Histogram(
    "ovip_retrieval_tier_seconds",
    "Time that a tier took.",
    ["tier"],
    buckets=(0.002, 0.005, 0.01, 0.05, 0.2, 1.0, 5.0, 20.0, 60.0, 180.0),
)
