from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lab.evaluation.asking.questions import (
    Kind,
    Question,
    QuestionParams,
    absent_questions,
    present_questions,
)
from lab.evaluation.asking.truth import Truth, truth_of_room
from lab.simulation.home import HomeObject, Relation, RelationKind
from lab.simulation.room import SimulatedRoom
from services.perception.adapters.full.naming import indoor_vocabulary

ALL = QuestionParams(most=dict.fromkeys(Kind, 1000))
VOCABULARY = indoor_vocabulary().words


def thing(object_id: int, label: str, *attributes: str) -> HomeObject:
    box = np.array([object_id, 0, 0, object_id + 0.5, 1, 1], float)
    return HomeObject(object_id, label, attributes, False, box, 1.0, 0, 0)


TRUTH = Truth(
    (
        thing(1, "towel", "floral"),
        thing(2, "towel", "plain"),
        thing(3, "bottle", "red"),
        thing(4, "book"),
        thing(5, "book"),
        thing(6, "nightstand", "brown"),
        thing(7, "sofa", "blue"),
    ),
    (Relation(4, RelationKind.ON, 6), Relation(3, RelationKind.ON, 6), Relation(6, RelationKind.NEXT, 7)),
    {0: 0.0},
)


def present(**kinds: int) -> dict[str, Question]:
    asked = present_questions(TRUTH, range(1, 8), 0, ALL)
    return {q.text: q for q in asked if not kinds or q.kind.value in kinds}


def test_a_class_is_answered_by_all_of_it() -> None:
    assert present()["towel"] == Question("towel", Kind.CLASS, "towel", (1, 2))
    assert {q.text for q in present(**{"class": 1}).values()} == {
        "towel",
        "bottle",
        "book",
        "nightstand",
        "sofa",
    }


def test_an_attribute_is_asked_where_it_tells_instances_apart() -> None:
    assert present()["floral towel"] == Question("floral towel", Kind.ATTRIBUTE, "towel", (1,), (2,))
    assert set(present(attribute=1)) == {"floral towel", "plain towel"}  # there is but one bottle


def test_a_relation_is_asked_where_it_tells_instances_apart() -> None:
    assert set(present(relation=1)) == {"the book on the nightstand"}
    assert present()["the book on the nightstand"].meant == (4,)
    assert present()["the book on the nightstand"].alike == (5,)


def test_another_word_is_one_that_nothing_there_is_called_by() -> None:
    asked = present(other_word=1)
    assert asked["couch"].meant == (7,)
    assert asked["bedside table"].meant == (6,)
    assert "sofa" not in asked


def test_only_what_the_camera_was_shown_is_asked_for() -> None:
    asked = {q.text for q in present_questions(TRUTH, [2], 0, ALL)}
    assert {"towel", "plain towel"} <= asked
    assert not {"floral towel", "book", "sofa"} & asked


def test_the_same_seed_asks_the_same_and_never_more_than_was_wished() -> None:
    few = QuestionParams(most={Kind.CLASS: 2, Kind.ATTRIBUTE: 1})
    first = present_questions(TRUTH, range(1, 8), 5, few)
    assert first == present_questions(TRUTH, range(1, 8), 5, few)
    assert [q.kind for q in first] == [Kind.CLASS, Kind.CLASS, Kind.ATTRIBUTE]
    assert len(present_questions(TRUTH, range(1, 8), 5, ALL, most=4)) == 4


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 12))
def test_what_is_absent_is_balanced_and_truly_not_there(seed: int, count: int) -> None:
    asked = absent_questions(TRUTH, VOCABULARY, seed, count)
    assert len(asked) == count
    assert len({q.text for q in asked}) == count
    assert not any(q.present for q in asked)
    colours = [q for q in asked if q.kind is Kind.ATTRIBUTE]
    assert len(colours) == min(count // 2, 3)  # of the bottle, the nightstand and the sofa
    for question in colours:
        word, label = question.text.split(" ", 1)
        assert word not in {a for t in TRUTH.things if t.label == label for a in t.attributes}


@pytest.mark.parametrize("word", ["sofa", "couch", "bedside table", "water bottle", "door", "notebook"])
def test_no_word_that_might_be_said_of_something_there_counts_as_absent(word: str) -> None:
    asked = absent_questions(TRUTH, (word, "piano"), 0, 2)
    assert word not in {q.text for q in asked}
    assert "piano" in {q.text for q in asked}


def test_the_small_room_knows_what_lies_on_what() -> None:
    truth = truth_of_room(SimulatedRoom(0))
    lying = {(truth.thing(r.subject).label, truth.thing(r.object).label) for r in truth.relations}
    assert {("book", "nightstand"), ("mug", "table"), ("tv", "tv stand"), ("vase", "bookshelf")} <= lying
    assert ("table", "mug") not in lying
    assert truth.centres([]).shape == (0, 3)
