"""Clusters of points by a radius."""

from __future__ import annotations

import numpy as np

from ovip.scene.clusters import clusters


def test_points_within_the_radius_are_one_cluster_through_a_chain() -> None:
    points = np.array([[0.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0], [3.0, 0, 0]])
    assert clusters(points, 0.5).tolist() == [0, 0, 0, 1]


def test_clusters_are_numbered_by_their_first_point() -> None:
    points = np.array([[9.0, 0], [0.0, 0], [9.1, 0], [0.1, 0], [5.0, 0]])
    assert clusters(points, 0.2).tolist() == [0, 1, 0, 1, 2]


def test_no_points_have_no_clusters() -> None:
    assert clusters(np.zeros((0, 3)), 1.0).tolist() == []
