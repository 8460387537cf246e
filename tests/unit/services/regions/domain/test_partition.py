"""Algorithm 1, line by line, on rooms that can be checked by eye."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.scene.types import F64, Bools
from services.regions.domain.partition import (
    PartitionParams,
    Relief,
    arrival,
    clearance_of,
    cluster,
    find_cores,
    partition_storey,
    place_markers,
    regions_at,
    seed_groups,
    snap,
)

PARAMS = PartitionParams()
MASKS = arrays.arrays(np.bool_, st.tuples(st.integers(0, 24), st.integers(0, 24)))


def hall(rows: int = 60, columns: int = 60) -> Bools:
    """One open rectangle of floor, 0.05 m a cell."""
    return np.ones((rows, columns), bool)


def two_halls(opening: int) -> Bools:
    """Two halls of 60 x 60 cells and a wall 2 cells thick between them with an opening of so many cells."""
    free = np.ones((60, 122), bool)
    free[:, 60:62] = False
    middle = 30 - opening // 2
    free[middle : middle + opening, 60:62] = True
    return free


def cells(*pairs: tuple[float, float]) -> F64:
    return np.array(pairs, dtype=np.float64).reshape(-1, 2)


# 1: D


def test_clearance_is_the_distance_to_the_nearest_cell_that_is_not_free_the_edge_included() -> None:
    assert clearance_of(np.ones((1, 3), bool), 0.5).tolist() == [[0.5, 0.5, 0.5]]
    walled = np.ones((9, 9), bool)
    walled[4, 0] = False
    assert clearance_of(walled, 0.05)[4, 3] == pytest.approx(0.15)
    assert clearance_of(walled, 0.05)[7, 4] == pytest.approx(0.10)


# 2, 3: C_0


def test_a_core_begins_more_than_six_cells_from_what_is_not_free() -> None:
    cores = find_cores(hall(), PARAMS)
    assert np.argwhere(cores).min(axis=0).tolist() == [6, 6]
    assert np.argwhere(cores).max(axis=0).tolist() == [53, 53]


def test_an_opening_of_twelve_cells_parts_two_cores_and_one_of_fourteen_does_not() -> None:
    assert find_cores(two_halls(12), PARAMS).max() == 2
    assert find_cores(two_halls(14), PARAMS).max() == 1


def test_small_cores_are_dropped() -> None:
    free = np.zeros((60, 90), bool)
    free[:, :60] = True
    free[:20, 65:85] = True  # its core is 8 x 8 cells = 0.16 square metres
    assert find_cores(free, PARAMS).max() == 1
    assert find_cores(free, replace(PARAMS, min_core=0.1)).max() == 2


def test_a_floor_too_narrow_for_any_core_is_one_core_a_piece() -> None:
    corridors = np.zeros((12, 40), bool)
    corridors[1:5] = corridors[7:11] = True
    assert find_cores(corridors, PARAMS).max() == 2


# 6: snap


def test_an_object_in_a_wall_snaps_to_the_nearest_free_cell_ties_to_the_first() -> None:
    free = np.array([[True, False, True]])
    assert snap(cells((0, 1)), free).tolist() == [[0, 0]]
    assert snap(cells((0, 1.2)), free).tolist() == [[0, 2]]
    assert snap(cells((0, 1)), np.zeros((1, 3), bool)).tolist() == [[-1, -1]]


# 7-20: seed groups and markers


def test_a_core_of_one_function_is_one_group_however_far_apart_its_objects() -> None:
    basins = np.ones((200, 200), np.int32)
    (group,) = seed_groups(basins, np.array([[5, 5], [190, 190]]), ("kitchen", "kitchen"), PARAMS)
    assert (group.function, group.members) == ("kitchen", (0, 1))


def test_a_mixed_core_is_split_by_function_and_then_by_two_metres() -> None:
    basins = np.ones((200, 200), np.int32)
    snapped = np.array([[0, 0], [0, 40], [0, 81], [100, 0]])  # 2.00 m and 2.05 m apart in a row
    groups = seed_groups(basins, snapped, ("kitchen", "kitchen", "kitchen", "office"), PARAMS)
    assert [(g.function, g.members) for g in groups] == [
        ("kitchen", (0, 1)),
        ("kitchen", (2,)),
        ("office", (3,)),
    ]


def test_an_object_of_unknown_function_divides_nothing() -> None:
    basins = np.ones((100, 100), np.int32)
    snapped = np.array([[10, 10], [10, 60], [90, 90]])
    (group,) = seed_groups(basins, snapped, ("kitchen", "unknown", "kitchen"), PARAMS)
    assert group.members == (0, 1, 2)
    groups = seed_groups(basins, snapped, ("kitchen", "unknown", "office"), PARAMS)
    assert [g.members for g in groups] == [(0,), (2,)]
    (group,) = seed_groups(basins, snapped, ("unknown",) * 3, PARAMS)
    assert group.function == "unknown"


def test_an_empty_core_is_unknown_from_a_min_on() -> None:
    basins = np.zeros((40, 40), np.int32)
    basins[:20, :20] = 1  # one square metre
    basins[30:, 30:] = 2  # a quarter of one
    assert [(g.function, g.core) for g in seed_groups(basins, cells().astype(int), (), PARAMS)] == [
        ("unknown", 1)
    ]


def test_where_nothing_would_make_a_marker_the_largest_core_does() -> None:
    basins = np.zeros((9, 9), np.int32)
    basins[:3, :3], basins[5:, 5:] = 1, 2
    (group,) = seed_groups(basins, cells().astype(int), (), PARAMS)
    assert (group.function, group.core, group.members) == ("unknown", 2, ())


def test_a_marker_is_a_disc_of_thirty_centimetres_inside_its_core() -> None:
    basins = np.ones((41, 41), np.int32)
    basins[:, 22:] = 2
    snapped = np.array([[20, 20]])
    markers = place_markers(basins, snapped, seed_groups(basins, snapped, ("kitchen",), PARAMS), PARAMS)
    disc = np.argwhere(markers == 1)
    assert disc.min(axis=0).tolist() == [14, 14]
    assert disc.max(axis=0).tolist() == [26, 21]
    assert (
        markers[:, 22:] == 2
    ).all()  # the other core is empty and larger than A_min, so all of it is marked


def test_discs_that_overlap_part_half_way_and_ties_go_to_the_earlier_group() -> None:
    basins = np.ones((20, 20), np.int32)
    snapped = np.array([[10, 8], [10, 12], [10, 12]])
    groups = seed_groups(basins, snapped, ("kitchen", "office", "bedroom"), PARAMS)
    markers = place_markers(basins, snapped, groups, PARAMS)
    assert markers[10, 9] == 1
    assert markers[10, 10] == 1
    assert markers[10, 11] == 2
    assert not (markers == 3).any()


def test_a_group_without_a_marker_has_no_region_but_its_objects_do() -> None:
    cut = partition_storey(hall(), cells((30, 8), (30, 52), (30, 52)), ("kitchen", "office", "bedroom"))
    assert [g.function for g in cut.groups] == ["kitchen", "office"]
    assert cut.region_of_object.tolist() == [0, 1, 1]


# 22: R


def test_two_functions_in_one_hall_share_it_half_and_half() -> None:
    for relief in Relief:
        cut = partition_storey(
            hall(), cells((30, 12), (30, 47)), ("kitchen", "office"), PartitionParams(relief=relief)
        )
        assert (cut.labels > 0).all()
        assert np.bincount(cut.labels.ravel())[1:] == pytest.approx([1800, 1800], rel=0.1)


def test_the_border_between_two_functions_falls_into_the_doorway() -> None:
    for relief in Relief:
        cut = partition_storey(
            two_halls(16), cells((30, 25), (30, 97)), ("kitchen", "office"), PartitionParams(relief=relief)
        )
        assert cut.cores.max() == 1
        assert (cut.labels[:, :60] == 1).all()
        assert (cut.labels[:, 62:] == 2).all()


def test_on_clearance_the_deepest_marker_takes_the_hall_and_on_arrival_they_share_it() -> None:
    middle_and_wall = cells((30, 30), (30, 1))
    functions = ("living room", "kitchen")
    paper = partition_storey(hall(), middle_and_wall, functions, PartitionParams(relief=Relief.CLEARANCE))
    ours = partition_storey(hall(), middle_and_wall, functions, PartitionParams(relief=Relief.ARRIVAL))
    assert (paper.labels == 2).mean() < 0.03
    assert (ours.labels == 2).mean() > 0.08


def test_rooms_without_a_door_are_regions_of_their_own() -> None:
    cut = partition_storey(two_halls(0), cells((30, 30)), ("kitchen",))
    assert [g.function for g in cut.groups] == ["kitchen", "unknown"]
    assert cut.labels[0, 0] == 1
    assert cut.labels[0, -1] == 2


def test_the_front_arrives_sooner_where_there_is_more_room() -> None:
    free = np.ones((21, 61), bool)
    free[:9, 31:] = free[12:, 31:] = False  # a corridor three cells wide leads to the right
    markers = np.zeros(free.shape, np.int32)
    markers[10, 30] = 1
    times = arrival(clearance_of(free, 0.05), markers)
    assert times[10, 30] == 0.0
    assert times[10, 45] > 2 * times[10, 15]
    assert (arrival(clearance_of(free, 0.05), np.zeros(free.shape, np.int32)) == 0).all()


# the smallest maps


@pytest.mark.parametrize("relief", list(Relief))
def test_the_smallest_maps_are_cut_too(relief: Relief) -> None:
    params = PartitionParams(relief=relief)
    nothing = partition_storey(np.zeros((0, 0), bool), cells((0, 0)), ("kitchen",), params)
    assert nothing.groups == ()
    assert nothing.region_of_object.tolist() == [-1]
    assert partition_storey(np.zeros((4, 4), bool), cells(), (), params).groups == ()
    one = partition_storey(np.ones((1, 1), bool), cells(), (), params)
    assert [g.function for g in one.groups] == ["unknown"]
    assert one.labels.tolist() == [[1]]
    far = partition_storey(np.ones((1, 1), bool), cells((50, -50)), ("kitchen",), params)
    assert far.region_of_object.tolist() == [0]
    assert far.groups[0].function == "kitchen"


def test_without_objects_a_hall_is_one_unknown_region() -> None:
    cut = partition_storey(hall(), cells(), ())
    assert [g.function for g in cut.groups] == ["unknown"]
    assert (cut.labels == 1).all()


def test_clusters_are_the_connected_pieces_within_eps() -> None:
    points = np.array([[0.0, 0], [5, 0], [2, 0], [4, 0], [9, 9]])
    assert [piece.tolist() for piece in cluster(points, 2.0)] == [[0, 1, 2, 3], [4]]
    assert [piece.tolist() for piece in cluster(points, 1.0)] == [[0], [1, 3], [2], [4]]
    assert cluster(np.zeros((0, 2)), 1.0) == []


@settings(max_examples=60, deadline=None)
@given(MASKS, st.lists(st.tuples(st.floats(-5, 30), st.floats(-5, 30)), max_size=6), st.data())
def test_regions_lie_in_free_space_and_every_object_in_a_region(
    free: Bools, at: list, data: st.DataObject
) -> None:
    functions = tuple(data.draw(st.sampled_from(["kitchen", "office", "unknown"])) for _ in at)
    relief = data.draw(st.sampled_from(list(Relief)))
    cut = partition_storey(free, cells(*at), functions, PartitionParams(relief=relief))
    assert not cut.labels[~free].any()
    assert sorted(np.unique(cut.labels[cut.labels > 0])) == [k + 1 for k in range(len(cut.groups))]
    assert bool(cut.groups) == bool(free.any())
    if free.any() and at:
        assert (cut.region_of_object >= 0).all()
        assert regions_at(cut.labels, cells(*at)).tolist() == cut.region_of_object.tolist()
    again = partition_storey(free, cells(*at), functions, PartitionParams(relief=relief))
    assert again.labels.tolist() == cut.labels.tolist()
