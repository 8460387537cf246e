from __future__ import annotations

import pytest

from ovip.errors import Corrupt
from services.retrieval.domain.judgement import AGREED, Judgement, Verdict, combine
from services.retrieval.domain.questions import (
    ask_about_crops,
    ask_for_priors,
    ask_for_things,
    read_crops,
    read_priors,
    read_things,
)


def test_crops_are_numbered_and_read_back_in_order() -> None:
    question = ask_about_crops("white mug", 3)
    assert "white mug" in question.prompt
    assert "3 crops" in question.prompt
    reply = {
        "verdicts": [
            {"image": 3, "matches": "no", "confidence": 0.8, "reason": "a bowl"},
            {"image": 1, "matches": "yes", "confidence": 0.9, "reason": "white mug"},
        ]
    }
    first, second, third = read_crops(reply, 3)
    assert (first.verdict, first.score) == (Verdict.ACCEPT, pytest.approx(0.95))
    assert second.verdict is Verdict.UNSURE
    assert (third.verdict, third.score) == (Verdict.REJECT, pytest.approx(0.1))


def test_priors_name_their_regions() -> None:
    question = ask_for_priors("mug", [("r1", "kitchen", "kitchen", ["oven"]), ("r2", "hall", "", [])])
    assert "r1" in question.prompt
    assert "oven" in question.prompt
    assert "nothing yet" in question.prompt
    assert read_priors({"regions": [{"region_id": "r1", "likelihood": 0.9}]}) == {"r1": 0.9}


def test_things_are_normalised_and_given_once() -> None:
    assert "charge my phone" in ask_for_things("something to charge my phone").prompt
    assert read_things({"objects": ["Chargers", "charger", "Power Outlet"]}) == ("charger", "power outlet")


@pytest.mark.parametrize("reply", [None, {}, {"verdicts": [{"image": "x"}]}, []])
def test_a_reply_that_was_not_asked_for_is_corrupt(reply: object) -> None:
    with pytest.raises(Corrupt):
        read_crops(reply, 1)


def test_judgements_combine_to_the_strictest() -> None:
    yes, no = Judgement(Verdict.ACCEPT, 0.9, "a"), Judgement(Verdict.REJECT, 0.1, "b")
    unsure = Judgement(Verdict.UNSURE, 0.5, "c", ("c",))
    assert combine([]) is AGREED
    assert combine([yes, yes]).verdict is Verdict.ACCEPT
    assert combine([yes, unsure]).verdict is Verdict.UNSURE
    assert combine([yes, unsure, no]) == Judgement(Verdict.REJECT, 0.1, "a; c; b", ("c",))
