"""IPSM + LAMP (Eq. 2) by hand, and pruning that changes nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.boxes import box_of
from ovip.scene.features import normalize
from ovip.scene.types import F32, F64
from services.mapper.domain.association import (
    NEW,
    AssociationParams,
    Instances,
    associate,
    associate_dense,
    association_scores,
)
from services.mapper.domain.spatial import Spatial
from tests.builders import axis, leaning

PAPER = AssociationParams()
BOX = np.array([[0.0, 0, 0, 1, 1, 1]])
HALF = np.array([[0.5, 0.0, 0, 1.5, 1, 1]])
FAR = np.array([[5.0, 5, 5, 6, 6, 6]])


def _score(box: F64, feature: F32, label: str, object_box: F64, params: AssociationParams = PAPER) -> float:
    """Against one object: a cup along feature axis 0."""
    return float(
        association_scores(
            Instances(box, feature[None], [label]), Instances(object_box, axis(0)[None], ["cup"]), params
        )[0, 0]
    )


def _only(instances: Instances, i: int) -> Instances:
    part = slice(i, i + 1)
    return Instances(
        instances.boxes[part], instances.features[part], instances.labels[part], instances.clouds[part]
    )


# Eq. 2


def test_the_paper_s_numbers_are_the_defaults() -> None:
    assert (PAPER.alpha, PAPER.label_penalty) == (0.0, 0.5)


@pytest.mark.parametrize(
    ("box", "feature", "label", "alpha", "phi"),
    [
        (BOX, axis(0), "cup", 0.0, 2.0),  # the same: 1 + 1
        (HALF, axis(0), "cup", 0.0, 1 / 3 + 1),  # IoU 0.5 / 1.5
        (HALF, leaning(0, 1, 0.6), "cup", 0.0, 1 / 3 + 0.6),
        (HALF, leaning(0, 1, 0.6), "mug", 0.0, 1 / 3 + 0.6 - 0.5),
        (FAR, axis(0), "cup", 0.0, 1.0),
        (FAR, axis(1), "mug", 0.0, -0.5),
        (HALF, leaning(0, 1, 0.6), "mug", 0.5, 1.5 / 3 + 0.5 * 0.6 - 0.5),
        (BOX, axis(0), "cup", -0.5, 0.5 + 1.5),
    ],
)
def test_the_score_by_hand(box: F64, feature: F32, label: str, alpha: float, phi: float) -> None:
    assert _score(box, feature, label, BOX, AssociationParams(alpha=alpha)) == pytest.approx(phi, abs=1e-6)


def test_opposite_features_count_against() -> None:
    assert _score(BOX, -axis(0), "cup", BOX) == pytest.approx(0.0)


def test_scores_are_one_row_a_detection_and_one_column_an_object() -> None:
    scores = association_scores(
        Instances(np.concatenate([BOX, FAR]), np.stack([axis(0), axis(1)]), ["cup", "lamp"]),
        Instances(
            np.concatenate([BOX, HALF, FAR]),
            np.stack([axis(0), axis(0), axis(1)]),
            ["cup", "mug", "lamp"],
        ),
        PAPER,
    )

    assert scores == pytest.approx(np.array([[2, 1 / 3 + 0.5, -0.5], [-0.5, -0.5, 2]]), abs=1e-6)


# Assignment


def test_the_best_score_above_tau_wins_and_a_score_of_tau_does_not() -> None:
    scores = np.array([[1.2, 1.5, 0.3], [1.05, 0.0, 1.0], [0.1, 0.2, 1.06]])

    assert associate_dense(scores, 1.05).tolist() == [1, NEW, 2]


def test_ties_go_to_the_older_object() -> None:
    assert associate_dense(np.array([[1.2, 1.3, 1.3, 1.3]]), 1.05).tolist() == [1]


def test_an_empty_map_and_an_empty_frame_assign_nothing() -> None:
    none = Instances(np.zeros((0, 6)), np.zeros((0, 8), np.float32), [])
    cup = Instances(BOX, axis(0)[None], ["cup"])

    assert associate(cup, none, PAPER).tolist() == [NEW]
    assert associate(none, cup, PAPER).tolist() == []
    assert associate_dense(np.zeros((2, 0)), 1.05).tolist() == [NEW, NEW]


@pytest.mark.parametrize("copies", [2, 3, 37, 200])
def test_a_detection_among_equal_objects_joins_the_oldest(copies: int) -> None:
    """A matrix product rounds equal columns differently by where they stand."""
    rng = np.random.default_rng(copies)
    features = normalize(rng.normal(size=(20, 384)).astype(np.float32))
    same = np.tile(features[:1], (copies, 1))
    boxes = np.tile(BOX, (copies, 1))
    for tau in (1.05, 0.2):
        params = AssociationParams(tau=tau)
        assigned = associate(
            Instances(np.tile(BOX, (20, 1)), features, ["cup"] * 20),
            Instances(boxes, same, ["cup"] * copies),
            params,
        )
        assert set(assigned.tolist()) <= {0, NEW}


@st.composite
def frames_and_maps(draw: st.DrawFn) -> tuple[Instances, Instances]:
    """Random detections and objects on a coarse lattice, so that equal, touching and nested ones are common."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    m, n, d = draw(st.integers(0, 6)), draw(st.integers(0, 12)), draw(st.sampled_from([2, 3, 384]))
    kinds = normalize(rng.normal(size=(3, d)).astype(np.float32))

    def boxes(count: int) -> F64:
        low = rng.integers(0, 4, (count, 3)).astype(np.float64)
        return np.concatenate([low, low + rng.integers(0, 3, (count, 3))], axis=1)

    def features(count: int) -> F32:
        noise = rng.choice([0.0, 0.0, 0.1, 1.0], (count, 1)) * rng.normal(size=(count, d))
        return normalize((kinds[rng.integers(0, 3, count)] + noise).astype(np.float32))

    def labels(count: int) -> list[str]:
        return [str(word) for word in rng.choice(["cup", "mug"], count)]

    def clouds(count: int) -> list[F32]:
        return [rng.uniform(0, 4, (5, 3)).round(2).astype(np.float32) for _ in range(count)]

    return (
        Instances(boxes(m), features(m), labels(m), clouds(m)),
        Instances(boxes(n), features(n), labels(n), clouds(n)),
    )


ALPHAS = st.sampled_from([-1.0, -0.5, 0.0, 0.3, 1.0])
TAUS = st.one_of(st.sampled_from([0.0, 0.5, 1.0, 1.05, 1.5]), st.floats(-1, 2.5))


KINDS = st.sampled_from(Spatial)


@given(frames_and_maps(), ALPHAS, TAUS, st.sampled_from([0.0, 0.5, 2.0]), KINDS)
@settings(max_examples=400)
def test_pruning_never_changes_an_assignment(
    case: tuple[Instances, Instances], alpha: float, tau: float, penalty: float, spatial: Spatial
) -> None:
    params = AssociationParams(alpha, penalty, tau, spatial)

    pruned = associate(*case, params)

    assert pruned.tolist() == associate_dense(association_scores(*case, params), tau).tolist()


@given(frames_and_maps(), ALPHAS, st.sampled_from([0.0, 0.5]), KINDS)
def test_pruning_holds_where_tau_is_just_what_features_alone_can_reach(
    case: tuple[Instances, Instances], alpha: float, penalty: float, spatial: Spatial
) -> None:
    """tau = 1 - a: equal features score exactly tau, which does not win, however they round."""
    params = AssociationParams(alpha, penalty, 1 - alpha, spatial)

    pruned = associate(*case, params)

    assert pruned.tolist() == associate_dense(association_scores(*case, params), params.tau).tolist()


@given(frames_and_maps(), ALPHAS, TAUS, KINDS)
def test_each_detection_is_assigned_as_if_it_were_alone_in_its_frame(
    case: tuple[Instances, Instances], alpha: float, tau: float, spatial: Spatial
) -> None:
    detections, objects = case
    params = AssociationParams(alpha, 0.5, tau, spatial)
    together = associate(detections, objects, params)
    for i in range(len(together)):
        assert associate(_only(detections, i), objects, params).tolist() == [together[i]]


def test_where_features_alone_can_reach_tau_a_distant_object_is_joined() -> None:
    """tau 0.8 < 1 - a = 1: looks alone suffice, as the equation says."""
    cup, far = Instances(BOX, axis(0)[None], ["cup"]), Instances(FAR, axis(0)[None], ["cup"])

    assert associate(cup, far, AssociationParams(tau=0.8)).tolist() == [0]


# What the symmetric term is for


def test_a_cup_on_a_table_joins_the_table_by_overlap_and_stays_itself_by_iou() -> None:
    """The cup's foot and the table under it, 12 of its 16 points on the table: 12/16 + cos 0.6 > 1.2; IoU is ~0."""
    x, y = np.meshgrid(np.arange(0, 1, 0.02), np.arange(0, 1, 0.02))
    table = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.7)], axis=1).astype(np.float32)
    cup = np.array([[0.5 + 0.02 * i, 0.5, 0.7 + 0.1 * (i >= 12)] for i in range(16)], dtype=np.float32)
    one = Instances(box_of(cup)[None] + [0, -0.01, 0, 0, 0.01, 0], leaning(0, 1, 0.6)[None], ["cup"], [cup])
    other = Instances(box_of(table)[None] + [0, 0, -0.01, 0, 0, 0.01], axis(0)[None], ["table"], [table])

    overlap = AssociationParams(label_penalty=0, tau=1.2, spatial=Spatial.OVERLAP)
    iou = AssociationParams(label_penalty=0, tau=1.2)

    assert association_scores(one, other, overlap)[0, 0] == pytest.approx(0.75 + 0.6, abs=1e-6)
    assert associate(one, other, overlap).tolist() == [0]
    assert associate(one, other, iou).tolist() == [NEW]
