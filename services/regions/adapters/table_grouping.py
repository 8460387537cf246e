"""Grouping by the function table: no VLM, and perception only for words that it lacks (SPEC 6)."""

from __future__ import annotations

import asyncio

import numpy as np

from ovip.errors import OvipError
from ovip.scene.types import F32, F64
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.functions import borrow_priors, functions_of, table_words, unlisted
from services.regions.ports import Grouping, TextEncoder

_WORDS_AT_ONCE = 128
_MOST_NAMED = 10


class TableGrouper:
    """Looks words up; a word that the table lacks is embedded once and borrows from its nearest words."""

    def __init__(self, encoder: TextEncoder) -> None:
        self._encoder = encoder
        self._table_features: F32 | None = None
        self._borrowed: dict[str, F64] = {}
        self._asked: set[str] = set()

    async def group(self, objects: PlacedObjects) -> Grouping:
        fallbacks = await self._learn(unlisted(objects.labels))
        functions = await asyncio.to_thread(
            functions_of, objects.labels, objects.centres[:, :2], self._borrowed
        )
        return Grouping(functions, fallbacks)

    async def _learn(self, words: tuple[str, ...]) -> tuple[str, ...]:
        new = tuple(word for word in words if word not in self._asked)
        if not new:
            return ()
        try:
            if self._table_features is None:
                self._table_features = await self._embed(table_words())
            features = await self._embed(new)
        except OvipError as error:
            return (f"grouping: words outside the table left open ({_named(new)}): {error}",)
        self._borrowed.update(borrow_priors(new, features, table_words(), self._table_features))
        self._asked.update(new)
        return ()

    async def _embed(self, words: tuple[str, ...]) -> F32:
        parts = [words[k : k + _WORDS_AT_ONCE] for k in range(0, len(words), _WORDS_AT_ONCE)]
        return np.concatenate([await self._encoder.embed_text(part) for part in parts])


def _named(words: tuple[str, ...]) -> str:
    more = f" and {len(words) - _MOST_NAMED} more" if len(words) > _MOST_NAMED else ""
    return ", ".join(words[:_MOST_NAMED]) + more
