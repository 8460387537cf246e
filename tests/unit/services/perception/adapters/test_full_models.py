"""The full set on small models with random weights: shapes, labels, errors; what they see is noise.

Skipped without torch and transformers (`pip install 'ovip-sg[full]'`).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ovip.errors import NotConfigured
from ovip.scene.types import Box2, Frame
from services.perception.config import Settings
from services.perception.domain.boxes2d import ScoredBox
from tests.builders import camera, colour_noise, frame

pytest.importorskip("torch", reason="the full models need torch")
pytest.importorskip("transformers", reason="the full models need transformers")

from services.perception.adapters.full import open_full, open_second_encoder
from services.perception.adapters.full.dino import DinoEncoder
from services.perception.adapters.full.encoding import open_encoder
from services.perception.adapters.full.grounding import open_grounder
from services.perception.adapters.full.naming import NamingParams, Vocabulary, ZeroShotEnumerator
from services.perception.adapters.full.segmenting import Sam2Segmenter
from tests.unit.services.perception.adapters import tiny_models

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one small model of each kind."""
    root = tmp_path_factory.mktemp("weights")
    tiny_models.write_grounding_dino(root / "dino")
    tiny_models.write_owlv2(root / "owl")
    tiny_models.write_omdet_turbo(root / "omdet")
    tiny_models.write_sam2(root / "sam2")
    tiny_models.write_clip(root / "clip")
    tiny_models.write_dinov2(root / "dinov2")
    tiny_models.write_first_dino(root / "first-dino")
    return root


@pytest.fixture
def seen() -> Frame:
    return frame(rgb=colour_noise(camera(), 1))


@pytest.mark.parametrize("model", ["dino", "owl", "omdet"])
async def test_boxes_are_of_the_words_asked_for_and_inside_the_image(
    weights: Path, seen: Frame, model: str
) -> None:
    grounder = open_grounder(str(weights / model), "cpu", min_confidence=0.0)
    words = ["cup", "dining table", "vase", "radiator", "umbrella stand"]
    found = await grounder.ground(seen, words)
    assert found
    assert {box.label for box in found} <= set(words)
    for item in found:
        assert 0 <= item.score <= 1
        assert 0 <= item.box.x0 < item.box.x1 <= seen.intrinsics.width
        assert 0 <= item.box.y0 < item.box.y1 <= seen.intrinsics.height


@pytest.mark.parametrize("model", ["dino", "owl", "omdet"])
async def test_the_same_frame_gives_the_same_boxes_and_no_words_give_none(
    weights: Path, seen: Frame, model: str
) -> None:
    grounder = open_grounder(str(weights / model), "cpu", min_confidence=0.0)
    assert await grounder.ground(seen, ["cup", "vase"]) == await grounder.ground(seen, ["cup", "vase"])
    assert await grounder.ground(seen, []) == []
    assert grounder.groundable("left-handed teapot")


async def test_more_words_than_fit_one_prompt_are_all_looked_for(weights: Path, seen: Frame) -> None:
    grounder = open_grounder(str(weights / "dino"), "cpu", min_confidence=0.0)
    apart = {
        box.label for word in ("refrigerator", "dishwasher") for box in await grounder.ground(seen, [word])
    }
    assert {box.label for box in await grounder.ground(seen, ["refrigerator", "dishwasher"])} == apart


async def test_a_mask_per_box_in_the_frames_size_and_none_outside_it(weights: Path, seen: Frame) -> None:
    segmenter = Sam2Segmenter(str(weights / "sam2"), "cpu")
    shape = (seen.intrinsics.height, seen.intrinsics.width)
    boxes = [Box2(2, 3, 20, 18), Box2(-50, -50, -10, -10), Box2(0, 0, shape[1], shape[0])]
    masks = await segmenter.segment(seen, boxes)
    assert [mask.shape for mask in masks] == [shape] * 3
    assert all(mask.dtype == bool for mask in masks)
    assert not masks[1].any()
    assert await segmenter.segment(seen, []) == []


async def test_crops_and_texts_share_a_space_of_unit_features(weights: Path, seen: Frame) -> None:
    encoder = open_encoder(str(weights / "clip"), "cpu")
    crops = await encoder.embed_crops(seen, [ScoredBox("cup", 0.9, Box2(2, 2, 30, 20)), _NO_PIXELS])
    texts = await encoder.embed_texts(["a white mug", "cup", "a very long text " * 40])
    assert encoder.dimension == 24
    assert crops.shape == (2, 24)
    assert texts.shape == (3, 24)
    assert np.linalg.norm(np.concatenate([crops, texts]), axis=1) == pytest.approx(np.ones(5), abs=1e-5)
    assert (await encoder.embed_crops(seen, [])).shape == (0, 24)
    assert encoder.space == "clip:clip"


async def test_a_text_means_the_same_alone_and_among_others(weights: Path) -> None:
    encoder = open_encoder(str(weights / "clip"), "cpu")
    alone = await encoder.embed_texts(["cup"])
    among = await encoder.embed_texts(["a long sentence about tables", "cup"])
    assert among[1] == pytest.approx(alone[0], abs=1e-5)


async def test_open_clips_own_format_is_read_too(tmp_path: Path, seen: Frame) -> None:
    pytest.importorskip("open_clip", reason="open_clip is not installed")
    encoder = open_encoder(f"local-dir:{tiny_models.write_open_clip(tmp_path / 'oc')}", "cpu")
    assert (await encoder.embed_crops(seen, [_NO_PIXELS])).shape == (1, 24)
    assert (await encoder.embed_texts(["cup"])).shape == (1, 24)


@pytest.mark.parametrize("model", ["dinov2", "first-dino"])
async def test_a_second_encoder_gives_unit_features_that_are_the_same_again_in_any_company(
    weights: Path, seen: Frame, model: str
) -> None:
    encoder = DinoEncoder(str(weights / model), "cpu")
    cup, lamp = ScoredBox("cup", 0.9, Box2(2, 2, 30, 20)), ScoredBox("lamp", 0.9, Box2(30, 10, 60, 40))

    both = await encoder.embed_crops(seen, [cup, lamp])
    many = await DinoEncoder(str(weights / model), "cpu").embed_crops(seen, [lamp] * 70 + [cup, _NO_PIXELS])

    assert (encoder.dimension, encoder.space) == (32, f"dino:{model}")
    assert both.shape == (2, 32)
    assert np.linalg.norm(many, axis=1) == pytest.approx(np.ones(72), abs=1e-5)
    assert many[70] == pytest.approx(both[0], abs=1e-5)
    assert many[69] == pytest.approx(both[1], abs=1e-5)
    assert float(both[0] @ both[1]) < 0.9999
    assert (await encoder.embed_crops(seen, [])).shape == (0, 32)


async def test_a_second_encoders_label_changes_nothing(weights: Path, seen: Frame) -> None:
    encoder = DinoEncoder(str(weights / "dinov2"), "cpu")
    boxes = [ScoredBox(label, 0.9, Box2(2, 2, 30, 20)) for label in ("cup", "lamp")]

    features = await encoder.embed_crops(seen, boxes)

    assert features[0] == pytest.approx(features[1], abs=1e-5)


def test_the_setting_names_the_second_encoder(weights: Path) -> None:
    named = _settings(weights, second_encoder=str(weights / "dinov2"))
    assert open_second_encoder(named).space == "dino:dinov2"
    with pytest.raises(NotConfigured, match=r"OVIP_SECOND_ENCODER.*DINO family.*type clip"):
        open_second_encoder(_settings(weights, second_encoder=str(weights / "clip")))
    with pytest.raises(NotConfigured, match=r"OVIP_SECOND_ENCODER.*nowhere"):
        open_second_encoder(_settings(weights, second_encoder=str(weights / "nowhere")))


async def test_enumeration_names_words_of_its_vocabulary_only(weights: Path, seen: Frame) -> None:
    encoder = open_encoder(str(weights / "clip"), "cpu")
    vocabulary = Vocabulary(("cup", "vase", "table"), ("kitchen",))
    every = ZeroShotEnumerator(encoder, vocabulary, NamingParams(least_share=0.0, most=4))
    none = ZeroShotEnumerator(encoder, vocabulary, NamingParams(least_share=1.0))
    assert await every.enumerate(seen) == ("cup", "table", "vase")
    assert await none.enumerate(seen) == ()


def test_the_settings_name_all_of_the_set(weights: Path) -> None:
    models = open_full(_settings(weights))
    assert models.name == "full"
    assert models.encoder.dimension == 24


def test_weights_that_are_not_there_are_named_by_their_setting(weights: Path) -> None:
    with pytest.raises(NotConfigured, match=r"OVIP_FULL_SEGMENTER.*nowhere"):
        open_full(_settings(weights, full_segmenter=str(weights / "nowhere")))


def test_a_model_that_cannot_ground_is_refused_as_grounder(weights: Path) -> None:
    with pytest.raises(NotConfigured, match=r"OVIP_FULL_GROUNDER.*type clip"):
        open_full(_settings(weights, full_grounder=str(weights / "clip")))


def test_a_device_that_is_not_there_is_refused(weights: Path) -> None:
    with pytest.raises(NotConfigured, match="OVIP_FULL_DEVICE"):
        open_full(_settings(weights, full_device="abacus"))


_NO_PIXELS = ScoredBox("cup", 0.9, Box2(-9, -9, -5, -5))


def _settings(weights: Path, **changes: str) -> Settings:
    named = {
        "full_grounder": str(weights / "dino"),
        "full_segmenter": str(weights / "sam2"),
        "full_encoder": str(weights / "clip"),
        "full_device": "cpu",
    }
    return Settings(_env_file=None).model_copy(update={**named, **changes})
