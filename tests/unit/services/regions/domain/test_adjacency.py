"""Adjacency: openings and their widths."""

from __future__ import annotations

import numpy as np
import pytest

from services.regions.domain.adjacency import find_openings


def test_a_straight_border_is_as_wide_as_its_cells() -> None:
    labels = np.ones((20, 10), np.int32)
    labels[:, 5:] = 2
    (opening,) = find_openings(labels, 0.05)
    assert (opening.a, opening.b) == (0, 1)
    assert opening.width == pytest.approx(1.0)
    assert opening.middle.tolist() == pytest.approx([9, 4.5], abs=1)
    assert sorted(opening.ends.tolist()) == [[0, 4.5], [19, 4.5]]


def test_a_slanted_border_is_as_wide_as_the_line() -> None:
    labels = np.where(np.tri(20, dtype=bool), 1, 2).astype(np.int32)
    (opening,) = find_openings(labels, 0.05)
    assert opening.width == pytest.approx(np.hypot(19, 19) * 0.05)


def test_two_doors_between_the_same_rooms_are_two_openings() -> None:
    labels = np.ones((40, 11), np.int32)
    labels[:, 6:] = 2
    labels[:, 5] = 0
    labels[5:15, 5] = labels[25:37, 5] = 1
    assert [round(opening.width, 2) for opening in find_openings(labels, 0.05)] == [0.5, 0.6]


def test_a_narrow_touch_is_no_opening() -> None:
    labels = np.zeros((8, 9), np.int32)
    labels[:, :4], labels[:, 5:] = 1, 2
    labels[3, 4] = 1
    assert find_openings(labels, 0.05) == ()
    assert len(find_openings(labels, 0.05, min_width=0.0)) == 1


def test_regions_apart_and_no_regions_have_no_openings() -> None:
    assert find_openings(np.array([[1, 0, 2]], np.int32), 1.0) == ()
    assert find_openings(np.zeros((0, 0), np.int32), 1.0) == ()
