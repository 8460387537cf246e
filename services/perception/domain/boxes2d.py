"""2D boxes of one frame: tiles to look at, and one box per thing after looking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, Box2


@dataclass(frozen=True, slots=True)
class ScoredBox:
    """A detector's box: label, confidence 0..1, pixels."""

    label: str
    score: float
    box: Box2


@dataclass(frozen=True, slots=True)
class Tile:
    """A part of the image that the detector looks at on its own."""

    x: int
    y: int
    width: int
    height: int


def tiles(width: int, height: int, share: float = 0.6) -> tuple[Tile, ...]:
    """The whole image, and four overlapping corners of `share` of each side: doubles what a 300-pixel detector sees."""
    w, h = round(width * share), round(height * share)
    corners = [(0, 0), (width - w, 0), (0, height - h), (width - w, height - h)]
    return (Tile(0, 0, width, height), *(Tile(x, y, w, h) for x, y in corners))


def cut_by_tile(box: Box2, tile: Tile, width: int, height: int, margin: float = 3.0) -> bool:
    """Whether a box ends at a border of its tile that is not the image's border: it shows a part of the thing."""
    return (
        (tile.x > 0 and box.x0 < tile.x + margin)
        or (tile.y > 0 and box.y0 < tile.y + margin)
        or (tile.x + tile.width < width and box.x1 > tile.x + tile.width - margin)
        or (tile.y + tile.height < height and box.y1 > tile.y + tile.height - margin)
    )


def suppress(boxes: Sequence[ScoredBox], overlap: float = 0.5, same_thing: float = 0.8) -> list[ScoredBox]:
    """Best-scored boxes first, each dropped that repeats a kept one.

    A box repeats another of its label where their IoU exceeds `overlap` or one covers `same_thing` of the other,
    and one of another label where their IoU exceeds `same_thing`. Ties go to the larger, then the first box.
    """
    order = sorted(range(len(boxes)), key=lambda i: (-boxes[i].score, -boxes[i].box.area, i))
    kept: list[ScoredBox] = []
    for i in order:
        if not any(_repeats(boxes[i], other, overlap, same_thing) for other in kept):
            kept.append(boxes[i])
    return kept


def _repeats(a: ScoredBox, b: ScoredBox, overlap: float, same_thing: float) -> bool:
    shared = _shared_area(a.box, b.box)
    union = a.box.area + b.box.area - shared
    iou = shared / union if union > 0 else 0.0
    if a.label != b.label:
        return iou > same_thing
    covered = shared / max(min(a.box.area, b.box.area), 1e-9)
    return iou > overlap or covered > same_thing


def _shared_area(a: Box2, b: Box2) -> float:
    low: F64 = np.maximum([a.x0, a.y0], [b.x0, b.y0])
    high: F64 = np.minimum([a.x1, a.y1], [b.x1, b.y1])
    return float(np.prod(np.maximum(high - low, 0.0)))
