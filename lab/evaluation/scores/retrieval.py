"""Retrieval success rate: some of the k best places lies within d of an instance that was meant (RSR@d, top-k)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64

TOPS = (1, 5)
DISTANCES = (1.0, 2.0, 3.0)
"""Metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Ranked:
    """What was answered to one question. query: names it, its scene included.

    places: `(K, 3)` metres, best first. meant: `(N, 3)` centres of the instances that answer it. others: `(M, 3)`
    centres of their like that do not; a place nearer to one of those than to any meant one names the wrong instance.
    """

    query: str
    places: F64
    meant: F64
    others: F64


def misses(ranked: Ranked) -> F64:
    """Metres from each place to the nearest instance that was meant -> `(K,)`; infinite where none is."""
    return _nearest(ranked.places, ranked.meant)


def misses_of_instance(ranked: Ranked) -> F64:
    """The same, but infinite for a place that lies nearer to one of the others -> `(K,)`. A tie is a hit."""
    own = misses(ranked)
    return np.where(own <= _nearest(ranked.places, ranked.others), own, np.inf)


def success_rates(missed: Sequence[tuple[str, F64]]) -> dict[str, float]:
    """`rsr_top1_1m` .. `rsr_top5_3m` from each question's name and its places' misses `(K,)`, best place first.

    A question asked again does not count again. No questions: all 0.
    """
    first: dict[str, F64] = {}
    for query, distances in missed:
        first.setdefault(query, distances)
    return {
        f"rsr_top{k}_{d:g}m": _share([bool((distances[:k] <= d).any()) for distances in first.values()])
        for k in TOPS
        for d in DISTANCES
    }


def _nearest(places: F64, centres: F64) -> F64:
    if not len(centres):
        return np.full(len(places), np.inf)
    apart: F64 = np.linalg.norm(places[:, None, :] - centres[None, :, :], axis=2).min(axis=1)
    return apart


def _share(hits: Sequence[bool]) -> float:
    return float(np.mean(hits)) if hits else 0.0
