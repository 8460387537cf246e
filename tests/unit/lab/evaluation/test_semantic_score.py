import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.semantic import (
    EXCLUDED,
    REPLICA_CLASSES,
    UNMAPPED,
    classify,
    clip_scores,
    kept_classes,
    label_scores,
    mixed_scores,
    semantic_score,
)

A, B, C, D = range(4)
KEEP = np.array([True, True, True, False])


def test_there_are_the_papers_52_classes_and_each_exclusion_names_so_many_of_them() -> None:
    assert len(REPLICA_CLASSES) == len(set(REPLICA_CLASSES)) == 52
    assert {n: len(names) for n, names in EXCLUDED.items()} == {1: 1, 4: 4, 6: 6}
    assert all(names <= set(REPLICA_CLASSES) for names in EXCLUDED.values())


def test_scores_agree_with_a_confusion_matrix_worked_by_hand() -> None:
    # rows a, b, c; d is not kept:   a 3 1 0 | b 0 2 1 | c 1 0 0
    truth = np.array([A, A, A, A, B, B, B, C, D, D])
    predicted = np.array([A, A, A, B, B, B, C, A, A, B])
    score = semantic_score(truth, predicted, KEEP)
    # recall 3/4, 2/3, 0; IoU 3/(4+4-3), 2/(3+3-2), 0/(1+1-0)
    assert score.accuracy == pytest.approx(100 * (3 / 4 + 2 / 3) / 3)
    assert score.iou == pytest.approx(100 * (0.6 + 0.5) / 3)
    assert score.frequency_iou == pytest.approx(100 * (0.6 * 4 + 0.5 * 3) / 8)
    assert score.points == 8


def test_an_unmapped_point_is_wrong_for_its_class_and_no_false_positive_of_another() -> None:
    truth = np.array([A, A, A, A, B, B])
    score = semantic_score(truth, np.array([A, A, UNMAPPED, UNMAPPED, B, B]), KEEP[:2])
    assert score.accuracy == pytest.approx(75)
    assert score.iou == pytest.approx(100 * (2 / 4 + 1) / 2)
    assert score.frequency_iou == pytest.approx(100 * (0.5 * 4 + 1 * 2) / 6)


def test_a_kept_class_without_points_counts_as_missed() -> None:
    score = semantic_score(np.array([A, A]), np.array([A, A]), np.array([True, True]))
    assert (score.accuracy, score.iou, score.frequency_iou) == (50, 50, 100)


def test_no_point_to_judge_scores_nothing() -> None:
    score = semantic_score(np.array([D, D]), np.array([A, B]), KEEP)
    assert (score.accuracy, score.iou, score.frequency_iou, score.points) == (0, 0, 0, 0)


def test_only_classes_present_and_not_excluded_are_kept() -> None:
    classes = ("other", "wall", "mug", "sofa")
    assert kept_classes(classes, [0, 1, 3, 3], EXCLUDED[1]).tolist() == [False, True, False, True]
    assert kept_classes(classes, [0, 1, 3, 3], EXCLUDED[4]).tolist() == [False, False, False, True]


def test_the_classifier_cannot_choose_a_class_that_is_not_kept() -> None:
    scores = np.array([[0.1, 0.3, 0.9], [0.5, 0.5, 0.6]])
    assert classify(scores, np.array([True, True, False])).tolist() == [1, 0]  # the first of equals


def test_labels_correct_a_near_synonym_that_the_feature_gets_wrong_by_a_hair() -> None:
    # an object whose feature is 0.005 nearer to "cushion" though it was called sofa three times in four
    classes = np.array([[1, 0, 0], [0.8, 0.6, 0]], np.float32)  # sofa, cushion
    clip = np.array([[0.900, 0.905]])
    label = label_scores([{"sofa": 3, "cushion": 1}], {"sofa": classes[0], "cushion": classes[1]}, classes)
    assert label == pytest.approx(np.array([[0.75 + 0.25 * 0.8, 0.75 * 0.8 + 0.25]]))
    keep = np.array([True, True])
    assert classify(mixed_scores(clip, label, 0.0), keep).tolist() == [1]
    assert classify(mixed_scores(clip, label, 0.3), keep).tolist() == [0]
    assert mixed_scores(clip, label, 0.3) == pytest.approx(0.7 * clip + 0.3 * label)


def test_cosines_of_unit_features() -> None:
    features = np.array([[0.6, 0.8]], np.float32)
    assert clip_scores(features, np.eye(2, dtype=np.float32)) == pytest.approx(np.array([[0.6, 0.8]]))


@given(st.lists(st.integers(0, 3), min_size=1, max_size=60), st.randoms(use_true_random=False))
def test_a_perfect_map_scores_100_and_points_in_any_order_score_the_same(classes, random) -> None:  # type: ignore[no-untyped-def]
    truth = np.array(classes)
    keep = kept_classes("abcd", truth, frozenset())
    perfect = semantic_score(truth, truth, keep)
    assert (perfect.accuracy, perfect.iou, perfect.frequency_iou) == pytest.approx((100, 100, 100))
    predicted = np.array([random.randrange(4) for _ in classes])
    order = np.array(random.sample(range(len(classes)), len(classes)))
    assert semantic_score(truth, predicted, keep) == semantic_score(truth[order], predicted[order], keep)
