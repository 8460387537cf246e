"""Grouping by the table: strange words are embedded once, and left open while perception is away."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np

from ovip.scene.features import normalize
from ovip.scene.types import F32
from services.regions.adapters.table_grouping import TableGrouper
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.functions import table_words
from tests.unit.services.regions.homes import NoEncoder


class Encoder:
    """Gives each word a direction of its own, and "loo" that of "toilet"."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    async def embed_text(self, texts: Sequence[str]) -> F32:
        assert len(texts) <= 512
        self.asked += texts
        words = ["toilet" if text == "loo" else text for text in texts]
        rows = [np.random.default_rng(zlib.crc32(word.encode())).standard_normal(256) for word in words]
        return normalize(np.array(rows, np.float32))


def things(*labels: str) -> PlacedObjects:
    return PlacedObjects(
        tuple(f"o{number}" for number in range(len(labels))),
        labels,
        np.arange(3.0 * len(labels)).reshape(-1, 3) * 9,
    )


async def test_words_of_the_table_need_no_encoder() -> None:
    grouping = await TableGrouper(NoEncoder()).group(things("bed", "stove"))
    assert grouping.functions == ("bedroom", "kitchen")
    assert grouping.fallbacks == ()


async def test_a_strange_word_borrows_and_is_embedded_once() -> None:
    encoder = Encoder()
    grouper = TableGrouper(encoder)
    for _ in range(2):
        assert (await grouper.group(things("loo"))).functions == ("bathroom",)
    assert len(encoder.asked) == len(table_words()) + 1


async def test_while_perception_is_away_strange_words_are_left_open_and_asked_again() -> None:
    grouper = TableGrouper(NoEncoder())
    for _ in range(2):
        grouping = await grouper.group(things("loo", "bed"))
        assert grouping.functions == ("unknown", "bedroom")
        assert "loo" in grouping.fallbacks[0]
