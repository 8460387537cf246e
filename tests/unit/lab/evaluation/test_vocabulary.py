from __future__ import annotations

import numpy as np

from lab.evaluation.asking.worlds import WorldSpec, place_of
from lab.evaluation.experiments.vocabulary import compare
from lab.evaluation.scores.vocabulary import (
    VocabularyScore,
    is_false,
    means_exactly,
    means_loosely,
    vocabulary_score,
)

BOX = np.array([0.0, 0, 0, 1, 1, 1])


def test_precision_counts_words_and_recall_labels() -> None:
    words, labels = ["mug", "sofa", "text", "couch"], ["mug", "sofa", "lamp"]
    assert vocabulary_score(words, labels, means_exactly) == VocabularyScore(0.5, 2 / 3)
    assert vocabulary_score(words, labels, means_loosely) == VocabularyScore(0.75, 2 / 3)
    assert vocabulary_score([], [], means_exactly) == VocabularyScore(0.0, 0.0)


def test_an_object_is_false_where_nothing_of_its_word_is() -> None:
    things = [("sofa", BOX), ("mug", BOX + 5)]
    assert not is_false("sofa", BOX + 0.5, things, means_exactly)
    assert is_false("mug", BOX, things, means_exactly)
    assert is_false("couch", BOX, things, means_exactly)
    assert not is_false("couch", BOX, things, means_loosely)
    assert is_false("sofa", BOX, [], means_loosely)


def test_the_gate_grounds_less_and_nothing_that_it_would_not_ground_without() -> None:
    place = place_of(WorldSpec("room", 3))
    on, off = compare(place, place.world.walk()[:24])
    assert (on["config"], off["config"]) == ("gate on", "gate off")
    assert on["tags"] == off["tags"] == off["words"]
    assert 0 < on["words"] < off["words"]
    assert on["pairs"] < off["pairs"]
    assert on["precision"] > off["precision"]
    assert on["unconfirmed"] < off["unconfirmed"]
    assert on["strict"]["precision"] <= on["precision"]


def test_the_same_place_gives_the_same_rows() -> None:
    poses = place_of(WorldSpec("room", 3)).world.walk()[:5]
    assert compare(place_of(WorldSpec("room", 3)), poses) == compare(place_of(WorldSpec("room", 3)), poses)
