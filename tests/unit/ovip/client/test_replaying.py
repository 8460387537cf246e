"""A recording's frames as they are sent."""

from __future__ import annotations

import cv2
import numpy as np

from ovip.client.replaying import outgoing
from ovip.recordings import OnboardDetection, RecordedFrame
from ovip.scene.types import Box2
from tests.builders import camera, colour_noise, depth_units, png, pose


def recorded(*onboard: OnboardDetection) -> RecordedFrame:
    k = camera()
    return RecordedFrame(
        index=4,
        timestamp_ns=7,
        world_from_camera=pose(),
        rgb_bytes=png(colour_noise(k)),
        rgb_encoding="png",
        depth_bytes=png(depth_units(k)),
        depth_scale=1000.0,
        onboard=onboard,
    )


def test_what_was_seen_on_board_goes_along_with_both_features_and_the_masks_own_part() -> None:
    mask = np.zeros((48, 64), bool)
    mask[10:12, 20:25] = True
    feature, second = np.array([1.0, 0.0], np.float32), np.array([0.5], np.float32)
    seen = OnboardDetection("mug", 0.5, Box2(18, 9, 26, 13), mask, feature, second)
    bare = OnboardDetection("lamp", 0.5, Box2(0, 0, 4, 4))

    (sent,) = outgoing([recorded(seen, bare)])

    assert sent.sequence == 5
    assert sent.detections is not None
    mug, lamp = sent.detections
    assert (mug.feature, mug.second_feature) == ((1.0, 0.0), (0.5,))
    assert (mug.mask_x, mug.mask_y) == (20, 10)
    part = cv2.imdecode(np.frombuffer(mug.mask_png, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert part.shape == (2, 5)
    assert part.all()
    assert (lamp.mask_png, lamp.feature, lamp.second_feature) == (b"", (), ())
