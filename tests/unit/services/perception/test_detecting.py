"""From a frame and words to lifted detections, by the models of the painted world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ovip.codec import encode_detection_batch
from ovip.scene.types import Box2, Frame
from services.perception.detecting import Detecting
from services.perception.domain.lifting import LiftParams
from services.perception.onboard import OnboardDetection, OnboardMask
from tests.builders import axis, frame, png
from tests.unit.services.perception.painted import K, PaintedModels, painted_rgb


def _seen(*words: str) -> Frame:
    return frame(2.0, k=K, rgb=painted_rgb(*words))


def _detecting(models: PaintedModels | None = None, **params: float) -> Detecting:
    return Detecting((models or PaintedModels()).as_models(), LiftParams(**params))  # type: ignore[arg-type]


async def test_tags_are_sorted_words_each_once() -> None:
    assert await _detecting().tags(_seen("table", "cup"), None) == ("cup", "table")


async def test_the_tags_of_a_robot_that_detects_on_board_are_its_labels() -> None:
    own = [OnboardDetection(label, 0.9, Box2(0, 0, 9, 9)) for label in ("mug", "lamp", "mug")]

    assert await _detecting().tags(_seen("cup"), own) == ("lamp", "mug")


async def test_only_the_words_asked_for_are_detected() -> None:
    found = await _detecting().detect(_seen("cup", "table"), ["table", "chair"], None)

    (table,) = found
    assert (table.label, table.score) == ("table", 0.9)
    assert table.feature.tolist() == axis(2).tolist()
    assert table.points[:, 2] == pytest.approx(2.0)
    assert (table.colors == (0, 0, 200)).all()


async def test_no_words_ask_no_model() -> None:
    models = PaintedModels()

    assert await _detecting(models).detect(_seen("cup"), [], None) == ()
    assert models.grounded == []


async def test_boxes_of_too_little_confidence_are_dropped() -> None:
    assert await _detecting(min_confidence=0.95).detect(_seen("cup"), ["cup"], None) == ()


async def test_what_cannot_be_lifted_is_dropped() -> None:
    dark = frame(0.0, k=K, rgb=painted_rgb("cup"))

    assert await _detecting().detect(dark, ["cup"], None) == ()


async def test_a_robot_s_own_masks_and_features_are_used_and_what_it_lacks_is_made() -> None:
    left_half = png(np.tile(np.repeat(np.array([255, 0], np.uint8), 14), (28, 1)))
    full = OnboardDetection(
        "cup", 0.9, Box2(10, 10, 38, 38), OnboardMask(10, 10, left_half), (0.0,) * 7 + (1.0,)
    )
    bare = OnboardDetection("chair", 0.8, Box2(50, 10, 78, 38))

    cup, chair = await _detecting().detect(_seen("cup", "chair"), ["cup", "chair"], [full, bare])

    assert cup.feature.tolist() == axis(7).tolist()
    assert chair.feature.tolist() == axis(1).tolist()
    assert cup.box[3] - cup.box[0] < 0.7 * (chair.box[3] - chair.box[0])


async def test_the_same_frame_and_words_give_the_same_bytes() -> None:
    one = await _detecting().batch(_seen("cup", "chair"), ["chair", "cup"], None, late=False)
    other = await _detecting().batch(_seen("cup", "chair"), ["chair", "cup"], None, late=False)

    assert encode_detection_batch(one) == encode_detection_batch(other)
    assert len({d.detection_id for d in one.detections}) == 2


async def test_a_batch_carries_what_the_frame_saw_through() -> None:
    near = frame(2.0, k=K, rgb=painted_rgb("cup"))
    near.depth[:4, :4], near.depth[:4, 4:8] = 11.0, 13.0

    batch = await _detecting(max_depth=6.0).batch(near, ["cup"], None, late=False)

    assert batch.nearest.shape == (18, 24)
    assert batch.nearest[0, :3].tolist() == [11.0, 0.0, 2.0]  # farther than twice max_depth is not known


async def test_a_second_encoder_looks_at_every_box_and_a_robot_s_own_second_feature_goes_first() -> None:
    models = replace(PaintedModels().as_models(), second_encoder=PaintedModels())
    own = OnboardDetection("cup", 0.9, Box2(10, 10, 38, 38), second_feature=(0.0, 2.0))
    bare = OnboardDetection("chair", 0.8, Box2(50, 10, 78, 38))
    detecting = Detecting(models, LiftParams())

    (cup,) = await detecting.detect(_seen("cup"), ["cup"], None)
    sent, made = await detecting.detect(_seen("cup", "chair"), ["cup", "chair"], [own, bare])

    assert cup.second_feature.tolist() == axis(0).tolist()
    assert sent.second_feature.tolist() == [0.0, 1.0]
    assert made.second_feature.tolist() == axis(1).tolist()


async def test_without_a_second_encoder_there_is_no_second_feature() -> None:
    (cup,) = await _detecting().detect(_seen("cup"), ["cup"], None)

    assert cup.second_feature.shape == (0,)


async def test_a_late_batch_carries_neither_surface_nor_depth() -> None:
    now = await _detecting().batch(_seen("cup"), ["cup"], None, late=False)
    late = await _detecting().batch(_seen("cup"), ["cup"], None, late=True)

    assert len(now.surface) > 0
    assert len(late.surface) == 0
    assert late.nearest.size == 0
    assert late.late and not now.late
