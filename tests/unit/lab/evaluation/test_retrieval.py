from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.retrieval import Ranked, misses, misses_of_instance, success_rates

NOWHERE = np.zeros((0, 3))


def ranked(
    places: list[list[float]], meant: list[list[float]], others: list[list[float]] | None = None
) -> Ranked:
    return Ranked("q", *(np.array(x, float).reshape(-1, 3) for x in (places, meant, others or [])))


def test_a_place_is_as_far_off_as_its_nearest_meant_instance() -> None:
    answer = ranked([[0, 0, 0], [5, 0, 0]], [[3, 4, 0], [5, 0, 2]])
    assert misses(answer) == pytest.approx([5.0, 2.0])


def test_rates_count_the_best_k_within_d() -> None:
    asked = [
        ("a", np.array([0.5, 9.0])),
        ("b", np.array([2.5, 0.9])),
        ("c", np.array([9.0])),
        ("d", np.zeros(0)),
    ]
    assert success_rates(asked) == {
        "rsr_top1_1m": 0.25,
        "rsr_top1_2m": 0.25,
        "rsr_top1_3m": 0.5,
        "rsr_top5_1m": 0.5,
        "rsr_top5_2m": 0.5,
        "rsr_top5_3m": 0.5,
    }


def test_a_distance_of_exactly_d_is_a_success_and_the_sixth_place_is_not_looked_at() -> None:
    assert success_rates([("a", np.array([9.0, 9, 9, 9, 9, 1.0]))])["rsr_top5_1m"] == 0.0
    assert success_rates([("a", np.array([9.0, 9, 9, 9, 1.0]))])["rsr_top5_1m"] == 1.0


def test_a_question_asked_twice_counts_once() -> None:
    assert (
        success_rates([("a", np.zeros(1)), ("a", np.ones(1) * 9), ("b", np.ones(1) * 9)])["rsr_top1_1m"]
        == 0.5
    )


def test_no_questions_no_success() -> None:
    assert set(success_rates([]).values()) == {0.0}


def test_the_wrong_one_of_two_mugs_side_by_side_is_a_hit_only_for_those_who_do_not_look() -> None:
    answer = ranked([[0.1, 0, 0]], [[0.8, 0, 0]], [[0, 0, 0]])
    assert misses(answer)[0] < 1.0
    assert np.isinf(misses_of_instance(answer)).all()
    assert misses_of_instance(ranked([[0.7, 0, 0]], [[0.8, 0, 0]], [[0, 0, 0]])) == pytest.approx([0.1])


def test_without_instances_everything_is_a_miss() -> None:
    assert np.isinf(misses(Ranked("q", np.zeros((2, 3)), NOWHERE, NOWHERE))).all()


@given(st.lists(st.lists(st.floats(0, 10), max_size=7), min_size=1, max_size=8))
def test_more_places_and_longer_distances_never_lower_a_rate(distances: list[list[float]]) -> None:
    rates = success_rates([(str(i), np.array(d, float)) for i, d in enumerate(distances)])
    for k in (1, 5):
        assert rates[f"rsr_top{k}_1m"] <= rates[f"rsr_top{k}_2m"] <= rates[f"rsr_top{k}_3m"]
    assert all(rates[f"rsr_top1_{d}m"] <= rates[f"rsr_top5_{d}m"] for d in (1, 2, 3))
