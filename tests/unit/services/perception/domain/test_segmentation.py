"""Masks by depth: the surface that reaches the middle of the box."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.scene.types import F32, Box2
from services.perception.domain.segmentation import pixels_of, surface_mask

WALL = np.full((48, 64), 3.0, np.float32)


def _cup_before_a_wall() -> F32:
    depth = WALL.copy()
    depth[16:32, 24:40] = 1.5
    return depth


def test_the_thing_before_a_wall_is_cut_out_along_its_depth_edge() -> None:
    mask = surface_mask(_cup_before_a_wall(), Box2(20, 12, 44, 36))

    rows, columns = np.nonzero(mask)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (17, 31, 25, 39)
    assert mask.sum() == 15 * 15  # its first row and column are the edge itself


def test_a_flat_box_is_taken_whole() -> None:
    mask = surface_mask(WALL, Box2(10, 10, 20, 20))

    assert mask.sum() == 100
    assert mask[10:20, 10:20].all()


def test_a_slanted_table_is_one_surface() -> None:
    """2 cm a pixel at 2 m is 1 percent, below the jump."""
    depth = np.repeat(np.linspace(1.5, 2.4, 48, dtype=np.float32)[:, None], 64, axis=1)

    assert surface_mask(depth, Box2(10, 10, 50, 40)).sum() == 40 * 30


def test_holes_in_the_depth_are_not_masked() -> None:
    depth = WALL.copy()
    depth[20:22, 30:32] = 0.0

    mask = surface_mask(depth, Box2(20, 10, 44, 34))

    assert not mask[20:22, 30:32].any()
    assert mask.sum() > 500


@pytest.mark.parametrize(
    "box",
    [Box2(10, 10, 10, 20), Box2(200, 200, 220, 220), Box2(-30, -30, -10, -10), Box2(20, 20, 10, 10)],
)
def test_a_box_without_pixels_masks_nothing(box: Box2) -> None:
    assert not surface_mask(WALL, box).any()


def test_a_box_without_depth_masks_nothing() -> None:
    assert not surface_mask(np.zeros((48, 64), np.float32), Box2(10, 10, 20, 20)).any()


def test_a_box_whose_middle_has_no_depth_masks_nothing() -> None:
    depth = WALL.copy()
    depth[14:27, 14:27] = 0.0

    assert not surface_mask(depth, Box2(10, 10, 30, 30)).any()


def test_of_two_surfaces_the_one_with_most_of_the_middle_wins() -> None:
    depth = WALL.copy()
    depth[:, 30:] = 1.0

    left = surface_mask(depth, Box2(10, 10, 44, 40))
    right = surface_mask(depth, Box2(18, 10, 52, 40))

    assert left[20, 12] and not left[20, 40]
    assert right[20, 50] and not right[20, 20]


@given(st.floats(-20, 80), st.floats(-20, 60), st.floats(0, 60), st.floats(0, 60), st.integers(0, 2**32 - 1))
def test_a_mask_stays_inside_its_box_and_on_measured_depth(
    x: float, y: float, w: float, h: float, seed: int
) -> None:
    depth = np.random.default_rng(seed).choice([0.0, 1.0, 1.01, 2.0], (48, 64)).astype(np.float32)
    box = Box2(x, y, x + w, y + h)

    mask = surface_mask(depth, box)

    x0, y0, x1, y1 = pixels_of(box, depth.shape)
    outside = mask.copy()
    outside[y0:y1, x0:x1] = False
    assert not outside.any()
    assert (depth[mask] > 0).all()


def test_pixels_of_a_box_are_whole_and_inside() -> None:
    assert pixels_of(Box2(1.2, 2.9, 10.1, 11.0), (48, 64)) == (1, 2, 11, 11)
    assert pixels_of(Box2(-5, -5, 500, 500), (48, 64)) == (0, 0, 64, 48)
