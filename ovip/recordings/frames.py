"""What a recording yields: posed frames, images still encoded, and what a robot detected on board."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ovip.scene.types import F32, F64, Bools, Box2

RgbEncoding = Literal["jpeg", "png"]


@dataclass(frozen=True, slots=True, eq=False)
class OnboardDetection:
    """One thing that the robot itself saw in a frame.

    score: 0..1. mask: `(H, W)` of the whole image, None = only the box is known. feature: `(D,)`, and second_feature:
    `(E,)` of a second encoder (DINO family), None = not computed.
    """

    label: str
    score: float
    box2: Box2
    mask: Bools | None = None
    feature: F32 | None = None
    second_feature: F32 | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RecordedFrame:
    """One frame of a recording, its images as they lie on disk.

    index: position in the original recording, from 0, whatever the stride. timestamp_ns: nanoseconds, never
    falling. world_from_camera: `(4, 4)` float64, rigid, world z up, metres. depth_bytes: PNG, one channel,
    uint16 z-depth in `depth_scale` units per metre, 0 = no measurement. onboard: None = the robot does not
    detect; empty = it looked and saw nothing.
    """

    index: int
    timestamp_ns: int
    world_from_camera: F64
    rgb_bytes: bytes
    rgb_encoding: RgbEncoding
    depth_bytes: bytes
    depth_scale: float
    onboard: tuple[OnboardDetection, ...] | None = None


@dataclass(frozen=True, slots=True)
class SkippedFrame:
    """A frame that cannot be used, and why in a few words."""

    index: int
    name: str
    reason: str
