"""Enumeration without a VLM: the encoder's zero-shot words over a bundled indoor vocabulary (SPEC 6)."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from ovip.scene.types import F32, U8, Frame
from services.perception.domain.boxes2d import tiles

if TYPE_CHECKING:
    from services.perception.adapters.full.encoding import ClipEncoder

_TEXT = "a photo of a {}"


@dataclass(frozen=True, slots=True)
class NamingParams:
    """least_share: of the softmax over the vocabulary that a word must win in some view; most: words a view.

    Neither was chosen on data: no weights of this set could be run where it was written (docs/models.md).
    """

    least_share: float = 0.08
    most: int = 6


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """words: what may be named. distractors: what a view may show instead, never named: rooms, surfaces."""

    words: tuple[str, ...]
    distractors: tuple[str, ...]


def indoor_vocabulary() -> Vocabulary:
    """`indoor_words.txt`: a word a line; `-` before a distractor, `#` before a heading."""
    text = resources.files(__package__).joinpath("indoor_words.txt").read_text("utf-8")
    lines = [line.strip() for line in text.splitlines()]
    words = tuple(line for line in lines if line and line[0] not in "#-")
    return Vocabulary(words, tuple(line[1:].strip() for line in lines if line.startswith("-")))


def named(shares: F32, words: Sequence[str], params: NamingParams) -> tuple[str, ...]:
    """The words, sorted, that some view names. shares: `(views, W)`, the first columns those of `words`.

    A view names its `most` largest shares of at least `least_share`; ties go to the first word.
    """
    seen: set[str] = set()
    for view in shares[:, : len(words)]:
        best = np.argsort(-view, kind="stable")[: params.most]
        seen.update(words[i] for i in best if view[i] >= params.least_share)
    return tuple(sorted(seen))


class ZeroShotEnumerator:
    """Names what the image or one of its four corners looks like, where no VLM is configured."""

    def __init__(
        self, encoder: ClipEncoder, vocabulary: Vocabulary | None = None, params: NamingParams | None = None
    ) -> None:
        self._encoder = encoder
        self._vocabulary = vocabulary or indoor_vocabulary()
        self._params = params or NamingParams()
        names = [*self._vocabulary.words, *self._vocabulary.distractors]
        self._texts = encoder.embed_texts_now([_TEXT.format(name) for name in names])

    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        return await asyncio.to_thread(self._enumerate, frame.rgb)

    def _enumerate(self, rgb: U8) -> tuple[str, ...]:
        height, width = rgb.shape[:2]
        parts = [rgb[t.y : t.y + t.height, t.x : t.x + t.width] for t in tiles(width, height)]
        cosines = self._encoder.embed_images_now(parts) @ self._texts.T
        return named(_softmax(self._encoder.scale * cosines), self._vocabulary.words, self._params)


def _softmax(logits: F32) -> F32:
    """Over the last axis."""
    powers = np.exp(logits - logits.max(axis=-1, keepdims=True))
    return np.asarray(powers / powers.sum(axis=-1, keepdims=True), np.float32)
