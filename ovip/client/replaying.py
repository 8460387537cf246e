"""A recording as a robot's stream: who streams it, and its frames as they are sent."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator

import cv2
import numpy as np

from ovip.client.streaming import Hello, OutgoingDetection, OutgoingFrame
from ovip.recordings import OnboardDetection, RecordedFrame, Recording
from ovip.scene.types import F32


def hello_of(recording: Recording, scene: str, robot_id: str) -> Hello:
    """The session of one recording at one stride: the same again goes on where it was."""
    session = f"{recording.fingerprint()[:16]}-s{recording.stride}"
    return Hello(scene, robot_id, session, recording.intrinsics, recording.world_from_source)


def outgoing(frames: Iterable[RecordedFrame]) -> Iterator[OutgoingFrame]:
    """Recorded frames as they are sent: sequences count from 1, what was detected on board goes along."""
    for frame in frames:
        yield OutgoingFrame(
            sequence=frame.index + 1,
            timestamp_ns=frame.timestamp_ns,
            world_from_camera=frame.world_from_camera,
            rgb=frame.rgb_bytes,
            depth=frame.depth_bytes,
            depth_scale=frame.depth_scale,
            detections=None if frame.onboard is None else tuple(_detection(d) for d in frame.onboard),
        )


def _detection(d: OnboardDetection) -> OutgoingDetection:
    seen = OutgoingDetection(
        d.label, d.score, d.box2, feature=_numbers(d.feature), second_feature=_numbers(d.second_feature)
    )
    if d.mask is None or not d.mask.any():
        return seen
    rows, columns = np.flatnonzero(d.mask.any(axis=1)), np.flatnonzero(d.mask.any(axis=0))
    part = d.mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    png = cv2.imencode(".png", part.astype(np.uint8) * 255)[1].tobytes()
    return dataclasses.replace(seen, mask_png=png, mask_x=int(columns[0]), mask_y=int(rows[0]))


def _numbers(feature: F32 | None) -> tuple[float, ...]:
    return () if feature is None else tuple(float(value) for value in feature)
