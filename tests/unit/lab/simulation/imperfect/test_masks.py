"""How masks go wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.simulation.imperfect import SeenFrame
from lab.simulation.imperfect.masks import (
    box_of_mask,
    cut_short,
    on_border,
    parts,
    patch_of,
    with_border_error,
)
from ovip.scene.camera import lift_pixels
from ovip.scene.types import F32, Bools, Box2

TABLE = 2  # of the tabletop
SQUARE = np.zeros((40, 60), dtype=bool)
SQUARE[10:20, 20:40] = True


def world(seen: SeenFrame, mask: Bools) -> F32:
    index = np.flatnonzero(mask)
    return lift_pixels(index, seen.depth.ravel()[index], seen.intrinsics, seen.world_from_camera)


def test_a_mask_s_box_is_half_open() -> None:
    assert box_of_mask(SQUARE) == Box2(20.0, 10.0, 40.0, 20.0)


def test_border_errors_move_every_side_by_so_many_pixels() -> None:
    assert box_of_mask(with_border_error(SQUARE, 2)) == Box2(18.0, 8.0, 42.0, 22.0)
    assert box_of_mask(with_border_error(SQUARE, -3)) == Box2(23.0, 13.0, 37.0, 17.0)
    assert with_border_error(SQUARE, 0) is SQUARE


def test_a_mask_is_never_eroded_away() -> None:
    assert np.array_equal(with_border_error(SQUARE, -9), SQUARE)


def test_erosion_leaves_the_side_at_the_image_s_border() -> None:
    mask = np.zeros((40, 60), dtype=bool)
    mask[:, :20] = True
    assert box_of_mask(with_border_error(mask, -3)) == Box2(0.0, 0.0, 17.0, 40.0)


@given(st.integers(0, 10_000))
def test_a_mask_cut_short_loses_30_to_60_percent_at_one_side(seed: int) -> None:
    left = cut_short(SQUARE, np.random.default_rng(seed))
    assert not (left & ~SQUARE).any()
    assert 0.35 <= left.sum() / SQUARE.sum() <= 0.75  # rounded to whole pixels
    box, whole = box_of_mask(left), box_of_mask(SQUARE)
    assert sum(getattr(box, side) != getattr(whole, side) for side in ("x0", "y0", "x1", "y1")) == 1


def test_only_a_mask_that_reaches_the_image_s_edge_is_on_its_border() -> None:
    assert not on_border(SQUARE)
    for at in (np.s_[0, 30], np.s_[-1, 30], np.s_[15, 0], np.s_[15, -1]):
        mask = SQUARE.copy()
        mask[at] = True
        assert on_border(mask)


def test_a_patch_surrounds_the_mask_and_holds_only_the_other_thing() -> None:
    other = np.zeros_like(SQUARE)
    other[20:] = True
    patch = patch_of(other, SQUARE, np.random.default_rng(0))
    assert patch.any() and not (patch & ~other).any()
    box = box_of_mask(patch)
    assert box.x0 >= 20 - 10 and box.x1 <= 40 + 10 and box.y1 <= 20 + 5  # half the box at most


def test_parts_are_disjoint_pieces_of_the_thing_largest_first(tabletop: list[SeenFrame]) -> None:
    seen = tabletop[0]
    mask = seen.ids == TABLE
    pieces = parts(seen, mask, TABLE, 0, (0.4, 0.8))
    assert 2 <= len(pieces) <= 3
    sizes = [int(piece.sum()) for piece in pieces]
    assert sizes == sorted(sizes, reverse=True) and min(sizes) >= 0.05 * mask.sum()
    assert np.sum(pieces, axis=0).max() == 1 and not (np.any(pieces, axis=0) & ~mask).any()


def test_a_part_is_the_same_part_of_space_seen_from_elsewhere(tabletop: list[SeenFrame]) -> None:
    seen = tabletop[0]
    pose = seen.world_from_camera.copy()
    pose[:3, 3] += pose[:3, 0] * 20 * 2.0 / seen.intrinsics.fx  # to the right by 20 pixels at 2 m
    moved = replace(
        seen,
        world_from_camera=pose,
        ids=np.roll(seen.ids, -20, axis=1),
        depth=np.roll(seen.depth, -20, axis=1),
    )
    first = parts(seen, seen.ids == TABLE, TABLE, 0, (0.4, 0.8))
    second = parts(moved, moved.ids == TABLE, TABLE, 0, (0.4, 0.8))
    for before, after in zip(first, second, strict=True):
        assert world(moved, after) == pytest.approx(world(seen, before), abs=1e-5)


def test_a_thing_smaller_than_its_cell_has_no_parts(tabletop: list[SeenFrame]) -> None:
    seen = tabletop[0]
    assert parts(seen, seen.ids == TABLE, TABLE, 0, (50.0, 60.0)) == []
    assert parts(seen, np.zeros_like(seen.ids, dtype=bool), TABLE, 0, (0.4, 0.8)) == []
