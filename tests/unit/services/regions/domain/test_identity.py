"""Identity: ids stay with their floor."""

from __future__ import annotations

import numpy as np

from ovip.scene.grid import FREE, FloorGrid
from services.regions.domain.identity import keep_ids


def grid(
    regions: list[list[int]], ids: tuple[str, ...], origin: tuple[float, float] = (0.0, 0.0)
) -> FloorGrid:
    labels = np.array(regions, np.uint16)
    return FloorGrid(0, origin, 1.0, np.full(labels.shape, FREE, np.uint8), labels, ids)


def test_first_regions_are_numbered_in_order() -> None:
    named = keep_ids(np.array([[1, 2]], np.int32), 2, (0, 0), None, 1)
    assert (named.ids, named.next_number) == (("r1", "r2"), 3)


def test_regions_keep_their_ids_when_their_labels_change() -> None:
    before = grid([[1, 1, 2, 2]], ("r1", "r2"))
    assert keep_ids(np.array([[2, 2, 1, 1]], np.int32), 2, (0, 0), before, 3).ids == ("r2", "r1")


def test_a_split_region_leaves_its_id_to_the_larger_part_and_an_id_is_never_used_again() -> None:
    before = grid([[1, 1, 1, 1, 1]], ("r4",))
    named = keep_ids(np.array([[1, 1, 2, 2, 2]], np.int32), 2, (0, 0), before, 7)
    assert (named.ids, named.next_number) == (("r7", "r4"), 8)


def test_the_grids_may_start_in_different_places() -> None:
    before = grid([[1, 2]], ("r1", "r2"), origin=(3.0, 5.0))
    labels = np.zeros((3, 4), np.int32)
    labels[2, 3], labels[2, 2] = 1, 2
    assert keep_ids(labels, 2, (1.0, 3.0), before, 3).ids == ("r2", "r1")


def test_a_region_elsewhere_is_new() -> None:
    before = grid([[1, 1]], ("r1",))
    assert keep_ids(np.ones((1, 2), np.int32), 1, (9.0, 9.0), before, 2).ids == ("r2",)


def test_a_touch_is_not_enough() -> None:
    before = grid([[1] * 20 + [0] * 19], ("r1",))
    labels = np.array([[0] * 19 + [1] * 20], np.int32)
    assert keep_ids(labels, 1, (0, 0), before, 2).ids == ("r2",)


def test_no_regions_have_no_ids() -> None:
    assert keep_ids(np.zeros((0, 0), np.int32), 0, (0, 0), grid([[1]], ("r1",)), 2).ids == ()
    assert keep_ids(np.ones((1, 1), np.int32), 1, (0, 0), grid([[0]], ()), 2).ids == ("r2",)
