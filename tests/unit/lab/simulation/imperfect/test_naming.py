"""What a detector calls a thing."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from lab.simulation.imperfect import PERFECT, ImperfectParams
from lab.simulation.imperfect.kinship import kin_words, lookalikes, near_synonyms
from lab.simulation.imperfect.naming import called


def words(label: str, params: ImperfectParams, smallness: float = 0.0) -> list[str]:
    return [called(label, thing, smallness, params, 0, frame) for thing in range(60) for frame in range(30)]


def test_without_mistakes_a_thing_has_its_label() -> None:
    assert set(words("mug", PERFECT)) == {"mug"}
    assert set(words("Mugs", PERFECT, smallness=1.0)) == {"mug"}


@pytest.mark.parametrize("smallness", [0.0, 1.0])
def test_near_synonyms_come_at_their_level_and_twice_it_for_small_things(smallness: float) -> None:
    given = words("mug", ImperfectParams(synonym=0.2), smallness)
    wrong = [word for word in given if word != "mug"]
    assert set(wrong) <= set(near_synonyms("mug"))
    assert len(wrong) / len(given) == pytest.approx(0.2 * (1 + smallness), abs=0.05)


def test_lookalikes_and_any_words_come_at_theirs() -> None:
    given = words("sofa", ImperfectParams(lookalike=0.15, wrong=0.05))
    alike = [word for word in given if word in lookalikes("sofa")]
    assert len(alike) / len(given) == pytest.approx(0.15, abs=0.05)
    assert Counter(alike).most_common(1)[0][0] == "cushion"
    other = [word for word in given if word != "sofa" and word not in lookalikes("sofa")]
    assert other and set(other) <= set(kin_words())


def test_a_thing_s_wrong_word_is_mostly_the_same_again() -> None:
    params = ImperfectParams(synonym=0.5)
    repeats = []
    for thing in range(40):
        wrong = [w for frame in range(40) if (w := called("bowl", thing, 0.0, params, 0, frame)) != "bowl"]
        repeats.append(Counter(wrong).most_common(1)[0][1] / len(wrong) if wrong else np.nan)
    assert np.nanmean(repeats) > 0.75


def test_a_word_without_synonyms_keeps_its_label() -> None:
    assert set(words("zorblax", ImperfectParams(synonym=1.0, lookalike=1.0))) == {"zorblax"}
