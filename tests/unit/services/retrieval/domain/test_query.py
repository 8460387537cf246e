from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from services.retrieval.domain.query import ANYTHING, AttributeKind, RelationKind, parse


@pytest.mark.parametrize(
    ("text", "noun", "attributes"),
    [
        ("white mug", "mug", ["white"]),
        ("where is the floral towel?", "towel", ["floral"]),
        ("Where are the Chairs", "chair", []),
        ("show me where the mugs are", "mug", []),
        ("can you find me the large red wine glass", "wine glass", ["large", "red"]),
        ("hey, please find a cup of tea", "cup", ["of tea"]),
        ("a pair of scissors", "scissors", []),
        ("reddish chair", "chair", ["red"]),
        ("dark blue sofa", "sofa", ["blue"]),
        ("two-tier shelf", "shelf", ["two-tier"]),
        ("black and white picture", "picture", ["black-and-white"]),
        ("Where did I leave my keys?", "key", []),
        ("  TV!! ", "tv", []),
    ],
)
def test_question_words_go_and_qualities_come_off(text: str, noun: str, attributes: list[str]) -> None:
    target = parse(text)
    assert target.noun == noun
    assert [attribute.word for attribute in target.attributes] == attributes


@pytest.mark.parametrize("text", ["orange", "an orange", "glass", "paper towel", "hot dog", "box of tissues"])
def test_a_quality_that_is_the_thing_itself_stays_the_noun(text: str) -> None:
    assert not parse(text).attributes


def test_kinds_of_attribute_are_told_apart() -> None:
    kinds = [attribute.kind for attribute in parse("small grey striped bag").attributes]
    assert kinds == [AttributeKind.SIZE, AttributeKind.COLOUR, AttributeKind.OTHER]


def test_relations_keep_their_order_and_their_anchors() -> None:
    target = parse("book on the wooden shelf in the office")
    assert target.noun == "book"
    assert [(r.kind, r.anchor) for r in target.relations] == [
        (RelationKind.ON, "shelf"),
        (RelationKind.IN, "office"),
    ]
    assert target.relations[0].anchor_attributes[0].word == "wooden"


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("cup next to the sink", RelationKind.NEXT_TO),
        ("cup near the sink please", RelationKind.NEXT_TO),
        ("box under the table", RelationKind.UNDER),
        ("clock above the door", RelationKind.ABOVE),
        ("chair behind the sofa", RelationKind.OTHER),
        ("cup that is standing on top of the table", RelationKind.ON),
    ],
)
def test_prepositions_have_kinds(text: str, kind: RelationKind) -> None:
    assert [relation.kind for relation in parse(text).relations] == [kind]


def test_a_question_without_a_noun_asks_for_anything_there() -> None:
    target = parse("what is on the table?")
    assert (target.noun, target.relations[0].anchor) == (ANYTHING, "table")
    assert parse("something red").noun == ANYTHING


@pytest.mark.parametrize(
    ("text", "purpose"),
    [
        ("something to charge my phone", "charge my phone"),
        ("somewhere to sit", "sit"),
        ("where can I wash my hands?", "wash my hands"),
    ],
)
def test_a_use_without_a_thing_is_a_purpose(text: str, purpose: str) -> None:
    assert parse(text).purpose == purpose


@pytest.mark.parametrize("text", ["", "   ", "where is the?", "something", "???"])
def test_nothing_to_look_for_is_refused_saying_what_was_expected(text: str) -> None:
    with pytest.raises(InvalidInput, match="expected a thing to look for"):
        parse(text)


def test_text_over_500_characters_is_refused() -> None:
    assert parse("mug " + "x" * 496).noun
    with pytest.raises(InvalidInput, match="at most 500 characters, got 501"):
        parse("x" * 501)


@given(st.text(max_size=500))
def test_any_text_is_parsed_or_refused_and_a_noun_is_never_empty(text: str) -> None:
    try:
        target = parse(text)
    except InvalidInput:
        return
    assert target.noun
