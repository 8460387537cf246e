"""What the demo asks and how it prints what was answered; the whole of it runs as `make demo`."""

from __future__ import annotations

import json

import numpy as np
import pytest

from lab import demo
from lab.simulation import SimulatedRoom
from ovip.scene.answers import (
    Answer,
    Candidate,
    Coverage,
    Outcome,
    RegionCoverage,
    TierReport,
    TierResult,
)

NO_PATH = np.zeros((0, 3))


def test_five_questions_are_asked_of_either_scene() -> None:
    assert len(demo.KITCHEN_QUESTIONS) == len([*demo.HOME_QUESTIONS, demo.HOME_ABSENT]) == 5
    assert len([*demo.TOUR_QUESTIONS, demo.HOME_ABSENT]) == 5


def test_the_tour_shows_what_is_asked_for_and_no_piano() -> None:
    things = json.loads((demo.TOUR / "objects.json").read_text())
    visible = json.loads((demo.TOUR / "visibility.json").read_text())
    labels = {
        thing["label"] for thing in things if visible.get(str(thing["object_id"]), {}).get("frames", 0) > 5
    }
    assert demo.TOUR_QUESTIONS == ("plant", "sofa", "television", "piano")
    assert {"plant", "sofa", "tv"} <= labels
    assert "piano" not in {thing["label"] for thing in things}


def test_the_home_has_a_mug_but_not_the_one_that_is_searched_for() -> None:
    mugs = {thing.color for thing in SimulatedRoom().objects if thing.label == "mug"}
    assert demo.HOME_ABSENT == "blue mug"
    assert mugs == {"white", "red"}


def test_a_found_thing_is_printed_with_its_place_and_the_tier_that_found_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    mug = Candidate("mug", np.array([4.994, 2.5, 0.8]), 1.0, "", "o1")
    reports = (_report(1, "two mugs"), _report(2, "red by its mean colour"))
    answer = Answer(Outcome.FOUND, 2, mug, None, NO_PATH, reports, fallbacks=("colours: no VLM",))
    printed = _printed("red mug", answer, capsys, monkeypatch)
    assert "red mug                   found       2     mug at 4.99, 2.50, 0.80" in printed
    assert "red by its mean colour" in printed
    assert "two mugs" not in printed
    assert "fallback: colours: no VLM" in printed


def test_an_absence_is_printed_with_what_it_rests_on(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    regions = (RegionCoverage("a", "kitchen", 10.0, 0.5, 0.9), RegionCoverage("b", "hall", 20.0, 1.0, 0.1))
    coverage = Coverage(12, 12, 0, regions, 0.25, True)
    answer = Answer(Outcome.ABSENT, 4, None, None, NO_PATH, (_report(4, "all visited"),), coverage=coverage)
    printed = _printed("piano", answer, capsys, monkeypatch)
    assert "piano                     absent      4     -" in printed
    assert "all visited; 25 of 30 m2 seen, P(present) 0.25" in printed


def _report(tier: int, why: str) -> TierReport:
    return TierReport(tier, TierResult.FOUND, why, 0, 1.0)


def _printed(
    text: str, answer: Answer, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> str:
    monkeypatch.setattr(demo, "console", demo.Console(width=120, highlight=False))
    demo._print_answers([demo.Asked(text, answer)])
    return capsys.readouterr().out
