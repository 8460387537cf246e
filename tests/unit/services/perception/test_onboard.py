"""Detections made on board: checked in words, kept bit for bit, masks put in their place."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from ovip.scene.types import Box2
from services.perception.onboard import (
    OnboardDetection,
    OnboardMask,
    check_onboard,
    decode_onboard,
    encode_onboard,
    feature_of,
    mask_of,
    second_feature_of,
)
from tests.builders import camera, png, png_claiming

K = camera()
CUP = OnboardDetection("cup", 0.9, Box2(10, 10, 30, 30))
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)
DETECTIONS = st.builds(
    OnboardDetection,
    st.text(max_size=20),
    FLOATS,
    st.builds(Box2, FLOATS, FLOATS, FLOATS, FLOATS),
    st.none() | st.builds(OnboardMask, st.integers(0, 9999), st.integers(0, 9999), st.binary(max_size=30)),
    st.lists(FLOATS, max_size=5).map(tuple),
    st.lists(FLOATS, max_size=3).map(tuple),
)


@given(st.lists(DETECTIONS, max_size=6))
def test_detections_come_back_from_their_bytes_the_same(detections: list[OnboardDetection]) -> None:
    data = encode_onboard(detections)

    assert decode_onboard(data) == tuple(detections)
    assert encode_onboard(decode_onboard(data)) == data


def test_detections_kept_before_there_were_second_features_have_none() -> None:
    head = b'[{"label": "cup", "score": 0.9, "box": [10, 10, 30, 30], "mask": null, "dimension": 2}]'
    data = len(head).to_bytes(8, "little") + head + np.array([1, 2], "<f4").tobytes()

    assert decode_onboard(data) == (replace(CUP, feature=(1.0, 2.0)),)


def test_labels_are_normalised() -> None:
    assert check_onboard([replace(CUP, label=" Coffee_Mugs ")], K, 4)[0].label == "coffee mug"


def test_a_box_is_clipped_to_the_image_so_that_its_view_weighs_no_more_than_it_shows() -> None:
    (checked,) = check_onboard([replace(CUP, box=Box2(-1e30, 10, 1e30, 30))], K, 4)

    assert checked.box == Box2(0, 10, 64, 30)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"label": " "}, "detection 0: expected a label of 1 to 100 characters"),
        ({"label": "..."}, "detection 0: expected a label"),
        ({"label": "x" * 101}, "detection 0: expected a label"),
        ({"score": 1.01}, "expected a score of 0 to 1, got 1.01"),
        ({"score": -0.1}, "expected a score of 0 to 1"),
        ({"score": math.nan}, "expected a score of 0 to 1"),
        ({"box": Box2(10, 10, 10, 30)}, "expected a box with x0 < x1"),
        ({"box": Box2(30, 10, 10, 30)}, "expected a box with x0 < x1"),
        ({"box": Box2(math.nan, 10, 10, 30)}, "expected a box"),
        ({"box": Box2(0, 0, math.inf, 30)}, "expected a box"),
        ({"box": Box2(64, 0, 80, 30)}, "lies outside the image of 64x48"),
        ({"box": Box2(-9, 0, 0, 30)}, "lies outside the image of 64x48"),
        ({"feature": (1.0, 2.0)}, "expected no feature, or 4 finite numbers .* got 2"),
        ({"feature": (0.0,) * 4}, "expected no feature, or 4 finite numbers"),
        ({"feature": (math.nan, 1.0, 1.0, 1.0)}, "expected no feature, or 4 finite numbers"),
        ({"second_feature": (1.0, 2.0)}, "expected no second feature, or 3 finite numbers .* got 2"),
        ({"second_feature": (0.0,) * 3}, "expected no second feature, or 3 finite numbers"),
        ({"second_feature": (math.inf, 1.0, 1.0)}, "expected no second feature, or 3 finite numbers"),
        ({"mask": OnboardMask(0, 0, b"")}, "mask of 'cup': expected a PNG of at most 64x48, got 0 bytes"),
        ({"mask": OnboardMask(60, 0, png(np.ones((5, 5), np.uint8)))}, r"5x5 at \(60, 0\) leaves the image"),
        ({"mask": OnboardMask(2**32 - 1, 0, png(np.ones((5, 5), np.uint8)))}, "leaves the image"),
        ({"mask": OnboardMask(0, 0, png_claiming(60_000, 60_000, 8, 0))}, "got .* bytes of 60000x60000"),
    ],
)
def test_a_detection_that_is_wrong_is_refused_in_words(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        check_onboard([replace(CUP, **change)], K, 4, second_dimension=3)


def test_second_features_of_a_stack_without_a_second_encoder_are_of_any_size_but_one() -> None:
    seen = [CUP, replace(CUP, second_feature=(1.0,) * 5), replace(CUP, second_feature=(0.5,) * 5)]

    assert [len(d.second_feature) for d in check_onboard(seen, K, 4)] == [0, 5, 5]
    with pytest.raises(
        InvalidInput, match=r"detection 3 \(cup\): expected no second feature, or 5 finite .* got 2"
    ):
        check_onboard([*seen, replace(CUP, second_feature=(1.0, 2.0))], K, 4)


def test_the_words_name_which_detection_is_wrong() -> None:
    with pytest.raises(InvalidInput, match=r"detection 2 \(lamp\)"):
        check_onboard([CUP, CUP, replace(CUP, label="lamp", score=7.0)], K, 4)


def test_too_many_detections_are_refused() -> None:
    with pytest.raises(InvalidInput, match="expected at most 500 a frame, got 501"):
        check_onboard([CUP] * 501, K, 4)


def test_a_frame_in_which_nothing_was_seen_is_fine() -> None:
    assert check_onboard([], K, 4) == ()
    assert decode_onboard(encode_onboard([])) == ()


def test_a_mask_lies_where_its_corner_is() -> None:
    small = np.array([[255, 0], [0, 1]], np.uint8)

    mask = mask_of(replace(CUP, mask=OnboardMask(10, 20, png(small))), K)

    assert mask is not None
    assert sorted(zip(*np.nonzero(mask), strict=True)) == [(20, 10), (21, 11)]
    assert mask_of(CUP, K) is None


def test_a_feature_becomes_a_unit_vector() -> None:
    feature = feature_of(replace(CUP, feature=(0.0, 3.0, 4.0, 0.0)))

    assert feature == pytest.approx([0, 0.6, 0.8, 0])
    assert feature_of(CUP) is None


def test_a_second_feature_becomes_a_unit_vector() -> None:
    assert second_feature_of(replace(CUP, second_feature=(3.0, 4.0))) == pytest.approx([0.6, 0.8])
    assert second_feature_of(CUP) is None
