"""SSD-MobileNetV2 (COCO) through OpenCV, on the image and four tiles: names what it sees and finds what is asked."""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from ovip.scene.types import U8, Box2, Frame
from services.perception.adapters.embedded.coco import COCO, SYNONYMS
from services.perception.domain.boxes2d import ScoredBox, Tile, cut_by_tile, suppress, tiles

_INPUT = (300, 300)
_REMEMBERED_FRAMES = 64
_SMALLEST = 16.0  # square pixels
_LARGEST_PART = 0.95  # a box that fills its whole tile says nothing about where the thing is


class TiledDetector:
    """All COCO boxes of a frame above `min_score`, once per frame; safe to ask from several threads.

    min_score is this detector's own calibration (DESIGN 5: no threshold is shared between backends).
    """

    def __init__(self, models: Path, min_score: float = 0.35) -> None:
        self._net = cv2.dnn.readNetFromTensorflow(
            str(models / "ssd_mobilenet_v2_coco.pb"), str(models / "ssd_mobilenet_v2_coco.pbtxt")
        )
        self._min_score = min_score
        self._lock = threading.Lock()
        self._seen: OrderedDict[bytes, list[ScoredBox]] = OrderedDict()

    async def boxes(self, frame: Frame) -> list[ScoredBox]:
        """Boxes labelled with COCO names, best first, one per thing."""
        return await asyncio.to_thread(self._boxes, frame)

    def _boxes(self, frame: Frame) -> list[ScoredBox]:
        # by the image, not its frame id: ids are unique in one scene only
        image = hashlib.blake2b(np.ascontiguousarray(frame.rgb).tobytes(), digest_size=16).digest()
        with self._lock:
            if image not in self._seen:
                self._seen[image] = self._look(frame.rgb)
                if len(self._seen) > _REMEMBERED_FRAMES:
                    self._seen.popitem(last=False)
            return self._seen[image]

    def _look(self, rgb: U8) -> list[ScoredBox]:
        height, width = rgb.shape[:2]
        found: list[ScoredBox] = []
        for tile in tiles(width, height):
            found.extend(
                box for box in self._look_at(rgb, tile) if not cut_by_tile(box.box, tile, width, height)
            )
        return suppress(found)

    def _look_at(self, rgb: U8, tile: Tile) -> list[ScoredBox]:
        part = rgb[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
        self._net.setInput(cv2.dnn.blobFromImage(part, size=_INPUT))
        rows = self._net.forward()[0, 0]
        return [
            ScoredBox(COCO[int(row[1])], float(row[2]), box)
            for row in rows
            if row[2] >= self._min_score and int(row[1]) in COCO
            for box in [_box(row, tile)]
            if box.area > _SMALLEST
            and (part.shape == rgb.shape or box.area < _LARGEST_PART * tile.width * tile.height)
        ]


class DetectorEnumerator:
    """Names what the detector sees: the enumerator that needs no VLM."""

    def __init__(self, detector: TiledDetector) -> None:
        self._detector = detector

    async def enumerate(self, frame: Frame) -> tuple[str, ...]:
        return tuple(sorted({box.label for box in await self._detector.boxes(frame)}))


class DetectorGrounder:
    """Finds words that mean one of the detector's classes."""

    def __init__(self, detector: TiledDetector) -> None:
        self._detector = detector
        self._classes = frozenset(COCO.values())

    def groundable(self, word: str) -> bool:
        return self._class_of(word) is not None

    async def ground(self, frame: Frame, words: Sequence[str]) -> list[ScoredBox]:
        """Where several words mean one class, the class's own name wins, else the first word."""
        wanted: dict[str, str] = {}
        for word in words:
            named = self._class_of(word)
            if named and (named not in wanted or word == named):
                wanted[named] = word
        boxes = await self._detector.boxes(frame)
        return [ScoredBox(wanted[b.label], b.score, b.box) for b in boxes if b.label in wanted]

    def _class_of(self, word: str) -> str | None:
        named = SYNONYMS.get(word, word)
        if named in self._classes:
            return named
        last = named.split(" ")[-1]  # "wooden chair" is a chair
        last = SYNONYMS.get(last, last)
        return last if last in self._classes else None


def _box(row: np.ndarray[tuple[int], np.dtype[np.float32]], tile: Tile) -> Box2:
    x0, y0, x1, y1 = (float(v) for v in np.clip(row[3:7], 0.0, 1.0))
    return Box2(
        tile.x + x0 * tile.width,
        tile.y + y0 * tile.height,
        tile.x + x1 * tile.width,
        tile.y + y1 * tile.height,
    )
