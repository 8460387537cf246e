"""The four seams of perception: who names, who finds, who masks, who embeds (SPEC 1, DESIGN 5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ovip.scene.types import F32, Bools, Box2, Frame
from services.perception.domain.boxes2d import ScoredBox


class Enumerator(Protocol):
    """Names what is visible."""

    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        """Normalised words T^t, in no order."""
        ...


class Grounder(Protocol):
    """Finds words in an image."""

    def groundable(self, word: str) -> bool:
        """Whether this grounder has any way to see the word."""
        ...

    async def ground(self, frame: Frame, words: Sequence[str]) -> list[ScoredBox]:
        """Boxes of the words that are in the frame; each box's label is one of `words`."""
        ...


class Segmenter(Protocol):
    """Turns boxes into masks."""

    async def segment(self, frame: Frame, boxes: Sequence[Box2]) -> list[Bools]:
        """One `(H, W)` mask per box; all False where nothing is found."""
        ...


class CropEncoder(Protocol):
    """Puts crops into a feature space."""

    @property
    def space(self) -> str:
        """Name of the feature space: features of different spaces never meet."""
        ...

    @property
    def dimension(self) -> int:
        """D of the space."""
        ...

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        """Unit features `(N, D)` of the boxes' crops."""
        ...


class Encoder(CropEncoder, Protocol):
    """Puts crops and texts into one feature space."""

    async def embed_texts(self, texts: Sequence[str]) -> F32:
        """Unit features `(N, D)` of texts."""
        ...
