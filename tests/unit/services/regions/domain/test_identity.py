"""Identity: ids stay with their floor."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.grid import FREE, FloorGrid
from ovip.scene.types import I32
from services.regions.domain.identity import keep_ids, shared_cells


def grid(
    regions: list[list[int]] | I32, ids: tuple[str, ...], origin: tuple[float, float] = (0.0, 0.0)
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


def test_of_regions_that_merge_the_one_that_gives_most_floor_keeps_its_id() -> None:
    before = grid([[1, 1, 2, 2, 2]], ("r1", "r2"))
    named = keep_ids(np.ones((1, 5), np.int32), 1, (0, 0), before, 3)
    assert (named.ids, named.next_number) == (("r2",), 3)


def test_ids_go_so_that_the_floor_kept_is_largest_in_sum() -> None:
    # a shares 3 cells with r1 and 2 with r2, b shares 2 with r1: a to r2 and b to r1 keep 4, a to r1 alone 3
    before = grid([[1, 1, 1, 2, 2, 1, 1]], ("r1", "r2"))
    labels = np.array([[1, 1, 1, 1, 1, 2, 2]], np.int32)
    assert keep_ids(labels, 2, (0, 0), before, 3).ids == ("r2", "r1")


def test_a_region_that_vanished_and_comes_back_is_a_new_one() -> None:
    first = np.array([[1, 1, 1, 2]], np.int32)
    named = keep_ids(first, 2, (0, 0), None, 1)
    merged = np.ones((1, 4), np.int32)
    without = keep_ids(merged, 1, (0, 0), grid(first, named.ids), named.next_number)
    again = keep_ids(first, 2, (0, 0), grid(merged, without.ids), without.next_number)
    assert (without.ids, again.ids) == (("r1",), ("r1", "r3"))


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


def test_shared_cells_are_counted_pair_by_pair_with_none_in_front() -> None:
    before = grid([[1, 1, 0], [2, 2, 0]], ("r1", "r2"), origin=(1.0, 0.0))
    labels = np.array([[1, 1, 2], [1, 1, 0]], np.int32)  # its first column lies left of the older grid
    assert shared_cells(labels, 2, (0.0, 0.0), before).tolist() == [[0, 0, 1], [2, 1, 1], [0, 1, 0]]
    assert shared_cells(labels, 2, (0.0, 0.0), None).tolist() == [[1], [4], [1]]


LABELS = hnp.arrays(np.int32, st.tuples(st.integers(1, 6), st.integers(1, 6)), elements=st.integers(0, 4))


def dense(labels: I32) -> tuple[I32, int]:
    """Labels without gaps, and how many."""
    used, inverse = np.unique(np.append(labels.ravel(), 0), return_inverse=True)
    return inverse[:-1].reshape(labels.shape).astype(np.int32), len(used) - 1


@given(LABELS, LABELS)
def test_ids_are_unique_and_new_ones_are_above_all_that_were(first: I32, second: I32) -> None:
    (first, count), (second, count_after) = dense(first), dense(second)
    named = keep_ids(first, count, (0, 0), None, 5)
    after = keep_ids(second, count_after, (0, 0), grid(first, named.ids), named.next_number)
    assert len(set(after.ids)) == count_after
    new = [int(name[1:]) for name in after.ids if name not in named.ids]
    assert new == list(range(named.next_number, after.next_number))


@given(LABELS, st.randoms(use_true_random=False), st.integers(-3, 3), st.integers(-3, 3))
def test_the_same_regions_keep_their_ids_in_any_order_on_a_grid_that_starts_elsewhere(
    labels: I32, random: object, dx: int, dy: int
) -> None:
    labels, count = dense(labels)
    named = keep_ids(labels, count, (0, 0), None, 1)
    order = list(range(1, count + 1))
    random.shuffle(order)  # type: ignore[attr-defined]
    renumbered = np.array([0, *order], np.int32)[labels]
    wide = np.zeros((labels.shape[0] + 6, labels.shape[1] + 6), np.int32)
    wide[3 + dy : 3 + dy + labels.shape[0], 3 + dx : 3 + dx + labels.shape[1]] = renumbered
    again = keep_ids(wide, count, (-3.0 - dx, -3.0 - dy), grid(labels, named.ids), named.next_number)
    assert again.next_number == named.next_number
    assert [again.ids[order[k] - 1] for k in range(count)] == list(named.ids)
