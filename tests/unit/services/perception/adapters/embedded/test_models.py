"""The embedded models on the CPU: what they say is in its space and its place, and the same every time."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.scene.types import Box2, Frame, Intrinsics
from ovip.wire import decode_depth, decode_rgb
from services.perception.adapters import embedded
from services.perception.adapters.embedded.coco import COCO, SYNONYMS
from services.perception.domain.boxes2d import ScoredBox
from tests.builders import camera, frame

pytestmark = pytest.mark.models
K = camera(320, 240, 300.0)


@pytest.fixture(scope="module")
def texts(models_dir: Path) -> embedded.MiniLm:
    return embedded.MiniLm(models_dir)


@pytest.fixture(scope="module")
def detector(models_dir: Path) -> embedded.TiledDetector:
    return embedded.TiledDetector(models_dir)


@pytest.fixture(scope="module")
def kitchen(data_root: Path) -> Frame:
    """The first frame of the recording: a table with chairs around it."""
    k = Intrinsics(585.0, 585.0, 320.0, 240.0, 640, 480)
    first = data_root / "kitchen" / "frame-000000"
    rgb = decode_rgb(first.with_suffix(".color.jpg").read_bytes(), k)
    depth = decode_depth(first.with_suffix(".depth.png").read_bytes(), "png16", 1000.0, k)
    return frame(depth, "r.s.00000001", k, rgb)


# Words


def test_text_features_are_unit_vectors_of_384_numbers(texts: embedded.MiniLm) -> None:
    features = texts.embed_now(["cup", "a very long text " * 100, "ünïcode 茶碗"])

    assert features.shape == (3, 384)
    assert np.linalg.norm(features, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert texts.embed_now([]).shape == (0, 384)


def test_a_text_has_the_same_feature_alone_or_among_others(texts: embedded.MiniLm, models_dir: Path) -> None:
    among = texts.embed_now(["a chair by the window", "cup", "table"])[1]
    alone = embedded.MiniLm(models_dir).embed_now(["cup"])[0]

    assert among.tobytes() == alone.tobytes()


@pytest.mark.parametrize(
    ("word", "like", "unlike"),
    [("sofa", "couch", "cup"), ("mug", "cup", "chair"), ("tv", "television", "banana")],
)
def test_words_lie_near_their_kin(texts: embedded.MiniLm, word: str, like: str, unlike: str) -> None:
    a, b, c = texts.embed_now([word, like, unlike])

    assert a @ b > a @ c + 0.2


# Grounding


def test_the_synonyms_lead_to_classes_of_the_detector() -> None:
    assert set(SYNONYMS.values()) <= set(COCO.values())
    assert len(set(COCO.values())) == len(COCO) == 80


@pytest.mark.parametrize(
    "word", ["cup", "mug", "sofa", "wooden chair", "old kitchen table", "floral sofa", "fridge"]
)
def test_a_word_that_means_a_class_can_be_grounded(detector: embedded.TiledDetector, word: str) -> None:
    assert embedded.DetectorGrounder(detector).groundable(word)


@pytest.mark.parametrize("word", ["piano", "towel", "chairlift", "", "cup holder"])
def test_a_word_that_means_no_class_cannot(detector: embedded.TiledDetector, word: str) -> None:
    assert not embedded.DetectorGrounder(detector).groundable(word)


async def test_a_plain_image_shows_nothing(detector: embedded.TiledDetector) -> None:
    assert await embedded.DetectorEnumerator(detector).enumerate(frame(k=K)) == ()


@pytest.mark.recording
async def test_in_the_kitchen_boxes_lie_in_the_image_and_carry_the_word_asked_for(
    detector: embedded.TiledDetector, kitchen: Frame
) -> None:
    names = await embedded.DetectorEnumerator(detector).enumerate(kitchen)
    assert names
    assert set(names) <= set(COCO.values())

    for box in await embedded.DetectorGrounder(detector).ground(kitchen, names):
        assert box.label in names
        assert 0.35 <= box.score <= 1.0
        assert 0 <= box.box.x0 < box.box.x1 <= 640
        assert 0 <= box.box.y0 < box.box.y1 <= 480
    word = f"wooden {names[0]}"
    asked_otherwise = await embedded.DetectorGrounder(detector).ground(kitchen, [word])
    assert {box.label for box in asked_otherwise} == {word}


@pytest.mark.recording
async def test_two_images_under_one_frame_id_keep_their_own_boxes(
    detector: embedded.TiledDetector, kitchen: Frame
) -> None:
    """Frame ids are unique in a scene; two scenes of one robot may use the same."""
    other = dataclasses.replace(kitchen, rgb=np.zeros_like(kitchen.rgb))

    assert await detector.boxes(kitchen) != []
    assert await detector.boxes(other) == []


@pytest.mark.recording
async def test_the_same_image_gives_the_same_boxes(
    detector: embedded.TiledDetector, kitchen: Frame, models_dir: Path
) -> None:
    assert await embedded.TiledDetector(models_dir).boxes(kitchen) == await detector.boxes(kitchen)


# Masks and crops


def _ball() -> Frame:
    """An orange ball before a grey wall, nearer than it."""
    rgb = np.full((240, 320, 3), 120, np.uint8)
    cv2.circle(rgb, (160, 120), 45, (230, 120, 20), -1)
    depth = np.full((240, 320), 3.0, np.float32)
    cv2.circle(depth, (160, 120), 45, 1.5, -1)
    return frame(depth, k=K, rgb=rgb)


async def test_a_mask_is_the_thing_in_the_box(models_dir: Path) -> None:
    seen = _ball()
    (mask,) = await embedded.SaliencySegmenter(models_dir).segment(seen, [Box2(110, 70, 210, 170)])

    thing = seen.depth == 1.5
    assert (mask & thing).sum() / (mask | thing).sum() > 0.85


async def test_a_box_outside_the_image_has_an_empty_mask(models_dir: Path) -> None:
    (mask,) = await embedded.SaliencySegmenter(models_dir).segment(_ball(), [Box2(400, 10, 420, 30)])

    assert not mask.any()


async def test_crops_are_embedded_near_their_label_in_the_space_of_the_texts(
    models_dir: Path, texts: embedded.MiniLm
) -> None:
    encoder = embedded.ConseEncoder(models_dir, texts)
    boxes = [ScoredBox(label, 0.9, Box2(110, 70, 210, 170)) for label in ("sports ball", "cup")]

    features = await encoder.embed_crops(_ball(), boxes)

    assert features.shape == (2, encoder.dimension)
    assert np.linalg.norm(features, axis=1) == pytest.approx(1.0, abs=1e-5)
    words = await encoder.embed_texts(["sports ball", "cup", "bed"])
    assert (features @ words.T).argmax(axis=1).tolist() == [0, 1]
    assert (await encoder.embed_crops(_ball(), boxes)).tobytes() == features.tobytes()
    assert (await encoder.embed_crops(_ball(), [])).shape == (0, encoder.dimension)
