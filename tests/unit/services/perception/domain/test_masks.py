"""Masks before lifting: their boxes, their borders, and which of two that overlap has the pixels."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ovip.scene.types import Bools
from services.perception.domain.masks import (
    ContainedParams,
    Patch,
    patch_of,
    shaved,
    thinned,
    without_contained,
)

SHAPE = (60, 80)
PARAMS = ContainedParams()


def _mask(y0: int, y1: int, x0: int, x1: int) -> Bools:
    mask = np.zeros(SHAPE, np.bool_)
    mask[y0:y1, x0:x1] = True
    return mask


def _whole(patch: Patch) -> Bools:
    mask = np.zeros(SHAPE, np.bool_)
    mask[patch.window] = patch.inside
    return mask


@given(st.integers(0, 2**32 - 1), st.floats(0, 0.01))
@settings(max_examples=30)
def test_a_patch_holds_its_mask_in_the_smallest_box(seed: int, share: float) -> None:
    mask = np.random.default_rng(seed).random(SHAPE) < share

    patch = patch_of(mask)

    assert (_whole(patch) == mask).all()
    assert patch.area == mask.sum()
    assert patch.pixels(SHAPE[1]).tolist() == np.flatnonzero(mask).tolist()
    if mask.any():
        assert patch.inside[0].any() and patch.inside[-1].any()
        assert patch.inside[:, 0].any() and patch.inside[:, -1].any()


def test_shaving_takes_a_border_off_unless_two_thirds_would_go() -> None:
    wide, thin = patch_of(_mask(10, 30, 10, 40)), patch_of(_mask(10, 15, 10, 40))

    assert (_whole(shaved(wide, 2)) == _mask(12, 28, 12, 38)).all()
    assert shaved(thin, 2) is thin  # 1 x 26 of 5 x 30 would be left
    assert shaved(wide, 0) is wide


def test_a_mask_is_shaved_at_the_image_border_too() -> None:
    assert (_whole(shaved(patch_of(_mask(0, 30, 0, 40)), 2)) == _mask(2, 28, 2, 38)).all()


def test_thinning_leaves_one_pixel_of_so_many_in_each_row() -> None:
    left = _whole(thinned(patch_of(_mask(10, 30, 10, 50)), 4))

    assert (left[10:30, 10:50].sum(axis=1) == 10).all()
    assert left.sum() == 200
    columns = np.flatnonzero(left[10]), np.flatnonzero(left[11])
    assert (np.diff(columns[0]) == 4).all()
    assert not set(columns[0]) & set(columns[1])


def test_thinning_by_one_leaves_all() -> None:
    patch = patch_of(_mask(10, 30, 10, 50))

    assert thinned(patch, 1) is patch


# One mask in another


def test_a_cup_in_a_table_s_mask_is_taken_out_of_the_table() -> None:
    table, cup = _mask(20, 50, 10, 70), _mask(15, 30, 30, 40)
    cup[:18] = False  # 120 pixels, 20 of them beyond the table

    left = without_contained([patch_of(table), patch_of(cup)], PARAMS)

    assert (_whole(left[0]) == (table & ~cup)).all()
    assert (_whole(left[1]) == cup).all()


def test_of_two_masks_of_one_thing_neither_loses_anything() -> None:
    one, other = patch_of(_mask(20, 50, 10, 70)), patch_of(_mask(22, 50, 10, 68))  # 90 % of it

    assert without_contained([one, other], PARAMS) == [one, other]


def test_masks_that_merely_overlap_keep_their_pixels() -> None:
    sofa, table = patch_of(_mask(10, 40, 0, 60)), patch_of(_mask(30, 50, 20, 50))  # a third of the table's

    assert without_contained([sofa, table], PARAMS) == [sofa, table]


def test_each_of_a_nest_of_masks_keeps_its_own_pixels() -> None:
    shelf, box, toy = _mask(0, 60, 0, 80), _mask(10, 40, 10, 50), _mask(15, 25, 15, 25)

    left = without_contained([patch_of(mask) for mask in (box, toy, shelf)], PARAMS)

    assert [patch.area for patch in left] == [30 * 40 - 100, 100, 60 * 80 - 30 * 40]


def test_an_empty_mask_takes_nothing_and_loses_nothing() -> None:
    empty, full = patch_of(np.zeros(SHAPE, np.bool_)), patch_of(_mask(10, 30, 10, 40))

    left = without_contained([empty, full], PARAMS)

    assert [patch.area for patch in left] == [0, 600]
    assert shaved(empty, 2).area == 0
