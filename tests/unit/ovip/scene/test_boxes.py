"""Axis-aligned boxes: volumes, overlaps, bounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.boxes import (
    box_of,
    pair_giou,
    pair_intersection,
    pair_touching,
    pairwise_iou,
    pairwise_touching,
    transformed_bounds,
    volume,
)
from ovip.scene.types import F64
from tests.builders import pose

CUBE = np.array([0.0, 0, 0, 2, 2, 2])
SHIFTED = np.array([1.0, 0, 0, 3, 2, 2])
FAR = np.array([5.0, 5, 5, 6, 6, 6])
FLAT = np.array([0.0, 0, 0, 2, 2, 0])

LENGTHS = st.floats(-100, 100, width=32)
EXTENTS = st.one_of(st.just(0.0), st.floats(0.0078125, 50, width=32))


@st.composite
def box_lists(draw: st.DrawFn, least: int = 0) -> F64:
    n = draw(st.integers(least, 6))
    low = draw(hnp.arrays(np.float64, (n, 3), elements=LENGTHS))
    return np.concatenate([low, low + draw(hnp.arrays(np.float64, (n, 3), elements=EXTENTS))], axis=1)


def test_volume_by_hand() -> None:
    assert volume(np.stack([CUBE, FLAT, FAR])).tolist() == [8.0, 0.0, 1.0]


def test_a_box_turned_inside_out_has_no_volume() -> None:
    assert volume(np.array([[2.0, 2, 2, 0, 0, 0]])).tolist() == [0.0]


def test_intersection_by_hand() -> None:
    """[1, 2] x [0, 2] x [0, 2] is shared: 4."""
    assert pair_intersection(CUBE, np.stack([SHIFTED, FAR, CUBE])).tolist() == [4.0, 0.0, 8.0]


def test_iou_by_hand() -> None:
    """4 shared of 8 + 8 - 4 = 12."""
    assert pairwise_iou(CUBE[None], np.stack([SHIFTED, FAR, CUBE]))[0].tolist() == [
        pytest.approx(1 / 3),
        0.0,
        1.0,
    ]


def test_iou_of_a_cup_inside_a_table_is_the_ratio_of_their_volumes() -> None:
    cup, table = np.array([[0.5, 0.5, 0.5, 0.6, 0.6, 0.6]]), np.array([[0.0, 0, 0, 1, 1, 1]])

    assert pairwise_iou(cup, table)[0, 0] == pytest.approx(0.001)


def test_iou_of_two_boxes_without_volume_is_zero() -> None:
    assert pairwise_iou(FLAT[None], FLAT[None]).tolist() == [[0.0]]


def test_no_boxes_make_an_empty_matrix() -> None:
    none = np.zeros((0, 6))

    assert pairwise_iou(none, CUBE[None]).shape == (0, 1)
    assert pairwise_iou(CUBE[None], none).shape == (1, 0)
    assert pairwise_touching(CUBE[None], none).shape == (1, 0)


@given(box_lists(), box_lists())
def test_iou_is_symmetric_and_within_0_and_1(a: F64, b: F64) -> None:
    iou = pairwise_iou(a, b)

    assert iou.shape == (len(a), len(b))
    assert (iou >= 0).all()
    assert (iou <= 1).all()
    assert np.array_equal(iou, pairwise_iou(b, a).T)


@given(box_lists(least=1))
def test_iou_of_a_box_with_itself_is_one_where_it_has_volume(boxes: F64) -> None:
    own = np.diag(pairwise_iou(boxes, boxes))

    assert np.array_equal(own, np.where(volume(boxes) > 0, 1.0, 0.0))


@given(box_lists(least=1), box_lists())
def test_boxes_share_a_volume_only_where_they_touch(a: F64, b: F64) -> None:
    """The mapper scores touching boxes only, so none with a positive IoU may be missed."""
    shared = pair_intersection(a[:, None], b[None])

    assert (pairwise_touching(a, b) | (shared == 0)).all()


def test_boxes_that_share_only_a_face_do_not_touch() -> None:
    assert not pair_touching(CUBE, np.array([2.0, 0, 0, 3, 2, 2]))


def test_box_of_points_is_tight() -> None:
    points = np.array([[0, 5, -1], [2, 3, 4]], np.float32)

    assert box_of(points).tolist() == [0, 3, -1, 2, 5, 4]
    assert box_of(points).dtype == np.float64


def test_bounds_after_a_quarter_turn_about_z_by_hand() -> None:
    """(x, y) -> (-y, x), then + (1, 0, 0)."""
    turn = np.array([[0.0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])

    assert transformed_bounds(np.array([0.0, 0, 0, 1, 2, 3]), turn).tolist() == [-1, 0, 0, 1, 1, 3]


@given(box_lists(least=1), st.floats(-3, 3), st.floats(-1, 1), LENGTHS)
def test_transformed_bounds_hold_every_transformed_point(
    boxes: F64, yaw: float, pitch: float, x: float
) -> None:
    transform = pose(x, 1.0, -2.0, yaw, pitch)
    inside = boxes[0, :3] + (boxes[0, 3:] - boxes[0, :3]) * np.random.default_rng(0).random((20, 3))
    moved = inside @ transform[:3, :3].T + transform[:3, 3]
    bounds = transformed_bounds(boxes[0], transform)

    assert (moved >= bounds[:3] - 1e-9).all()
    assert (moved <= bounds[3:] + 1e-9).all()


def test_giou_by_hand() -> None:
    """Shifted by half: IoU 4/12, the hull holds 3*2*2 = 12 = the union. Far: union 9, hull 6^3 = 216."""
    boxes = np.stack([CUBE, SHIFTED, FAR])

    assert pair_giou(CUBE, boxes) == pytest.approx([1.0, 4 / 12, -(216 - 9) / 216])


@given(box_lists(), box_lists())
def test_giou_is_symmetric_and_never_above_iou(a: F64, b: F64) -> None:
    giou = pair_giou(a[:, None], b[None])

    assert giou.shape == (len(a), len(b))
    assert (giou <= pairwise_iou(a, b)).all()
    np.testing.assert_allclose(giou, pair_giou(b[:, None], a[None]).T, rtol=1e-9, atol=1e-12)
