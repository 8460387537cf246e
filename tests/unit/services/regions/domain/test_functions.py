"""Functions of objects by the table: words, company, and words the table lacks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ovip.scene.features import normalize
from services.regions.domain.functions import (
    FUNCTIONS,
    FunctionParams,
    borrow_priors,
    functions_of,
    prior_of,
    table_words,
    unlisted,
)

LVIS = Path(__file__).resolve().parents[6] / "shared" / "data" / "clip_text"


def at(*xy: tuple[float, float]) -> np.ndarray:
    return np.array(xy, dtype=np.float64).reshape(-1, 2)


def test_a_typical_word_settles_its_function_alone() -> None:
    assert functions_of(("stove", "bed", "toilet", "sofa"), at((0, 0), (9, 0), (0, 9), (9, 9)), {}) == (
        "kitchen",
        "bedroom",
        "bathroom",
        "living room",
    )


def test_words_meet_the_table_in_the_shared_form() -> None:
    assert functions_of((" Dining_Tables ",), at((0, 0)), {}) == ("dining area",)


def test_a_chair_is_for_what_it_stands_at() -> None:
    words = ("chair", "dining table", "chair", "desk", "chair")
    places = at((0.9, 0), (0, 0), (20.9, 0), (20, 0), (10, 0))
    assert functions_of(words, places, {}) == ("dining area", "dining area", "office", "office", "unknown")


def test_the_score_is_the_prior_times_company() -> None:
    # chair: 0.4 in four functions, so a quarter each; a dining table (prior 1) at 1.5 m adds 3 / e of that
    assert prior_of("chair") is not None
    assert prior_of("chair").max() == pytest.approx(0.25)
    score = 0.25 * (1 + 3 * np.exp(-1.0))
    for enough, expected in ((score - 0.001, "dining area"), (score + 0.001, "unknown")):
        found = functions_of(
            ("chair", "dining table"), at((1.5, 0), (0, 0)), {}, FunctionParams(enough=enough)
        )
        assert found[0] == expected


def test_a_word_typical_of_one_place_and_possible_elsewhere_leans_but_can_be_turned() -> None:
    words = ("sink", "stove", "sink", "toilet")
    assert functions_of(words, at((0, 0), (1, 0), (20, 0), (21, 0)), {})[::2] == ("kitchen", "bathroom")


def test_no_objects_have_no_functions() -> None:
    assert functions_of((), at(), {}) == ()


def test_a_strange_word_alone_is_unknown_and_with_a_borrowed_prior_is_not() -> None:
    assert unlisted(("zorb", "bed", "zorb", "Beds")) == ("zorb",)
    assert functions_of(("zorb",), at((0, 0)), {}) == ("unknown",)
    prior = np.zeros(len(FUNCTIONS))
    prior[FUNCTIONS.index("gym")] = 0.9
    assert functions_of(("zorb",), at((0, 0)), {"zorb": prior}) == ("gym",)


def test_every_prior_sums_to_at_most_one() -> None:
    for word in table_words():
        prior = prior_of(word)
        assert prior is not None
        assert 0 < prior.sum() <= 1 + 1e-12


def test_a_word_borrows_from_the_words_it_stands_out_towards() -> None:
    words = table_words()
    rng = np.random.default_rng(7)
    table = normalize(rng.standard_normal((len(words), 64)).astype(np.float32))
    like_toilet = table[words.index("toilet")] + 0.02 * rng.standard_normal(64).astype(np.float32)
    like_all = table.mean(axis=0)
    borrowed = borrow_priors(("loo", "blob"), np.stack([like_toilet, like_all]), words, table)
    assert set(borrowed) == {"loo"}
    assert FUNCTIONS[int(borrowed["loo"].argmax())] == "bathroom"
    assert borrow_priors((), np.zeros((0, 64), np.float32), words, table) == {}


def test_words_left_out_of_the_table_mostly_find_a_right_function_in_real_clip_features() -> None:
    if not LVIS.is_dir():
        pytest.skip("../shared/data/clip_text is not here: the test on real text features was skipped")
    names = [
        item["name"].replace("_", " ").lower()
        for item in json.loads((LVIS / "lvis_v1_names.json").read_text())
    ]
    features = np.load(LVIS / "lvis_v1_clip_vitb32_text.npy").astype(np.float32)
    rows = {name: row for name, row in zip(names, features, strict=True) if name in set(table_words())}
    right = answered = 0
    for word, feature in rows.items():
        others = tuple(other for other in rows if other != word)
        borrowed = borrow_priors((word,), feature[None], others, np.stack([rows[other] for other in others]))
        own = prior_of(word)
        answered += len(borrowed)
        right += bool(borrowed and own is not None and own[int(borrowed[word].argmax())] > 0)
    assert answered > 0.5 * len(rows)
    assert right > 0.6 * answered  # of 13 functions; by chance about one in seven
