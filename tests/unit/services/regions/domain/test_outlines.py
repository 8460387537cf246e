"""Outlines: rings in metres around cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra import numpy as arrays

from services.regions.domain.outlines import signed_area, trace_outlines


def test_a_square_of_cells_is_that_square() -> None:
    cells = np.zeros((30, 40), bool)
    cells[10:20, 10:30] = True
    outlines = trace_outlines(cells, (1.0, 2.0), 0.1)
    assert outlines.holes == ()
    assert sorted(map(tuple, np.round(outlines.outer[0], 9).tolist())) == [
        (2.0, 3.0),
        (2.0, 4.0),
        (4.0, 3.0),
        (4.0, 4.0),
    ]
    assert signed_area(outlines.outer[0]) == pytest.approx(2.0)


def test_a_slanted_edge_is_straightened() -> None:
    stairs = np.tri(20, dtype=bool)
    assert len(trace_outlines(stairs, (0, 0), 0.05, tolerance=0.0).outer[0]) == 42
    assert len(trace_outlines(stairs, (0, 0), 0.05).outer[0]) <= 5


def test_a_ring_of_cells_has_a_hole_that_turns_the_other_way() -> None:
    cells = np.ones((9, 9), bool)
    cells[3:6, 3:6] = False
    outlines = trace_outlines(cells, (0.0, 0.0), 1.0)
    assert len(outlines.outer) == len(outlines.holes) == 1
    assert signed_area(outlines.outer[0]) > 0 > signed_area(outlines.holes[0])


def test_cells_that_touch_by_a_corner_have_an_outline_each() -> None:
    assert len(trace_outlines(np.eye(2, dtype=bool), (0, 0), 0.05).outer) == 2


def test_one_cell_has_an_outline_and_no_cell_none() -> None:
    (ring,) = trace_outlines(np.ones((1, 1), bool), (0, 0), 0.05).outer
    assert len(ring) == 4
    assert ring.mean(axis=0) == pytest.approx([0.025, 0.025])
    assert trace_outlines(np.zeros((3, 3), bool), (0, 0), 0.05).outer == ()
    assert trace_outlines(np.zeros((0, 0), bool), (0, 0), 0.05).outer == ()


@settings(max_examples=60, deadline=None)
@given(arrays.arrays(np.bool_, (7, 8)))
def test_every_cell_that_is_set_lies_in_the_outlines(cells: np.ndarray) -> None:
    outlines = trace_outlines(cells, (0.0, 0.0), 1.0, tolerance=0.0)
    assert sum(map(signed_area, (*outlines.outer, *outlines.holes))) == pytest.approx(cells.sum())
    for row, column in np.ndindex(*cells.shape):
        turns = sum(_winding(ring, column + 0.5, row + 0.5) for ring in (*outlines.outer, *outlines.holes))
        assert turns == int(cells[row, column])


def _winding(ring: np.ndarray, x: float, y: float) -> int:
    offset = ring - (x, y)
    angle = np.arctan2(offset[:, 1], offset[:, 0])
    step = np.diff(np.append(angle, angle[0]))
    return round(float(((step + np.pi) % (2 * np.pi) - np.pi).sum() / (2 * np.pi)))
