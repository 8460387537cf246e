"""What an answer of tier 1 costs in process, over maps of growing size (DESIGN 7: p99 <= 5 ms at 10,000)."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lab.bench.rows import Row, spread
from lab.bench.synthetic import SCENE, SIDE, NoVlm, SyntheticScene, synthetic_floor, synthetic_map
from ovip import codec
from ovip.config import KernelSettings
from ovip.scene.answers import Answer, Query
from ovip.store import Store
from services.perception.adapters import model_cache
from services.perception.adapters.embedded.minilm import MiniLm
from services.perception.adapters.full.naming import indoor_vocabulary
from services.perception.config import Settings as PerceptionSettings
from services.retrieval.__main__ import build
from services.retrieval.config import Settings
from services.retrieval.evidence import Sources
from services.retrieval.service import Retrieval

SIZES = (100, 1_000, 10_000)
_ASKED = 60  # words that one object each is called; the others share the rest of the vocabulary


async def measure_tier1(sizes: Sequence[int] = SIZES, rounds: int = 3) -> list[Row]:
    """Asks for each of up to 60 single objects by name, `rounds` times, after one round that is not counted.

    tier: what tier 1 itself took. answer: the whole of it, with standoff pose, path over a 12 x 12 m floor,
    and the answer stored. map_read: decoding the map as it comes over the wire, which every question pays.
    """
    texts = MiniLm(model_cache.require(PerceptionSettings().models_dir))
    with tempfile.TemporaryDirectory() as folder:
        store = await Store.connect(KernelSettings(data_dir=Path(folder), redis_url=None))
        try:
            await store.add_scene(SCENE)
            return [await _measure(store, texts, size, rounds) for size in sizes]
        finally:
            await store.close()


async def _measure(store: Store, texts: MiniLm, size: int, rounds: int) -> Row:
    labels = _labels(size)
    scene_map = synthetic_map(labels, await texts.embed(labels))
    scene = SyntheticScene(scene_map, synthetic_floor(), texts.embed)
    sources = Sources(scene, scene, scene, scene)
    retrieval = build(Settings(), store, sources, NoVlm())  # type: ignore[arg-type]
    words = labels[:_ASKED]
    for word in words:
        await _ask(retrieval, word)
    tier, answer = [], []
    for _ in range(rounds):
        for word in words:
            began = time.perf_counter()
            found = await _ask(retrieval, word)
            answer.append((time.perf_counter() - began) * 1e3)
            tier.append(found.tiers[0].ms)
    return {
        "objects": size,
        "answers": len(answer),
        **spread(tier, "tier"),
        **spread(answer, "answer"),
        "map_read_ms": round(_map_read_ms(scene), 2),
    }


async def _ask(retrieval: Retrieval, word: str) -> Answer:
    pose = np.eye(4)
    pose[:3, 3] = (SIDE / 2, SIDE / 2, 1.2)
    events = [event async for _, event in retrieval.find(Query(SCENE, word, robot_pose=pose, max_tier=1))]
    answer = events[-1]
    assert isinstance(answer, Answer)
    return answer


def _labels(size: int) -> list[str]:
    words = indoor_vocabulary().words
    shared = words[_ASKED:]
    return [*words[: min(_ASKED, size)], *(shared[i % len(shared)] for i in range(size - _ASKED))]


def _map_read_ms(scene: SyntheticScene) -> float:
    parts = list(codec.map_parts(scene.scene_map))
    began = time.perf_counter()
    codec.map_value(parts)
    return (time.perf_counter() - began) * 1e3
