"""Words in a prompt, and token scores as word scores, worked by hand."""

from __future__ import annotations

import numpy as np
import pytest

from services.perception.adapters.full.calibration import KEEP, Calibration
from services.perception.adapters.full.naming import NamingParams, indoor_vocabulary, named
from services.perception.adapters.full.prompts import prompt_of, prompts_of, token_masks, word_scores


def test_each_word_is_found_again_where_its_span_says() -> None:
    prompt = prompt_of(["Cup", "dining table"])
    assert prompt.text == "cup. dining table."
    assert [prompt.text[start:end] for start, end in prompt.spans] == ["cup", "dining table"]


def test_a_stop_inside_a_word_does_not_end_it() -> None:
    assert prompt_of(["no. 7 bus"]).text == "no  7 bus."


def test_no_words_make_an_empty_prompt() -> None:
    assert prompt_of([]).text == ""
    assert prompts_of([], 10, len) == []


def test_prompts_are_filled_in_turn_up_to_the_longest() -> None:
    made = prompts_of(["cup", "bed", "sofa"], longest=9, tokens=len)
    assert [prompt.words for prompt in made] == [("cup", "bed"), ("sofa",)]
    assert len(made[0].text) == 9


def test_a_word_longer_than_the_limit_stands_alone() -> None:
    made = prompts_of(["cup", "refrigerator", "bed"], longest=6, tokens=len)
    assert [prompt.words for prompt in made] == [("cup",), ("refrigerator",), ("bed",)]


def test_special_tokens_and_stops_belong_to_no_word() -> None:
    # [CLS] cup . dining table . [SEP]
    offsets = [(0, 0), (0, 3), (3, 4), (5, 11), (12, 17), (17, 18), (0, 0)]
    masks = token_masks(prompt_of(["cup", "dining table"]).spans, offsets)
    assert masks.tolist() == [
        [False, True, False, False, False, False, False],
        [False, False, False, True, True, False, False],
    ]


def test_a_words_score_is_the_mean_over_its_tokens() -> None:
    masks = np.array([[False, True, False, False], [False, False, True, True]])
    scores = word_scores(np.array([[0.9, 0.4, 0.2, 0.6]], np.float32), masks)
    assert scores == pytest.approx(np.array([[0.4, 0.4]]))


def test_a_word_without_tokens_scores_nothing() -> None:
    assert word_scores(np.ones((1, 2), np.float32), np.zeros((1, 2), bool)).tolist() == [[0.0]]


def test_a_backends_own_threshold_means_just_kept() -> None:
    scale = Calibration(0.2)
    confidence = scale.confidence(np.array([0.0, 0.1, 0.2, 0.6, 1.0], np.float32))
    assert confidence == pytest.approx([0.0, KEEP / 2, KEEP, (1 + KEEP) / 2, 1.0])


def test_a_view_names_its_largest_shares_only() -> None:
    shares = np.array([[0.5, 0.3, 0.2], [0.1, 0.1, 0.8]], np.float32)
    assert named(shares, ["bed", "cup", "vase"], NamingParams(0.25, 1)) == ("bed", "vase")
    assert named(shares, ["bed", "cup", "vase"], NamingParams(0.25, 2)) == ("bed", "cup", "vase")


def test_a_distractor_takes_its_share_and_is_not_named() -> None:
    shares = np.array([[0.1, 0.05, 0.85]], np.float32)
    assert named(shares, ["bed", "cup"], NamingParams(0.2, 5)) == ()


def test_equal_shares_go_to_the_first_word() -> None:
    shares = np.array([[0.5, 0.5]], np.float32)
    assert named(shares, ["cup", "bed"], NamingParams(0.2, 1)) == ("cup",)


def test_the_vocabulary_is_normalised_and_names_nothing_twice() -> None:
    from ovip.scene.words import normalize_word

    vocabulary = indoor_vocabulary()
    assert len(vocabulary.words) >= 300
    assert len(set(vocabulary.words)) == len(vocabulary.words)
    assert [word for word in vocabulary.words if normalize_word(word) != word] == []
    assert not set(vocabulary.words) & set(vocabulary.distractors)
