from __future__ import annotations

import numpy as np
import pytest

from ovip.scene.types import F32
from services.retrieval.domain.names import (
    NameKind,
    NameParams,
    TextFeatures,
    match_name,
    match_names,
    nearest_name,
)

PARAMS = NameParams()


def texts(space: str = "minilm-l6-v2-int8+conse", **angles: float) -> TextFeatures:
    """Features in a plane, by angle in degrees: the cosine of two words is that of their difference."""
    features: dict[str, F32] = {
        word.replace("_", " "): np.array([np.cos(np.radians(a)), np.sin(np.radians(a))], np.float32)
        for word, a in angles.items()
    }
    return TextFeatures(space, features)


@pytest.mark.parametrize(
    ("noun", "name", "kind"),
    [
        ("cup", "cup", NameKind.EXACT),
        ("cup", "Cups", NameKind.EXACT),
        ("mug", "cup", NameKind.SYNONYM),
        ("sofa", "couch", NameKind.SYNONYM),
        ("screen", "tv", NameKind.SYNONYM),
        ("fridge", "refrigerator", NameKind.SYNONYM),
        ("table", "dining table", NameKind.KIND),
        ("glass", "wine glass", NameKind.KIND),
        ("chair", "armchair", NameKind.KIND),
        ("office chair", "chair", NameKind.BROADER),
    ],
)
def test_names_meet_without_text_features(noun: str, name: str, kind: NameKind) -> None:
    match = match_name(noun, name, None, PARAMS)
    assert match is not None
    assert match.kind is kind


@pytest.mark.parametrize(
    ("noun", "name"),
    [
        ("bear", "teddy bear"),
        ("dog", "hot dog"),
        ("piano", "keyboard"),
        ("table", "tablet"),
        ("cup", "cupboard"),
    ],
)
def test_words_that_only_look_alike_do_not_meet(noun: str, name: str) -> None:
    assert match_name(noun, name, None, PARAMS) is None


def test_a_word_of_the_vocabulary_never_matches_by_likeness() -> None:
    # hairbrush is .82 from toothbrush in MiniLM, but both are known to be things of their own
    near = texts(hairbrush=0.0, toothbrush=35.0, novel_thing=35.0)
    assert match_name("hairbrush", "toothbrush", near, PARAMS) is None
    assert match_name("novel thing", "toothbrush", near, PARAMS) is not None


def test_likeness_decides_at_the_threshold_of_its_text_space() -> None:
    at = float(np.degrees(np.arccos(0.75)))
    assert match_name("gizmo", "clock", texts(gizmo=0.0, clock=at - 0.1), PARAMS)
    assert match_name("gizmo", "clock", texts(gizmo=0.0, clock=at + 0.1), PARAMS) is None


def test_a_space_that_was_never_measured_matches_by_name_only() -> None:
    assert match_name("gizmo", "clock", texts("some-new-space", gizmo=0.0, clock=0.0), PARAMS) is None


def test_likeness_counts_the_nearest_synonym_of_the_name() -> None:
    match = match_name("timepiece", "television", texts(timepiece=0.0, television=90.0, screen=10.0), PARAMS)
    assert match is not None
    assert match.score == pytest.approx(np.cos(np.radians(10.0)), abs=1e-5)


def test_leftover_words_are_covered_where_the_whole_is_alike() -> None:
    alike = match_name("swivel chair", "chair", texts(swivel_chair=0.0, chair=20.0), PARAMS)
    assert alike is not None
    assert alike.leftover == ""
    unlike = match_name("high chair", "chair", texts(high_chair=0.0, chair=60.0), PARAMS)
    assert unlike is not None
    assert unlike.leftover == "high"


def test_names_that_are_only_alike_stand_back_behind_the_noun_itself() -> None:
    near = texts(gizmo=0.0, clock=5.0)
    assert [match.name for match in match_names("gizmo", ["clock", "gizmo"], near, PARAMS)] == ["gizmo"]


def test_ties_are_in_alphabetical_order_and_no_names_match_nothing() -> None:
    names = [match.name for match in match_names("glass", ["wine glass", "beer glass"], None, PARAMS)]
    assert names == ["beer glass", "wine glass"]
    assert match_names("glass", [], None, PARAMS) == ()
    assert nearest_name("glass", [], None) is None
