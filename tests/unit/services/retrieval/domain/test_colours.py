from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.retrieval.domain.colours import closest_colour, judge_colour, membership
from services.retrieval.domain.judgement import Verdict
from services.retrieval.domain.query import COLOURS


@pytest.mark.parametrize(
    ("rgb", "colour"),
    [
        ((255, 255, 255), "white"),
        ((0, 0, 0), "black"),
        ((128, 128, 128), "grey"),
        ((255, 0, 0), "red"),
        ((139, 0, 0), "red"),
        ((255, 192, 203), "pink"),
        ((255, 140, 0), "orange"),
        ((139, 69, 19), "brown"),
        ((255, 255, 0), "yellow"),
        ((0, 128, 0), "green"),
        ((0, 0, 255), "blue"),
        ((135, 206, 235), "blue"),
        ((128, 0, 128), "purple"),
        # measured in a real kitchen under warm light
        ((200, 197, 193), "white"),
        ((110, 73, 57), "brown"),
        ((104, 98, 92), "grey"),
    ],
)
def test_a_colour_is_called_by_its_name(rgb: tuple[int, int, int], colour: str) -> None:
    assert closest_colour(rgb) == colour


def test_the_white_mug_of_two_is_the_white_one_and_the_patterned_is_not_settled() -> None:
    white, patterned = judge_colour("white", np.array([[200.0, 197.0, 193.0], [173.0, 162.0, 147.0]]))
    assert white.verdict is Verdict.ACCEPT
    assert patterned.verdict is not Verdict.ACCEPT
    assert white.score > patterned.score + 0.3


def test_in_a_dark_exposure_the_lightest_of_its_kind_still_counts_as_white() -> None:
    dim, dark = np.array([140.0, 137.0, 130.0]), np.array([100.0, 90.0, 80.0])
    assert judge_colour("white", np.array([dim]))[0].verdict is Verdict.UNSURE
    assert judge_colour("white", np.array([dim, dark]))[0].verdict is Verdict.ACCEPT


def test_two_equally_white_things_are_both_white() -> None:
    judgements = judge_colour("white", np.array([[230.0, 230.0, 230.0]] * 2))
    assert [j.verdict for j in judgements] == [Verdict.ACCEPT] * 2
    assert judgements[0].score == judgements[1].score


def test_a_red_thing_is_not_white_however_light_the_others_are_not() -> None:
    red, black = judge_colour("white", np.array([[178.0, 34.0, 34.0], [10.0, 10.0, 10.0]]))
    assert red.verdict is Verdict.REJECT
    assert black.verdict is Verdict.REJECT


def test_no_instances_no_judgements() -> None:
    assert judge_colour("white", np.zeros((0, 3))) == ()


@given(st.tuples(*[st.integers(0, 255)] * 3), st.sampled_from(sorted(set(COLOURS.values()))))
def test_membership_stays_between_0_and_1(rgb: tuple[int, int, int], colour: str) -> None:
    value = float(membership(colour, np.array([rgb], dtype=np.float64))[0])
    assert 0.0 <= value <= 1.0
