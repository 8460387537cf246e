from __future__ import annotations

import numpy as np

from services.retrieval.domain.tags import TagParams, bridge, score_frames


def test_frames_score_by_their_best_tag() -> None:
    scores, words = score_frames("mug", [("cup", "table"), ("chair",), (), ("mug",)], None)
    assert scores.tolist() == [0.95, 0.0, 0.0, 1.0]
    assert words == ("cup", "", "", "mug")


def test_hot_frames_bridge_gaps_up_to_the_tolerance() -> None:
    scores = np.array([1, 0, 0, 1, 0, 0, 0, 1.0])
    words = ["mug" if score else "" for score in scores]
    assert [(s.first, s.last) for s in bridge(scores, words, TagParams(gap=2))] == [(0, 3), (7, 7)]
    assert [(s.first, s.last) for s in bridge(scores, words, TagParams(gap=3))] == [(0, 7)]


def test_the_best_frame_is_the_hottest_and_a_tie_goes_to_the_middle() -> None:
    assert bridge(np.array([0.9, 1.0, 0.9]), ["a", "b", "c"])[0].best == 1
    assert bridge(np.array([1.0, 1.0, 1.0]), ["a"] * 3)[0].best == 1
    assert bridge(np.array([1.0, 1.0]), ["a"] * 2)[0].best == 0


def test_segments_are_ranked_by_score_then_by_length() -> None:
    scores = np.array([0.9, 0, 0.9, 0.9, 0, 1.0])
    ranked = bridge(scores, ["x"] * 6, TagParams(gap=0))
    assert [(s.first, s.last) for s in ranked] == [(5, 5), (2, 3), (0, 0)]


def test_cold_frames_make_no_segment() -> None:
    assert bridge(np.zeros(4), [""] * 4) == ()
    assert bridge(np.zeros(0), []) == ()
    scores, words = score_frames("mug", [], None)
    assert (len(scores), words) == (0, ())
