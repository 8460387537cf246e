"""The shared normaliser: tags, labels and queries meet in one form."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from ovip.scene.words import normalize_word


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (" Coffee_Mugs. ", "coffee mug"),
        ("CHAIR", "chair"),
        ("dining   tables", "dining table"),
        ("boxes", "box"),
        ("dishes", "dish"),
        ("couches", "couch"),
        ("mattresses", "mattress"),
        ("batteries", "battery"),
        ("ties", "tie"),
        ("potatoes", "potato"),
        ("shoes", "shoe"),
        ("bookshelves", "bookshelf"),
        ("knives", "knife"),
        ("vases", "vase"),
        ("houses", "house"),
        ("tvs", "tv"),
        ("cookies", "cookie"),
        ("movies", "movie"),
        ("sizes", "size"),
        ("quizzes", "quiz"),
        ("buses", "bus"),
        ("lenses", "lens"),
        ('"remote-control"', "remote-control"),
        ("t-shirts", "t-shirt"),
    ],
)
def test_a_plural_becomes_its_singular(text: str, word: str) -> None:
    assert normalize_word(text) == word


@pytest.mark.parametrize(
    "word", ["glass", "scissors", "sunglasses", "bus", "gas", "christmas tree", "tennis", "cactus", "tv"]
)
def test_a_singular_that_looks_like_a_plural_stays(word: str) -> None:
    assert normalize_word(word) == word


def test_only_the_last_word_becomes_singular() -> None:
    assert normalize_word("sports balls") == "sports ball"


@pytest.mark.parametrize("text", ["", "   ", "...", "_", "'!?'"])
def test_nothing_stays_nothing(text: str) -> None:
    assert normalize_word(text) == ""


@given(st.text(max_size=30))
@example("mug's")
@example("mug.s")
@example("x" * 5 + "_s")
@example("İs")
def test_normalising_twice_is_normalising_once(text: str) -> None:
    once = normalize_word(text)

    assert normalize_word(once) == once


@given(st.from_regex(r"[a-z]{1,6}(es|s|ies|ves|'s|zes)?( [a-z]{1,6}(es|s|ies|oes|xes)?)?", fullmatch=True))
def test_normalising_words_twice_is_normalising_once(text: str) -> None:
    once = normalize_word(text)

    assert normalize_word(once) == once


@given(st.text(alphabet="abcdefgs _-.'", max_size=20))
def test_case_and_surrounding_space_do_not_matter(text: str) -> None:
    assert normalize_word(f"  {text.upper()}\n") == normalize_word(text)
