"""Lines of doorways, stairs and frontiers in a plan."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.scene.grid import FREE, UNKNOWN, FloorGrid
from ovip.scene.types import EdgeKind, Frontier, RegionEdge
from services.api.domain.plan_marks import frontier_lines, passage_line, stairs_lines


def cells(labels: np.ndarray) -> FloorGrid:
    occupancy = np.where(labels > 0, FREE, UNKNOWN).astype(np.uint8)
    return FloorGrid(0, (0.0, 0.0), 0.05, occupancy, labels.astype(np.uint16), ("a", "b"))


def test_a_doorway_lies_across_the_way_between_its_regions() -> None:
    labels = np.ones((60, 60))
    labels[:, 30:] = 2
    edge = RegionEdge("a", "b", 0.8, np.array([1.5, 1.0, 0.0]), EdgeKind.DOORWAY)

    assert passage_line(cells(labels), edge) == pytest.approx(np.array([[1.5, 0.6], [1.5, 1.4]]))
    turned = RegionEdge("b", "a", 0.8, np.array([1.0, 1.5, 0.0]), EdgeKind.DOORWAY)
    assert passage_line(cells(labels.T), turned) == pytest.approx(np.array([[0.6, 1.5], [1.4, 1.5]]))


def test_a_slanted_border_gives_a_slanted_line() -> None:
    row, column = np.indices((80, 80))
    edge = RegionEdge("a", "b", 1.0, np.array([2.0, 2.0, 0.0]), EdgeKind.DOORWAY)
    start, end = passage_line(cells(np.where(row > column, 1, 2)), edge)

    along = (end - start) / np.linalg.norm(end - start)
    assert np.linalg.norm(end - start) == pytest.approx(1.0)
    assert along == pytest.approx([np.sqrt(0.5), np.sqrt(0.5)], abs=0.05)


def test_a_passage_without_a_border_in_the_grid_still_has_a_line_of_its_width() -> None:
    edge = RegionEdge("a", "elsewhere", 0.9, np.array([1.0, 1.0, 0.0]), EdgeKind.DOORWAY)
    assert passage_line(cells(np.ones((40, 40))), edge) == pytest.approx(np.array([[0.55, 1.0], [1.45, 1.0]]))


def test_stairs_are_as_wide_and_long_as_they_are_with_a_tread_every_28_centimetres() -> None:
    edge = RegionEdge("a", "b", 0.9, np.array([1.0, 1.0, 0.0]), EdgeKind.STAIRS, np.array([3.8, 1.0, 2.7]))
    rim, treads, way = stairs_lines(edge)

    assert rim.min(axis=0) == pytest.approx([1.0, 0.55])
    assert rim.max(axis=0) == pytest.approx([3.8, 1.45])
    assert len(treads) == 9
    assert way == pytest.approx(np.array([[1.0, 1.0], [3.8, 1.0]]))


def test_stairs_that_rise_on_the_spot_are_drawn_as_long_as_wide() -> None:
    edge = RegionEdge("a", "b", 0.9, np.array([1.0, 1.0, 0.0]), EdgeKind.STAIRS, np.array([1.0, 1.0, 2.7]))
    rim, treads, _ = stairs_lines(edge)

    assert np.ptp(rim, axis=0) == pytest.approx([0.9, 0.9])
    assert len(treads) == 2


def test_a_frontier_runs_along_the_rim_of_seen_floor_and_not_along_a_wall() -> None:
    labels = np.zeros((60, 60))
    labels[10:50, 10:40] = 1
    grid = cells(labels)
    occupancy = grid.occupancy.copy()
    occupancy[8:10, 8:42] = 2  # a wall below
    occupancy[50:52, 8:42] = 2
    walled = FloorGrid(0, (0.0, 0.0), 0.05, occupancy, grid.regions, ("a", "b"))
    ring = np.array([[0.5, 0.5], [2.0, 0.5], [2.0, 2.5], [0.5, 2.5]])
    frontier = Frontier(0, "a", np.array([2.0, 1.5, 0.0]), 4.0)

    lines = np.concatenate(frontier_lines(walled, frontier, (ring,)))

    assert lines[:, 0].max() == pytest.approx(2.0)
    right = lines[lines[:, 0] > 1.95]
    assert right[:, 1].min() < 0.7 and right[:, 1].max() > 2.3
    assert not ((lines[:, 0] > 0.6) & (lines[:, 0] < 1.85)).any()


def test_a_frontier_of_no_region_is_a_line_of_its_width() -> None:
    frontier = Frontier(0, "", np.array([1.0, 1.0, 0.0]), 0.8)
    (line,) = frontier_lines(cells(np.zeros((40, 40))), frontier, ())
    assert np.linalg.norm(line[1] - line[0]) == pytest.approx(0.8)
