"""Detections made on board: the JSON form and COCO run lengths."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra.numpy import array_shapes, arrays

from ovip.errors import InvalidInput
from ovip.recordings import OnboardDetection
from ovip.recordings.onboard import decode_runs, encode_runs, read_onboard, write_onboard
from ovip.scene.types import Bools, Box2


def test_runs_go_down_the_columns_and_begin_outside_by_hand() -> None:
    mask = np.array([[True, False, False], [True, True, False]])
    # columns: 1 1 | 0 1 | 0 0
    assert encode_runs(mask) == {"size": [2, 3], "counts": [0, 2, 1, 1, 2]}
    assert encode_runs(~mask) == {"size": [2, 3], "counts": [2, 1, 1, 2]}


@given(arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=12)))
def test_any_mask_comes_back(mask: Bools) -> None:
    np.testing.assert_array_equal(decode_runs(encode_runs(mask), "here"), mask)


@pytest.mark.parametrize("with_mask", [True, False])
@pytest.mark.parametrize("with_feature", [True, False])
def test_detections_come_back(tmp_path: Path, with_mask: bool, with_feature: bool) -> None:
    mask = np.eye(5, dtype=bool) if with_mask else None
    feature = np.array([0.25, -1.5], np.float32) if with_feature else None
    path = tmp_path / "0.json"
    second = None if feature is None else feature[:1]
    write_onboard(path, [OnboardDetection("red mug", 0.5, Box2(1, 2, 3, 4.5), mask, feature, second)])
    (got,) = read_onboard(path)
    assert (got.label, got.score, got.box2) == ("red mug", 0.5, Box2(1, 2, 3, 4.5))
    assert (got.mask is None, got.feature is None) == (not with_mask, not with_feature)
    assert (got.second_feature is None) == (not with_feature)
    if mask is not None and got.mask is not None:
        np.testing.assert_array_equal(got.mask, mask)
    if feature is not None and got.feature is not None:
        np.testing.assert_array_equal(got.feature, feature)
        np.testing.assert_array_equal(got.second_feature, second)


@pytest.mark.parametrize(
    ("item", "message"),
    [
        ({"score": 1, "box": [0, 0, 1, 1]}, "expected a detection with a 'label'"),
        ({"label": "mug", "score": 1, "box": [0, 0, 1]}, "expected 'box'"),
        ({"label": "mug", "box": [0, 0, 1, 1]}, "expected a number under 'score'"),
        ({"label": "mug", "score": 1, "box": [0, 0, 1, 1], "mask": "abc"}, "expected a mask"),
        (
            {"label": "mug", "score": 1, "box": [0, 0, 1, 1], "mask": {"size": [2, 2], "counts": [3]}},
            "expected runs over 2x2 pixels, got 3 pixels",
        ),
        ({"label": "mug", "score": 1, "box": [0, 0, 1, 1], "feature": ["a"]}, "expected 'feature'"),
        (
            {"label": "mug", "score": 1, "box": [0, 0, 1, 1], "second_feature": []},
            "expected 'second_feature'",
        ),
    ],
)
def test_wrong_detections_say_what_was_expected(tmp_path: Path, item: object, message: str) -> None:
    path = tmp_path / "000000.json"
    path.write_text(json.dumps({"detections": [item]}))
    with pytest.raises(InvalidInput, match=message):
        read_onboard(path)
