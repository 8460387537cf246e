"""HOV-SG's room evaluator: the paper's own rows recomputed, and rooms small enough to count by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.evaluation.scores.region_matching import (
    Room,
    compat_accuracy,
    compat_average_precision,
    compat_score,
    matched_overlaps,
    strict_score,
)
from ovip.scene.types import F64

# Table kgsw_multiscene: scene, method -> regions, true rooms, HydP, acc, AP; and how many matches hold until
# which threshold, the only such counts that give both figures: (matches, last entry of 0, 0.1, .. 1 where so many do).
PAPER = {
    ("00824", "HOV-SG"): (7, 10, 0.841, 0.700, 0.700, ((7, 9),)),
    ("00824", "SysNav"): (8, 10, 0.911, 0.800, 0.800, ((8, 9),)),
    ("00824", "auto-K"): (8, 10, 0.893, 0.800, 0.800, ((8, 9),)),
    ("00824", "KGSW"): (15, 10, 0.954, 0.667, 0.667, ((10, 9),)),
    ("00829", "HOV-SG"): (5, 7, 0.904, 0.714, 0.714, ((5, 9),)),
    ("00829", "SysNav"): (1, 7, 0.410, 0.143, 0.143, ((1, 9),)),
    ("00829", "auto-K"): (2, 7, 0.660, 0.286, 0.286, ((2, 9),)),
    ("00829", "KGSW"): (8, 7, 0.850, 0.667, 0.857, ((7, 3), (6, 9))),
    ("00843", "HOV-SG"): (2, 7, 0.683, 0.286, 0.286, ((2, 9),)),
    ("00843", "SysNav"): (3, 7, 0.265, 0.111, 0.190, ((2, 5), (1, 9))),
    ("00843", "auto-K"): (2, 7, 0.658, 0.286, 0.286, ((2, 9),)),
    ("00843", "KGSW"): (6, 7, 0.568, 0.444, 0.571, ((5, 3), (4, 9))),
}
MEANS = {
    "HOV-SG": (0.809, 0.567, 0.567),
    "SysNav": (0.529, 0.351, 0.378),
    "auto-K": (0.737, 0.457, 0.457),
    "KGSW": (0.791, 0.593, 0.698),
}


def overlaps(counts: tuple[tuple[int, int], ...]) -> F64:
    """Matched overlaps of which `matches` are above every threshold up to entry `last`."""
    values: list[float] = []
    for matches, last in reversed(counts):
        values += [0.1 * last + 0.05] * (matches - len(values))
    return np.array(values)


def strip(x0: float, x1: float, floor: int = 0, y1: float = 1.0) -> Room:
    """The rectangle x0 .. x1, 0 .. y1 in cells of 0.05 m."""
    x = np.arange(round(x0 / 0.05), round(x1 / 0.05)) * 0.05 + 0.025
    y = np.arange(0, round(y1 / 0.05)) * 0.05 + 0.025
    return Room(floor, np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))


@pytest.mark.parametrize(("scene", "method"), list(PAPER))
def test_the_papers_rows_come_out_of_their_counts(scene: str, method: str) -> None:
    predicted, truth, _, accuracy, precision, counts = PAPER[scene, method]
    matched = overlaps(counts)
    assert compat_accuracy(matched, predicted, truth) == pytest.approx(accuracy, abs=5e-4)
    assert compat_average_precision(matched, predicted, truth) == pytest.approx(precision, abs=5e-4)


@pytest.mark.parametrize("method", list(MEANS))
def test_the_papers_means_are_over_scenes(method: str) -> None:
    scenes = [PAPER[scene, method] for scene in ("00824", "00829", "00843")]
    hydra = np.mean([row[2] for row in scenes])
    accuracy = np.mean([compat_accuracy(overlaps(row[5]), row[0], row[1]) for row in scenes])
    precision = np.mean([compat_average_precision(overlaps(row[5]), row[0], row[1]) for row in scenes])
    assert (hydra, accuracy, precision) == pytest.approx(MEANS[method], abs=6e-4)


@pytest.mark.parametrize(("method", "spread"), [("KGSW", 0.105), ("HOV-SG", 0.199), ("SysNav", 0.318)])
def test_the_papers_spread_of_accuracy_is_that_of_the_scenes_not_of_a_sample(
    method: str, spread: float
) -> None:
    rows = [PAPER[scene, method] for scene in ("00824", "00829", "00843")]
    assert np.std([compat_accuracy(overlaps(row[5]), row[0], row[1]) for row in rows]) == pytest.approx(
        spread, abs=1e-3
    )


@given(st.integers(1, 20), st.integers(1, 20), st.data())
def test_average_precision_collapses_where_the_matches_are_the_same_at_all_thresholds(
    predicted: int, truth: int, data: st.DataObject
) -> None:
    hits = data.draw(st.integers(0, min(predicted, truth)))
    matched = overlaps(((hits, 9),))
    assert compat_average_precision(matched, predicted, truth) == pytest.approx(
        hits / predicted * hits / truth
    )


def test_accuracy_at_a_half_is_read_at_six_tenths() -> None:
    assert compat_accuracy(np.array([0.55, 0.65]), 2, 2) == pytest.approx(1 / 3)


def test_the_same_rooms_are_perfect() -> None:
    rooms = [strip(0, 2), strip(2.2, 4)]
    for score in (compat_score(rooms, rooms), strict_score(rooms, rooms)):
        assert list(score.columns.values()) == [1.0, 1.0, 1.0, 1.0]


def test_one_region_over_two_rooms_has_all_of_both_and_is_half_of_either() -> None:
    compat = compat_score([strip(0, 4)], [strip(0, 2), strip(2, 4)])
    assert compat.hydra_precision == pytest.approx(0.5)
    assert compat.hydra_recall == pytest.approx(1.0)
    assert compat.accuracy == pytest.approx(0.5)  # the overlap ratio is 1: a room lies wholly in the region
    assert (
        strict_score([strip(0, 4)], [strip(0, 2), strip(2, 4)]).accuracy == 0.0
    )  # its IoU is 0.5, not above


def test_two_halves_of_a_room_are_pure_and_one_of_them_matches() -> None:
    compat = compat_score([strip(0, 2), strip(2, 4)], [strip(0, 4)])
    assert (compat.hydra_precision, compat.hydra_recall) == pytest.approx((1.0, 0.5))
    assert compat.accuracy == pytest.approx(0.5)


def test_true_overlap_is_counted_by_the_cell() -> None:
    predicted, truth = [strip(0, 3)], [strip(1, 4)]  # 2 m shared of 4 m in all
    assert compat_score(predicted, truth).hydra_precision == pytest.approx(2 / 3)
    assert strict_score(predicted, truth).accuracy == 0.0
    assert strict_score([strip(0, 3)], [strip(0.5, 3)]).accuracy == 1.0  # 2.5 of 3


def test_rooms_above_one_another_share_nothing() -> None:
    assert compat_score([strip(0, 2, floor=1)], [strip(0, 2)]).columns["HydP"] == 0.0
    two_floors = [strip(0, 2), strip(0, 2, floor=1)]
    assert compat_score(two_floors, two_floors).accuracy == 1.0


def test_cells_beside_one_another_are_not_near_but_a_shifted_cloud_is() -> None:
    assert compat_score([strip(0, 1)], [strip(1, 2)]).hydra_precision == 0.0
    shifted = Room(0, strip(0, 1).points + 0.02)
    assert compat_score([shifted], [strip(0, 1)]).hydra_precision == 1.0


def test_with_no_rooms_on_either_side_every_figure_is_nothing() -> None:
    for predicted, truth in (([], [strip(0, 1)]), ([strip(0, 1)], []), ([], [])):
        assert set(compat_score(predicted, truth).columns.values()) == {0.0}
        assert set(strict_score(predicted, truth).columns.values()) == {0.0}


def test_matching_is_one_to_one_and_of_most_overlap_in_sum() -> None:
    overlap = np.array([[0.9, 0.8], [0.8, 0.1]])
    assert sorted(matched_overlaps(overlap)) == pytest.approx([0.8, 0.8])


@given(st.integers(1, 60), st.integers(1, 60), st.integers(1, 60))
def test_a_strict_share_is_never_above_the_papers_overlap_ratio(a: int, b: int, c: int) -> None:
    predicted, truth = (
        [strip(0, 0.05 * a)],
        [strip(0.05 * min(a, b), 0.05 * (min(a, b) + c)), strip(0, 0.05 * b)],
    )
    compat, strict = compat_score(predicted, truth), strict_score(predicted, truth)
    assert strict.hydra_precision <= compat.hydra_precision + 1e-9
    assert strict.accuracy <= 1.0
