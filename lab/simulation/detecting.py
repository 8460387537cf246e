"""What a simulated robot senses, and what it detects on board: the true instances in view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ovip.recordings import OnboardDetection
from ovip.scene.types import F32, F64, U8, U16, Bools, Box2

MIN_PIXELS = 40


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """One frame as the robot has it, and the true ids.

    rgb: `(H, W, 3)` uint8. depth: `(H, W)` float32 metres, 0 = none. pose: world_from_camera `(4, 4)` as the robot
    believes it. ids: `(H, W)` uint16. onboard: what it detected itself; None where it does not.
    """

    rgb: U8
    depth: F32
    pose: F64
    ids: U16
    onboard: tuple[OnboardDetection, ...] | None = None


class Thing(Protocol):
    """What is needed of an object to detect it."""

    @property
    def object_id(self) -> int: ...
    @property
    def label(self) -> str: ...
    @property
    def structural(self) -> bool: ...


class Furnished(Protocol):
    """Whatever has objects."""

    @property
    def objects(self) -> Sequence[Thing]: ...


def onboard_detections(
    world: Furnished, ids: U16, min_pixels: int = MIN_PIXELS
) -> tuple[OnboardDetection, ...]:
    """Detections of every thing, not structure, with `min_pixels` in rendered `ids` `(H, W)`, by id.

    Mask and box are exact; the score is 1 - min_pixels / (2 pixels): a half for the smallest. No features.
    """
    most = max((thing.object_id for thing in world.objects), default=0)
    counts = np.bincount(ids.ravel(), minlength=most + 1)
    seen = [
        thing for thing in world.objects if not thing.structural and counts[thing.object_id] >= min_pixels
    ]
    return tuple(
        _detection(thing.label, ids == thing.object_id, 1 - min_pixels / (2 * float(counts[thing.object_id])))
        for thing in seen
    )


def _detection(label: str, mask: Bools, score: float) -> OnboardDetection:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = Box2(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
    return OnboardDetection(label, score, box, mask)
