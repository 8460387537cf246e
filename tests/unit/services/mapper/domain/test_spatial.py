"""The spatial terms by hand: one-sided containment, and what is 0 apart."""

from __future__ import annotations

import numpy as np
import pytest

from services.mapper.domain.spatial import REACH, Spatial, containment, spatial_scores

CUBE = np.array([[0.0, 0, 0, 2, 2, 2]])
SHIFTED = np.array([[1.0, 0, 0, 3, 2, 2]])
FAR = np.array([[5.0, 5, 5, 6, 6, 6]])
FIRST = np.zeros(1, np.int64)
NONE = np.zeros(0, np.int64)
LINE = np.array([[0.1 * i, 0, 0] for i in range(10)], np.float32)


def test_containment_is_the_share_of_the_first_cloud_on_the_second() -> None:
    """Points 0, 1, 2 of ten lie on the short cloud; all three of the short cloud lie on the line."""
    short = LINE[:3] + np.float32([0, 0.02, 0])

    assert containment(LINE, short) == pytest.approx(0.3)
    assert containment(short, LINE) == 1.0


def test_points_just_out_of_reach_do_not_count() -> None:
    assert containment(LINE, LINE + np.float32([0, REACH + 0.001, 0])) == 0.0


@pytest.mark.parametrize("kind", Spatial)
def test_boxes_that_share_no_volume_score_at_most_0(kind: Spatial) -> None:
    assert spatial_scores(kind, CUBE, FAR, FIRST, FIRST, [LINE], [LINE])[0] <= 0


@pytest.mark.parametrize(
    ("kind", "score"), [(Spatial.IOU, 4 / 12), (Spatial.GIOU, 4 / 12), (Spatial.OVERLAP, 1.0)]
)
def test_boxes_that_share_half(kind: Spatial, score: float) -> None:
    assert spatial_scores(kind, CUBE, SHIFTED, FIRST, FIRST, [LINE], [LINE])[0] == pytest.approx(score)


@pytest.mark.parametrize("kind", Spatial)
def test_no_pairs_give_no_scores(kind: Spatial) -> None:
    assert spatial_scores(kind, np.zeros((0, 6)), np.zeros((0, 6)), NONE, NONE, [], [LINE]).shape == (0,)
