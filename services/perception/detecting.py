"""From a frame and words to lifted detections: ground, segment, embed, lift (SPEC 1.3 to 1.6)."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, Bools, Detection, DetectionBatch, Frame
from services.perception.domain.boxes2d import ScoredBox
from services.perception.domain.lifting import LiftParams, lift_all, surface_cloud
from services.perception.domain.nearest import nearest_depth
from services.perception.onboard import OnboardDetection, feature_of, mask_of, second_feature_of
from services.perception.ports import CropEncoder, Encoder, Enumerator, Grounder, Segmenter

_NONE = np.zeros(0, np.float32)


@dataclass(frozen=True, slots=True)
class Models:
    """The models behind the four seams, and what the set is called.

    second_encoder: gives the features that may only veto merges (DINO family), where there is one.
    """

    name: str
    enumerator: Enumerator
    grounder: Grounder
    segmenter: Segmenter
    encoder: Encoder
    second_encoder: CropEncoder | None = None


@dataclass(frozen=True, slots=True)
class _Look:
    """What is known of one box before lifting. second: `(E,)` of the second encoder, empty where none looked."""

    box: ScoredBox
    mask: Bools
    feature: F32
    second: F32


class Detecting:
    """Runs the models on one frame; the same frame and words give the same detections."""

    def __init__(self, models: Models, params: LiftParams) -> None:
        self.models = models
        self._params = params

    async def tags(self, frame: Frame, onboard: Sequence[OnboardDetection] | None) -> tuple[str, ...]:
        """The words seen in a frame, T^t: the robot's own where it detects on board."""
        if onboard is not None:
            return tuple(sorted({d.label for d in onboard}))
        return tuple(sorted(set(await self.models.enumerator.enumerate(frame))))

    async def detect(
        self, frame: Frame, words: Sequence[str], onboard: Sequence[OnboardDetection] | None
    ) -> tuple[Detection, ...]:
        """Lifted detections of `words` in a frame."""
        if onboard is not None:
            looks = await self._look_onboard(frame, [d for d in onboard if d.label in words])
        else:
            looks = await self._look(frame, words)
        return await asyncio.to_thread(self._lift_all, frame, looks, tuple(words))

    async def batch(
        self, frame: Frame, words: Sequence[str], onboard: Sequence[OnboardDetection] | None, late: bool
    ) -> DetectionBatch:
        """What goes to the mapper for a frame; late batches carry no surface and no depth, theirs was sent before."""
        surface, nearest = np.zeros((0, 3), np.float32), np.zeros((0, 0), np.float32)
        if late:
            detections = await self.detect(frame, words, onboard)
        else:
            detections, (surface, nearest) = await asyncio.gather(
                self.detect(frame, words, onboard), asyncio.to_thread(self._seen, frame)
            )
        return DetectionBatch(
            frame_id=frame.frame_id,
            timestamp_ns=frame.timestamp_ns,
            intrinsics=frame.intrinsics,
            world_from_camera=frame.world_from_camera,
            detections=detections,
            surface=surface,
            words=tuple(words),
            late=late,
            nearest=nearest,
        )

    async def _look(self, frame: Frame, words: Sequence[str]) -> list[_Look]:
        boxes = await self.models.grounder.ground(frame, words) if words else []
        boxes = [box for box in boxes if box.score >= self._params.min_confidence]
        if not boxes:
            return []
        masks = await self.models.segmenter.segment(frame, [box.box for box in boxes])
        features = await self.models.encoder.embed_crops(frame, boxes)
        seconds = await self._seconds(frame, boxes)
        return [_Look(*look) for look in zip(boxes, masks, features, seconds, strict=True)]

    async def _look_onboard(self, frame: Frame, detections: Sequence[OnboardDetection]) -> list[_Look]:
        kept = [d for d in detections if d.score >= self._params.min_confidence]
        if not kept:
            return []
        boxes = [d.scored_box for d in kept]
        masks = [mask_of(d, frame.intrinsics) for d in kept]
        features = [feature_of(d) for d in kept]
        if any(mask is None for mask in masks):
            own = await self.models.segmenter.segment(frame, [box.box for box in boxes])
            masks = [mask if mask is not None else made for mask, made in zip(masks, own, strict=True)]
        if any(feature is None for feature in features):
            made_features = await self.models.encoder.embed_crops(frame, boxes)
            features = [f if f is not None else made for f, made in zip(features, made_features, strict=True)]
        seconds = [second_feature_of(d) for d in kept]
        if any(second is None for second in seconds):
            made_seconds = await self._seconds(frame, boxes)
            seconds = [s if s is not None else made for s, made in zip(seconds, made_seconds, strict=True)]
        return [
            _Look(box, mask, feature, second)
            for box, mask, feature, second in zip(boxes, masks, features, seconds, strict=True)
            if mask is not None and feature is not None and second is not None
        ]

    async def _seconds(self, frame: Frame, boxes: Sequence[ScoredBox]) -> Sequence[F32]:
        """The second encoder's features, empty ones where there is none."""
        if self.models.second_encoder is None:
            return [_NONE] * len(boxes)
        return list(await self.models.second_encoder.embed_crops(frame, boxes))

    def _seen(self, frame: Frame) -> tuple[F32, F32]:
        """A frame's coarse surface, and how far it saw."""
        nearest = nearest_depth(frame.depth, farthest=self._params.farthest_seen)
        return surface_cloud(frame, self._params), nearest

    def _lift_all(
        self, frame: Frame, looks: Sequence[_Look], words: tuple[str, ...]
    ) -> tuple[Detection, ...]:
        group = "+".join(words)
        detections = []
        made = lift_all(frame, [look.mask for look in looks], self._params)
        for index, (look, lifted) in enumerate(zip(looks, made, strict=True)):
            if lifted is None:
                continue
            detections.append(
                Detection(
                    detection_id=f"{frame.frame_id}/{group[:60]}/{index}",
                    label=look.box.label,
                    score=look.box.score,
                    box2=look.box.box,
                    box=lifted.box,
                    feature=look.feature,
                    points=lifted.points,
                    colors=lifted.colors,
                    second_feature=look.second,
                )
            )
        return tuple(detections)
