"""A place made by hand: a table with a mug and a vase on it, beside a floor, and detections of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lab.evaluation.mapping.places import Place
from ovip.scene.types import DetectionBatch
from tests.builders import axis, batch, block, detection

CLASSES = ("floor", "mug", "table", "vase")
FLOOR, MUG, TABLE, VASE = range(4)
TABLE_ID, MUG_ID, VASE_ID = 1, 2, 3

TABLE_TOP = block((0, 0, 0.70), (1, 1, 0.74), 0.02)
MUG_POINTS = block((0.2, 0.2, 0.76), (0.28, 0.28, 0.86), 0.02)
VASE_POINTS = block((0.7, 0.7, 0.76), (0.80, 0.80, 1.0), 0.02)
FLOOR_POINTS = block((0, 0, 0), (1, 1, 0), 0.05)


def tabletop(cache: Path = Path("none")) -> Place:
    """The truth of it; "cup" is a word that means a mug, by its feature."""
    things = ((TABLE_ID, TABLE, TABLE_TOP), (MUG_ID, MUG, MUG_POINTS), (VASE_ID, VASE, VASE_POINTS))
    sizes = [len(points) for _, _, points in things]
    words = (*CLASSES, "cup")
    features = np.stack([*(axis(i) for i in range(4)), 0.8 * axis(MUG) + 0.6 * axis(5)])
    return Place(
        name="tabletop",
        words=words,
        word_features=features.astype(np.float32),
        classes=len(CLASSES),
        structural=frozenset({"floor"}),
        dense=np.concatenate([FLOOR_POINTS, *(points for _, _, points in things)]),
        dense_class=np.repeat([FLOOR, TABLE, MUG, VASE], [len(FLOOR_POINTS), *sizes]),
        points=np.concatenate([points for _, _, points in things]),
        instances=np.repeat([i for i, _, _ in things], sizes),
        point_class=np.repeat([c for _, c, _ in things], sizes),
        area_ids=np.array([TABLE_ID, MUG_ID, VASE_ID]),
        areas=np.array([2.0, 0.04, 0.12]),
        sizes=np.array([1.0, 0.1, 0.24]),
        frames=4,
        detections=12,
        features="by hand",
        storeys=(),
        cache=cache,
    )


def seen_well(frames: int = 4) -> list[DetectionBatch]:
    """Everything seen in every frame, under its own name and with its own feature; the mug as a cup."""
    return [
        batch(
            number,
            detection("table", feature=axis(TABLE), points=TABLE_TOP),
            detection("cup", feature=axis(MUG), points=MUG_POINTS),
            detection("vase", feature=axis(VASE), points=VASE_POINTS),
        )
        for number in range(1, frames + 1)
    ]
