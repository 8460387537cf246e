from __future__ import annotations

import numpy as np
import pytest

from services.retrieval.domain.confirm import (
    ConfirmParams,
    confirm_by_features,
    distractors,
    target_words,
    without_label,
)
from services.retrieval.domain.judgement import Verdict

OTHERS = np.array([[np.cos(a), np.sin(a)] for a in np.radians([20, 40, 60, 80, 100])], np.float32)
TARGET = np.array([[1.0, 0.0]], np.float32)


def view(degrees: float) -> np.ndarray:
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], np.float32)


def test_the_share_of_more_alike_words_decides() -> None:
    near = confirm_by_features("cup", [view(5)], TARGET, OTHERS)
    assert (near.verdict, near.score) == (Verdict.ACCEPT, 1.0)
    # at 25 degrees the words at 20 and 40 degrees are nearer than the target: 2 of 5
    between = confirm_by_features("cup", [view(25)], TARGET, OTHERS)
    assert between.verdict is Verdict.UNSURE
    assert abs(between.score - 0.6) < 1e-6
    assert confirm_by_features("cup", [view(90)], TARGET, OTHERS).verdict is Verdict.REJECT


def test_several_views_count_by_their_mean() -> None:
    assert confirm_by_features("cup", [view(-20), view(25)], TARGET, OTHERS).verdict is Verdict.ACCEPT


def test_without_a_usable_feature_nothing_is_settled() -> None:
    assert confirm_by_features("cup", [np.zeros(2, np.float32)], TARGET, OTHERS).verdict is Verdict.UNSURE
    assert confirm_by_features("cup", [np.ones(3, np.float32)], TARGET, OTHERS).verdict is Verdict.UNSURE
    assert confirm_by_features("cup", [], TARGET, OTHERS).verdict is Verdict.UNSURE


def test_synonyms_are_the_target_and_never_distract_from_it() -> None:
    assert "cup" in target_words("mug")
    assert not {"cup", "mug"} & set(distractors("mug"))
    assert "bottle" in distractors("mug")


@pytest.mark.parametrize("degrees", [0, 30, 70, 100])
def test_the_label_that_was_mixed_in_is_taken_out_again(degrees: float) -> None:
    label, image = view(0), view(degrees)
    mixed = 0.75 * label + 0.25 * image
    back = without_label(np.asarray(mixed / np.linalg.norm(mixed), np.float32), label, 0.75)
    np.testing.assert_allclose(back, image, atol=2e-3)


def test_an_even_mix_is_taken_out_too_and_no_mix_is_left_alone() -> None:
    mixed = view(0) + view(90)
    even = without_label(np.asarray(mixed / np.linalg.norm(mixed), np.float32), view(0), 0.5)
    np.testing.assert_allclose(even, view(90), atol=1e-5)
    np.testing.assert_array_equal(without_label(view(20), view(0), 0.0), view(20))


def test_only_the_space_that_mixes_labels_in_has_a_share() -> None:
    assert ConfirmParams().share_in("minilm-l6-v2-int8+conse") == 0.75
    assert ConfirmParams().share_in("laion/CLIP-ViT-H-14") == 0.0
