"""A painted world: things are rectangles of their own colour before a wall, and models that see exactly those."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ovip.client import OutgoingFrame
from ovip.scene.types import F32, U8, Bools, Box2, Frame
from services.perception.detecting import Models
from services.perception.domain.boxes2d import ScoredBox
from tests.builders import DIMENSION, axis, camera, depth_units, outgoing, png

K = camera(96, 72, 90.0)
PAINT = {"cup": (200, 0, 0), "chair": (0, 200, 0), "table": (0, 0, 200), "logo": (200, 200, 0)}
_PLACES = {"cup": (10, 10), "chair": (50, 10), "table": (10, 40), "logo": (50, 40)}
_SIDE = 28


def painted_rgb(*words: str) -> U8:
    """`(H, W, 3)` with a rectangle for each word, each in a place of its own."""
    rgb = np.zeros((K.height, K.width, 3), np.uint8)
    for word in words:
        x, y = _PLACES[word]
        rgb[y : y + _SIDE, x : x + _SIDE] = PAINT[word]
    return rgb


def painted(sequence: int, *words: str) -> OutgoingFrame:
    """A frame that shows `words`, two metres away."""
    return outgoing(sequence, K, rgb=png(painted_rgb(*words)), depth=png(depth_units(K)))


class PaintedModels:
    """All four seams at once; counts what it was asked, and fails where it is told to."""

    space = "painted"
    dimension = DIMENSION

    def __init__(self, fail_at: Mapping[int, Exception] | None = None) -> None:
        self.grounded: list[tuple[str, str]] = []
        self._fail_at = dict(fail_at or {})
        self._asked = 0

    def as_models(self) -> Models:
        return Models("painted", self, self, self, self)

    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        self._asked += 1
        if self._asked in self._fail_at:
            raise self._fail_at[self._asked]
        return tuple(word for word in PAINT if _where(frame.rgb, word).any())

    def groundable(self, word: str) -> bool:
        return word in PAINT

    async def ground(self, frame: Frame, words: Sequence[str]) -> list[ScoredBox]:
        self.grounded += [(frame.frame_id, word) for word in words]
        return [
            ScoredBox(word, 0.9, _box(mask))
            for word in words
            if word in PAINT and (mask := _where(frame.rgb, word)).any()
        ]

    async def segment(self, frame: Frame, boxes: Sequence[Box2]) -> list[Bools]:
        masks = []
        for box in boxes:
            mask = np.zeros(frame.depth.shape, bool)
            mask[int(box.y0) : int(box.y1), int(box.x0) : int(box.x1)] = True
            masks.append(mask & frame.rgb.any(axis=2))
        return masks

    async def embed_crops(self, frame: Frame, boxes: Sequence[ScoredBox]) -> F32:
        return await self.embed_texts([box.label for box in boxes])

    async def embed_texts(self, texts: Sequence[str]) -> F32:
        known = list(PAINT)
        rows = [axis(known.index(text) if text in known else len(known)) for text in texts]
        return np.stack(rows) if rows else np.zeros((0, DIMENSION), np.float32)


def _where(rgb: U8, word: str) -> Bools:
    return np.asarray((rgb == PAINT[word]).all(axis=2))


def _box(mask: Bools) -> Box2:
    rows, columns = np.nonzero(mask)
    return Box2(float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1))
