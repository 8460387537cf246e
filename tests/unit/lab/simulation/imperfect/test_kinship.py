"""The table of kin."""

from __future__ import annotations

from lab.simulation.imperfect.kinship import kin_of, kin_words, lookalikes, near_synonyms, part_words
from ovip.scene.words import normalize_word


def test_its_words_are_as_the_shared_normaliser_writes_them() -> None:
    assert [word for word in kin_words() if normalize_word(word) != word] == []


def test_near_synonyms_take_each_other_in() -> None:
    assert near_synonyms("sofa")[0] == "couch"
    assert "cup" in near_synonyms("mug") and "mug" in near_synonyms("cup")
    assert "mug" not in near_synonyms("mug")


def test_a_word_stands_once() -> None:
    for word in kin_words():
        kin = kin_of(word)
        assert kin is not None and kin.synonyms.count(word) == 1
        assert all(kin_of(other) == kin for other in kin.synonyms)


def test_a_sofa_is_taken_for_a_cushion_and_never_for_itself() -> None:
    assert lookalikes("sofa")[0] == "cushion"
    for word in kin_words():
        assert word not in lookalikes(word)
        assert not set(near_synonyms(word)) & set(lookalikes(word))


def test_an_unknown_word_has_no_kin() -> None:
    assert kin_of("zorblax") is None
    assert (
        near_synonyms("zorblax") == ()
        and lookalikes("zorblax") == ()
        and part_words("zorblax") == ("zorblax",)
    )


def test_a_piece_of_a_sofa_may_be_called_a_cushion() -> None:
    assert "cushion" in part_words("sofa")
