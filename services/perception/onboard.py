"""Detections that a robot made itself, as they lie in the blobs."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.features import normalize
from ovip.scene.types import F32, Bools, Box2, Intrinsics
from ovip.scene.words import normalize_word
from ovip.wire import decode_mask
from services.perception.domain.boxes2d import ScoredBox

MOST_DETECTIONS = 500


@dataclass(frozen=True, slots=True)
class OnboardMask:
    """A PNG mask and where its corner lies in the image."""

    x: int
    y: int
    png: bytes


@dataclass(frozen=True, slots=True)
class OnboardDetection:
    """One thing a robot saw; mask, feature and second feature (of a DINO, which may only veto merges) are optional."""

    label: str
    score: float
    box: Box2
    mask: OnboardMask | None = None
    feature: tuple[float, ...] = ()
    second_feature: tuple[float, ...] = ()

    @property
    def scored_box(self) -> ScoredBox:
        return ScoredBox(self.label, self.score, self.box)


def check_onboard(
    detections: Sequence[OnboardDetection], k: Intrinsics, dimension: int, second_dimension: int = 0
) -> tuple[OnboardDetection, ...]:
    """The detections with normalised labels; InvalidInput saying which one is wrong and how.

    dimension: features' D. second_dimension: E of second features; 0 where the stack has no second encoder, and then
    those of a frame must only be of one size.
    """
    if len(detections) > MOST_DETECTIONS:
        raise InvalidInput(f"detections: expected at most {MOST_DETECTIONS} a frame, got {len(detections)}")
    second = second_dimension or next((len(d.second_feature) for d in detections if d.second_feature), 0)
    return tuple(_checked(i, d, k, dimension, second) for i, d in enumerate(detections))


def encode_onboard(detections: Sequence[OnboardDetection]) -> bytes:
    """Bytes for the blob store: a JSON head, then masks and features in its order."""
    head = [
        {
            "label": d.label,
            "score": d.score,
            "box": [d.box.x0, d.box.y0, d.box.x1, d.box.y1],
            "mask": [d.mask.x, d.mask.y, len(d.mask.png)] if d.mask else None,
            "dimension": len(d.feature),
            "second_dimension": len(d.second_feature),
        }
        for d in detections
    ]
    text = json.dumps(head).encode()
    bodies = [
        (d.mask.png if d.mask else b"") + np.asarray([*d.feature, *d.second_feature], "<f4").tobytes()
        for d in detections
    ]
    return b"".join([len(text).to_bytes(8, "little"), text, *bodies])


def decode_onboard(data: bytes) -> tuple[OnboardDetection, ...]:
    """What `encode_onboard` wrote."""
    at = 8 + int.from_bytes(data[:8], "little")
    detections = []
    for item in json.loads(data[8:at]):
        mask = None
        if item["mask"]:
            x, y, size = item["mask"]
            mask, at = OnboardMask(x, y, data[at : at + size]), at + size
        first, second = item["dimension"], item.get("second_dimension", 0)  # once there was one feature only
        numbers = np.frombuffer(data, "<f4", count=first + second, offset=at)
        at += numbers.nbytes
        detections.append(
            OnboardDetection(
                label=item["label"],
                score=item["score"],
                box=Box2(*item["box"]),
                mask=mask,
                feature=tuple(numbers[:first].tolist()),
                second_feature=tuple(numbers[first:].tolist()),
            )
        )
    return tuple(detections)


def mask_of(detection: OnboardDetection, k: Intrinsics) -> Bools | None:
    """The mask `(H, W)`, or None where the robot sent none. InvalidInput where it does not decode or fit."""
    if detection.mask is None:
        return None
    raw = decode_mask(f"mask of {detection.label!r}", detection.mask.png, k)
    x, y = detection.mask.x, detection.mask.y
    if x + raw.shape[1] > k.width or y + raw.shape[0] > k.height:
        raise InvalidInput(
            f"mask of {detection.label!r}: {raw.shape[1]}x{raw.shape[0]} at ({x}, {y}) "
            f"leaves the image of {k.width}x{k.height}"
        )
    mask = np.zeros((k.height, k.width), dtype=bool)
    mask[y : y + raw.shape[0], x : x + raw.shape[1]] = raw
    return mask


def feature_of(detection: OnboardDetection) -> F32 | None:
    """The unit feature `(D,)`, or None where the robot sent none."""
    return normalize(np.array(detection.feature, np.float32)) if detection.feature else None


def second_feature_of(detection: OnboardDetection) -> F32 | None:
    """The unit second feature `(E,)`, or None where the robot sent none."""
    return normalize(np.array(detection.second_feature, np.float32)) if detection.second_feature else None


def _checked(
    i: int, d: OnboardDetection, k: Intrinsics, dimension: int, second_dimension: int
) -> OnboardDetection:
    what, word = f"detection {i}", normalize_word(d.label)
    if not word or len(d.label) > 100:
        raise InvalidInput(f"{what}: expected a label of 1 to 100 characters, got {d.label[:100]!r}")
    if not 0.0 <= d.score <= 1.0:
        raise InvalidInput(f"{what} ({d.label}): expected a score of 0 to 1, got {d.score}")
    numbers = [d.box.x0, d.box.y0, d.box.x1, d.box.y1]
    if not np.isfinite(numbers).all() or d.box.area <= 0:
        raise InvalidInput(f"{what} ({d.label}): expected a box with x0 < x1 and y0 < y1, got {numbers}")
    if d.box.x1 <= 0 or d.box.y1 <= 0 or d.box.x0 >= k.width or d.box.y0 >= k.height:
        raise InvalidInput(
            f"{what} ({d.label}): its box {numbers} lies outside the image of {k.width}x{k.height}"
        )
    if not _may_be(d.feature, dimension):
        raise InvalidInput(
            f"{what} ({d.label}): expected no feature, or {dimension} finite numbers of the scene's feature space, "
            f"got {len(d.feature)}"
        )
    if not _may_be(d.second_feature, second_dimension):
        raise InvalidInput(
            f"{what} ({d.label}): expected no second feature, or {second_dimension} finite numbers of the second "
            f"encoder's space, got {len(d.second_feature)}"
        )
    mask_of(d, k)
    # a view weighs by its box's area in the image, so what lies beyond must not count
    box = Box2(max(d.box.x0, 0.0), max(d.box.y0, 0.0), min(d.box.x1, k.width), min(d.box.y1, k.height))
    return dataclasses.replace(d, label=word, box=box)


def _may_be(feature: Sequence[float], dimension: int) -> bool:
    """Whether it is absent, or a vector of `dimension` with a direction."""
    return not feature or (len(feature) == dimension and bool(np.isfinite(feature).all()) and any(feature))
