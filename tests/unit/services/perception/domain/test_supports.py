"""Masks that hold what a thing stands on: a table on a floor, things on the table, seen from above."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.scene.types import F32, F64, I64, Bools, Frame
from services.perception.domain.lifting import Lifted, LiftParams, lift, lift_all
from services.perception.domain.masks import patch_of
from services.perception.domain.supports import SupportParams, support_heights
from tests.builders import camera, frame, pose

K = camera(320, 240, 260.0)
EYE = pose(z=1.4, pitch=0.55)
TABLE_TOP = [1.2, -0.6, 0.72, 2.0, 0.6, 0.75]
LEGS = [[x, y, 0.0, x + 0.04, y + 0.04, 0.72] for x in (1.2, 1.96) for y in (-0.6, 0.56)]
CUP = [1.5, -0.05, 0.75, 1.6, 0.05, 0.86]
BOOK = [1.4, 0.2, 0.75, 1.65, 0.4, 0.765]
FLOOR, TABLE, CUP_ID, BOOK_ID = 0, 1, 2, 3
PARAMS = LiftParams()
WITHOUT = LiftParams(support=SupportParams(share=2.0))


def _room(*things: list[list[float]], noise: float = 0.0) -> tuple[Frame, I64]:
    """A frame of boxes on a floor, and which thing (from 1) each pixel `(H, W)` shows; 0 is the floor."""
    rows, columns = np.mgrid[: K.height, : K.width]
    rays: F64 = np.stack([(columns - K.cx) / K.fx, (rows - K.cy) / K.fy, np.ones(rows.shape)], axis=-1)
    rays = rays @ EYE[:3, :3].T
    depth, ids = np.where(rays[..., 2] < 0, -EYE[2, 3] / rays[..., 2], 0.0), np.zeros(rows.shape, np.int64)
    for number, boxes in enumerate(things, start=1):
        for box in np.array(boxes):
            a, b = (box[:3] - EYE[:3, 3]) / rays, (box[3:] - EYE[:3, 3]) / rays
            enter, leave = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
            nearer = (enter < leave) & (enter > 0) & ((enter < depth) | (depth == 0))
            depth, ids = np.where(nearer, enter, depth), np.where(nearer, number, ids)
    depth = depth + noise * np.random.default_rng(0).standard_normal(depth.shape)
    return frame(depth.astype(np.float32), k=K, world_from_camera=EYE), ids


def _laid_table(noise: float = 0.0) -> tuple[Frame, I64]:
    return _room([TABLE_TOP, *LEGS], [CUP], [BOOK], noise=noise)


def _around(ids: I64, thing: int, pixels: int) -> Bools:
    """All pixels of the box around a thing, grown: a mask that holds what is beneath and beside it."""
    rows, columns = np.nonzero(ids == thing)
    mask = np.zeros(ids.shape, np.bool_)
    mask[
        rows.min() - pixels : rows.max() + pixels + 1, columns.min() - pixels : columns.max() + pixels + 1
    ] = True
    return mask


def _lifted(seen: Frame, mask: Bools, params: LiftParams = PARAMS) -> Lifted:
    made = lift(seen, mask, params)
    assert made is not None
    return made


def _size(points: F32) -> F32:
    return np.asarray(np.ptp(points, axis=0))


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_a_mask_that_covers_a_cup_and_the_table_under_it_lifts_the_cup(noise: float) -> None:
    seen, ids = _laid_table(noise)
    mask = _around(ids, CUP_ID, 4)

    cup, bled = _lifted(seen, mask), _lifted(seen, mask, WITHOUT)

    assert _size(bled.points)[:2].max() > 0.2  # the table behind the cup
    assert _size(cup.points)[:2] == pytest.approx([0.1, 0.1], abs=0.06)
    assert cup.box[5] == pytest.approx(0.86, abs=0.02)


def test_a_cup_s_own_mask_keeps_its_foot() -> None:
    seen, ids = _laid_table()

    cup, untrimmed = _lifted(seen, ids == CUP_ID), _lifted(seen, ids == CUP_ID, WITHOUT)

    assert np.array_equal(cup.points, untrimmed.points)


def test_the_floor_between_a_table_s_legs_is_not_the_table_s() -> None:
    seen, ids = _laid_table()
    table = _around(ids, TABLE, 0)  # all that is seen under it, too

    trimmed, bled = _lifted(seen, table), _lifted(seen, table, WITHOUT)

    assert (bled.points[:, 2] < 0.02).sum() > 500
    assert (trimmed.points[:, 2] < 0.02).sum() == 0
    assert trimmed.box[5] == pytest.approx(0.86, abs=0.02)  # the cup is still on it
    assert trimmed.box[2] < 0.06  # and its legs reach down


def test_what_is_flat_on_the_table_stays_whole() -> None:
    seen, ids = _laid_table()
    mask = _around(ids, BOOK_ID, 3)

    assert np.array_equal(_lifted(seen, mask).points, _lifted(seen, mask, WITHOUT).points)


def test_a_rug_on_the_floor_stays_whole() -> None:
    seen, ids = _room([[1.0, -0.8, 0.0, 2.2, 0.8, 0.01]])

    assert np.array_equal(_lifted(seen, ids == 1).points, _lifted(seen, ids == 1, WITHOUT).points)


def test_a_rug_stays_whole_though_something_small_stands_on_it_in_its_mask() -> None:
    seen, ids = _room([[1.0, -0.8, 0.0, 2.2, 0.8, 0.01]], [[1.6, 0.0, 0.01, 1.75, 0.15, 0.2]])

    assert np.array_equal(_lifted(seen, ids > 0).points, _lifted(seen, ids > 0, WITHOUT).points)


def test_a_table_s_top_stays_whole_though_it_is_cut_by_its_mask() -> None:
    """A part of the table: the level goes on beyond the mask, and nothing stands over it."""
    seen, ids = _laid_table()
    part = ids == TABLE
    part[:, K.width // 3 :] = False
    part[160:] = False

    assert np.array_equal(_lifted(seen, part).points, _lifted(seen, part, WITHOUT).points)


def test_a_thing_with_nothing_level_around_it_has_no_support() -> None:
    """A wall seen straight ahead has no level at its low end."""
    wall = frame(2.0, k=K, world_from_camera=pose(z=1.4))
    mask = np.zeros((K.height, K.width), np.bool_)
    mask[60:120, 100:200] = True

    assert np.isnan(support_heights(wall, [patch_of(mask)], SupportParams())).all()


def test_the_level_under_a_cup_is_the_table_s_and_under_a_table_the_floor_s() -> None:
    seen, ids = _laid_table()

    patches = [patch_of(ids == CUP_ID), patch_of(_around(ids, TABLE, 0))]
    found = support_heights(seen, patches, SupportParams())

    assert found == pytest.approx([0.75, 0.0], abs=0.01)


def test_a_ceiling_is_no_support() -> None:
    above = np.diag([1.0, -1.0, 1.0, 1.0])  # looks straight up
    seen = frame(2.0, k=K, world_from_camera=np.asarray(above))
    mask = np.zeros((K.height, K.width), np.bool_)
    mask[60:120, 100:200] = True

    assert np.isnan(support_heights(seen, [patch_of(mask)], SupportParams())).all()


def test_without_depth_there_is_no_support() -> None:
    mask = np.ones((K.height, K.width), np.bool_)
    dark = frame(0.0, k=K, world_from_camera=EYE)

    assert np.isnan(support_heights(dark, [patch_of(mask), patch_of(~mask)], SupportParams())).all()


def test_the_table_s_points_are_without_the_cup_that_has_its_own_mask() -> None:
    seen, ids = _laid_table()

    table, cup = lift_all(seen, [(ids == TABLE) | (ids == CUP_ID), ids == CUP_ID], PARAMS)

    assert table is not None and cup is not None
    assert table.box[5] < 0.76
    assert cup.box[5] == pytest.approx(0.86, abs=0.02)
