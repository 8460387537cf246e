"""What the simulated robot detects on board: the true instances in view, larger ones with more score."""

from __future__ import annotations

import numpy as np

from lab.simulation.room import SimulatedRoom
from ovip.recordings import OnboardDetection
from ovip.scene.types import U16, Bools, Box2

MIN_PIXELS = 40


def onboard_detections(
    room: SimulatedRoom, ids: U16, min_pixels: int = MIN_PIXELS
) -> tuple[OnboardDetection, ...]:
    """Detections of every thing, not structure, with `min_pixels` in rendered `ids` `(H, W)`, by id.

    Mask and box are exact; the score is 1 - min_pixels / (2 pixels): a half for the smallest. No features.
    """
    counts = np.bincount(ids.ravel(), minlength=len(room.objects) + 1)
    seen = [thing for thing in room.objects if not thing.structural and counts[thing.object_id] >= min_pixels]
    return tuple(
        _detection(thing.label, ids == thing.object_id, 1 - min_pixels / (2 * float(counts[thing.object_id])))
        for thing in seen
    )


def _detection(label: str, mask: Bools, score: float) -> OnboardDetection:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = Box2(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
    return OnboardDetection(label, score, box, mask)
