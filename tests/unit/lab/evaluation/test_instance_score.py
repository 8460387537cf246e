import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.instance import (
    NOTHING,
    label_area_recall,
    panoptic,
    recall_by_size,
    size_of,
    swallowed_classes,
    vertex_instances,
)

# a fan of three triangles around vertex 0, and one triangle apart
FAN = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [5, 6, 7]], np.int32)


def test_a_vertex_takes_the_id_with_the_most_area_around_it_not_the_most_faces() -> None:
    won = vertex_instances(FAN, np.array([1.0, 1.0, 3.0, 1.0]), np.array([4, 4, 9, 2]), 9, {4, 9, 2})
    assert won.tolist() == [9, 4, 4, 9, 9, 2, 2, 2, NOTHING]  # vertex 3: 1.0 of id 4 against 3.0 of id 9


def test_equal_areas_go_to_the_smaller_id() -> None:
    triangles = np.array([[0, 1, 2], [0, 1, 3]], np.int32)
    assert vertex_instances(triangles, np.array([1.0, 1.0]), np.array([8, 3]), 4, {3, 8}).tolist() == [
        3,
        3,
        8,
        3,
    ]


def test_a_retained_id_that_wins_no_vertex_is_given_its_own_and_another_is_lost() -> None:
    triangles = np.array([[0, 1, 2], [0, 1, 2]], np.int32)
    areas, ids = np.array([1.0, 5.0]), np.array([6, 1])
    assert vertex_instances(triangles, areas, ids, 3, {6, 1}).tolist() == [6, 6, 6]
    assert vertex_instances(triangles, areas, ids, 3, {1}).tolist() == [1, 1, 1]


def test_panoptic_quality_agrees_with_a_case_worked_by_hand() -> None:
    # truth 1: six points, five of them in object 10 (IoU 5/6); truth 2: four points, split 2 : 2, the object 11 takes
    # the lost point of truth 1 besides (IoU 2/5 = under a half); truth 3: not mapped at all; object 12 has no match
    truth = np.array([1] * 6 + [2] * 4 + [3] * 2)
    predicted = np.array([10] * 5 + [11] + [11, 11, 12, 12] + [NOTHING] * 2)
    found = panoptic(truth, predicted)
    assert found.matched == {1: 10}
    assert found.sq == pytest.approx(5 / 6)
    assert found.rq == pytest.approx(
        1 / (1 + 2 / 2 + 2 / 2)
    )  # two objects and two instances without a partner
    assert found.pq == pytest.approx(5 / 18)


def test_an_overlap_of_exactly_half_is_no_match() -> None:
    assert panoptic(np.array([1, 1]), np.array([5, NOTHING])).matched == {}


def test_an_object_that_swallows_two_equal_things_matches_neither() -> None:
    found = panoptic(np.array([1, 1, 1, 2, 2, 2]), np.full(6, 7))
    assert (found.pq, found.truth, found.predicted) == (0, 2, 1)


def test_an_empty_map_scores_nothing() -> None:
    assert panoptic(np.array([1, 2]), np.full(2, NOTHING)).pq == 0


@given(st.lists(st.tuples(st.integers(1, 5), st.integers(-1, 4)), min_size=1, max_size=80))
def test_quality_is_a_product_within_0_and_1_and_pairs_are_one_to_one(pairs: list[tuple[int, int]]) -> None:
    truth, predicted = (np.array(column) for column in zip(*pairs, strict=True))
    found = panoptic(truth, predicted)
    assert 0 <= found.pq <= 1
    assert found.pq == pytest.approx(found.sq * found.rq)
    assert len(set(found.matched.values())) == len(found.matched)
    for g, p in found.matched.items():
        either, both = (truth == g) | (predicted == p), (truth == g) & (predicted == p)
        assert both.sum() > either.sum() / 2


@given(st.lists(st.integers(1, 6), min_size=1, max_size=60))
def test_a_perfect_map_has_quality_1_whatever_it_calls_things(ids: list[int]) -> None:
    truth = np.array(ids)
    assert panoptic(truth, 100 - truth).pq == 1


def test_terciles_split_a_scenes_instances_in_three_by_area() -> None:
    areas = {1: 5.0, 2: 0.1, 3: 0.3, 4: 2.0, 5: 0.2, 6: 0.3, 7: 9.0}
    assert size_of(areas) == {
        2: "small",
        5: "small",
        3: "small",
        6: "medium",
        4: "medium",
        1: "large",
        7: "large",
    }
    assert recall_by_size(areas, {2, 3, 4, 1, 7}) == {"small": 2 / 3, "medium": 0.5, "large": 1.0}


def test_a_scene_of_two_things_has_no_third_tercile() -> None:
    assert set(recall_by_size({1: 1.0, 2: 2.0}, {1})) == {"small", "medium"}


def test_label_area_recall_counts_the_surface_that_carries_its_own_label() -> None:
    pot, vase, sofa, absent = range(4)
    truth = np.array([pot] * 4 + [vase] * 2 + [sofa] * 10)
    predicted = np.array([sofa] * 3 + [pot] + [vase, NOTHING] + [sofa] * 10)
    recall = label_area_recall(truth, predicted, 4)
    assert recall[:3].tolist() == [0.25, 0.5, 1.0]
    assert np.isnan(recall[absent])


def test_swallowed_is_what_was_detected_and_yet_mostly_carries_another_label() -> None:
    recall = np.array([0.0, 0.49, 0.5, 0.2, np.nan])
    detected = np.array([True, True, True, False, True])
    assert swallowed_classes(recall, detected).tolist() == [0, 1]
