"""Rays against boxes and cylinders."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.solids import Finish, Shape, Solid, footprint_distance, hit


def _solid(shape: Shape, center=(0.0, 0.0, 0.0), half=(1.0, 2.0, 3.0), yaw: float = 0.0) -> Solid:
    return Solid(shape, center, half, yaw, 1, (255, 255, 255), Finish.PLAIN)


def _hit(solid: Solid, origin, direction) -> float:
    return float(hit(solid, np.array(origin, float), np.array([direction], np.float32))[0])


def test_a_box_is_met_at_its_near_face() -> None:
    box = _solid(Shape.BOX)
    assert _hit(box, (-5, 0, 0), (1, 0, 0)) == pytest.approx(4)
    assert _hit(box, (-5, 0, 0), (2, 0, 0)) == pytest.approx(2)  # counted in lengths of the direction
    assert _hit(box, (0, -7, 0), (0, 1, 0)) == pytest.approx(5)
    assert _hit(box, (-5, 2.1, 0), (1, 0, 0)) == np.inf
    assert _hit(box, (-5, 0, 0), (-1, 0, 0)) == np.inf
    assert _hit(box, (0, 0, 0), (1, 0, 0)) == np.inf  # from inside nothing of it is seen


def test_a_box_turned_by_a_quarter_swaps_its_sides() -> None:
    assert _hit(_solid(Shape.BOX, yaw=np.pi / 2), (-5, 0, 0), (1, 0, 0)) == pytest.approx(3)


def test_a_cylinder_is_met_on_its_side_and_on_its_end() -> None:
    cylinder = _solid(Shape.CYLINDER, half=(2.0, 2.0, 1.0))
    assert _hit(cylinder, (-5, 0, 0), (1, 0, 0)) == pytest.approx(3)
    assert _hit(cylinder, (-5, 1.2, 0), (1, 0, 0)) == pytest.approx(
        5 - 1.6
    )  # 1.2, 1.6, 2 is a right triangle
    assert _hit(cylinder, (0.5, 0.5, 4), (0, 0, -1)) == pytest.approx(3)
    assert _hit(cylinder, (1.5, 1.5, 4), (0, 0, -1)) == np.inf
    assert _hit(cylinder, (-5, 0, 1.5), (1, 0, 0)) == np.inf


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), st.sampled_from(list(Shape)))
def test_what_is_hit_lies_in_the_bounds(yaw: float, x: float, y: float, shape: Shape) -> None:
    solid = _solid(shape, (x, y, 0.5), (0.4, 0.4, 0.9) if shape is Shape.CYLINDER else (0.4, 0.7, 0.9), yaw)
    origin = np.array([6.0, -6.0, 2.0])
    grid = np.random.default_rng(0).uniform(-1, 1, (400, 3)) + (np.array([x, y, 0.5]) - origin)
    distance = hit(solid, origin, grid.astype(np.float32))
    points = origin + grid[np.isfinite(distance)] * distance[np.isfinite(distance)][:, None]
    bounds = solid.bounds()
    assert len(points) > 0
    assert (points >= bounds[:3] - 1e-4).all()
    assert (points <= bounds[3:] + 1e-4).all()


def test_distance_from_a_footprint_by_hand() -> None:
    box = _solid(Shape.BOX, (1.0, 1.0, 0.0), (1.0, 0.5, 1.0))
    np.testing.assert_allclose(footprint_distance(box, np.array([[1, 1], [5, 5.5], [1, 2]])), [0, 5, 0.5])
    cylinder = _solid(Shape.CYLINDER, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    np.testing.assert_allclose(footprint_distance(cylinder, np.array([[3, 4], [0.5, 0]])), [4, 0])
