"""Clusters of points by a radius, and of cells that touch."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.clusters import cell_clusters, clusters
from ovip.scene.types import I64


def test_points_within_the_radius_are_one_cluster_through_a_chain() -> None:
    points = np.array([[0.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0], [3.0, 0, 0]])
    assert clusters(points, 0.5).tolist() == [0, 0, 0, 1]


def test_clusters_are_numbered_by_their_first_point() -> None:
    points = np.array([[9.0, 0], [0.0, 0], [9.1, 0], [0.1, 0], [5.0, 0]])
    assert clusters(points, 0.2).tolist() == [0, 1, 0, 1, 2]


def test_no_points_have_no_clusters() -> None:
    assert clusters(np.zeros((0, 3)), 1.0).tolist() == []


# Cells


def _in_one_group(cells: I64) -> I64:
    return cell_clusters(cells, np.zeros(len(cells), np.int64))


def test_cells_that_touch_by_a_face_an_edge_or_a_corner_are_one_cluster() -> None:
    for step in itertools.product((-1, 0, 1), repeat=3):
        assert _in_one_group(np.array([[5, 5, 5], np.add([5, 5, 5], step)])).tolist() == [0, 0], step


def test_cells_two_apart_along_any_axis_are_two_clusters() -> None:
    for step in itertools.product((-2, 0, 1), repeat=3):
        if -2 in step:
            assert len(set(_in_one_group(np.array([[5, 5, 5], np.add([5, 5, 5], step)])))) == 2, step


def test_cells_of_different_groups_never_touch() -> None:
    cells = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 0]])
    assert cell_clusters(cells, np.array([0, 1, 1])).tolist() == [0, 1, 1]


def test_no_cells_have_no_clusters() -> None:
    assert _in_one_group(np.zeros((0, 3), np.int64)).tolist() == []


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.integers(2, 12), st.integers(1, 3))
@settings(max_examples=60)
def test_they_are_the_clusters_of_cell_centres_by_a_corner_s_distance(
    seed: int, count: int, spread: int, groups: int
) -> None:
    """Centres of cells that touch are at most sqrt 3 apart, of others at least 2."""
    rng = np.random.default_rng(seed)
    cells = rng.integers(-spread, spread, (count, 3))
    group = rng.integers(0, groups, count)
    apart = np.column_stack([cells, 100 * group])

    found, exact = cell_clusters(cells, group), clusters(apart.astype(np.float64), 1.9)

    assert len(set(zip(found, exact, strict=True))) == len(set(found)) == len(set(exact))
    first = [
        tuple(min(np.column_stack([group, cells])[found == label].tolist()))
        for label in range(found.max() + 1)
    ]
    assert first == sorted(first)
