"""Algorithm 1, line by line, on rooms that can be checked by eye."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.scene.types import F64, I32, Bools
from services.regions.domain.cells import labels_at
from services.regions.domain.flooding import clearance_of
from services.regions.domain.partition import (
    Growth,
    PartitionParams,
    SeedGroup,
    StoreyPartition,
    find_cores,
    grow,
    merged,
    partition_storey,
    place_markers,
    seed_groups,
)

PARAMS = PartitionParams()
OURS = PartitionParams(dilation=9, votes=2.0, growth=Growth.DISTANCE, min_part=4.0, merge_width=1.2)
MASKS = arrays.arrays(np.bool_, st.tuples(st.integers(0, 24), st.integers(0, 24)))


def test_the_defaults_are_the_papers_own_and_nothing_beyond_them() -> None:
    assert (PARAMS.dilation, PARAMS.marker_radius, PARAMS.eps, PARAMS.resolution) == (6, 0.30, 2.0, 0.05)
    assert (PARAMS.votes, PARAMS.growth, PARAMS.merge_width) == (0.0, Growth.CLEARANCE, float("inf"))


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


def cores_of(free: Bools, params: PartitionParams = PARAMS) -> I32:
    return find_cores(free, clearance_of(free, params.resolution), params)


def regions_of(cut: StoreyPartition, at: F64) -> list[str]:
    """The function of the region that each of `(N, 2)` cells is in."""
    return [cut.functions[k] for k in labels_at(cut.labels, at).tolist()]


def cells(*pairs: tuple[float, float]) -> F64:
    return np.array(pairs, dtype=np.float64).reshape(-1, 2)


# 2, 3: C_0


def test_a_core_begins_more_than_six_cells_from_what_is_not_free() -> None:
    cores = cores_of(hall())
    assert np.argwhere(cores).min(axis=0).tolist() == [6, 6]
    assert np.argwhere(cores).max(axis=0).tolist() == [53, 53]


def test_an_opening_of_twelve_cells_parts_two_cores_and_one_of_fourteen_does_not() -> None:
    assert cores_of(two_halls(12)).max() == 2
    assert cores_of(two_halls(14)).max() == 1


def test_nine_cells_close_a_door_of_ninety_centimetres() -> None:
    assert cores_of(two_halls(18)).max() == 1
    assert cores_of(two_halls(18), OURS).max() == 2
    assert cores_of(two_halls(20), OURS).max() == 1


def test_small_cores_are_dropped() -> None:
    free = np.zeros((60, 90), bool)
    free[:, :60] = True
    free[:20, 65:85] = True  # its core is 8 x 8 cells = 0.16 square metres
    assert cores_of(free).max() == 1
    assert cores_of(free, replace(PARAMS, min_core=0.1)).max() == 2


def test_a_floor_too_narrow_for_any_core_is_one_core_a_piece() -> None:
    corridors = np.zeros((12, 40), bool)
    corridors[1:5] = corridors[7:11] = True
    assert cores_of(corridors).max() == 2


# 7-22: seed groups and markers


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
    at = cells((30, 8), (30, 52), (30, 52))
    cut = partition_storey(hall(), at, ("kitchen", "office", "bedroom"))
    assert cut.functions == ("kitchen", "office")
    assert [group.function for group in cut.groups] == ["kitchen", "office", "bedroom"]
    assert regions_of(cut, at) == ["kitchen", "office", "office"]


# votes


def test_a_lone_odd_object_makes_no_region_where_votes_are_asked_for() -> None:
    bedroom_with_a_mug = cells((5, 5), (5, 30), (30, 5), (30, 30), (50, 50))
    functions = ("bedroom",) * 4 + ("kitchen",)
    paper = partition_storey(hall(), bedroom_with_a_mug, functions)
    assert sorted(paper.functions) == ["bedroom", "kitchen"]
    ours = partition_storey(hall(), bedroom_with_a_mug, functions, replace(PARAMS, votes=2))
    assert ours.functions == ("bedroom",)
    assert (ours.labels == 1).all()


def test_a_weak_witness_counts_less_than_a_vote() -> None:
    basins = np.ones((100, 100), np.int32)
    snapped = np.array([[10, 10], [12, 10], [14, 10], [90, 90], [92, 90], [94, 90]])
    functions = ("dining area",) * 3 + ("kitchen",) * 3  # a table and two chairs; a mug, a plate and a bowl
    votes = np.array([1.0, 0.5, 0.5, 0.4, 0.4, 0.4])
    strict = replace(PARAMS, votes=2.0, vote_share=1.0)
    (group,) = seed_groups(basins, snapped, functions, strict, votes)
    assert group.function == "dining area"
    groups = seed_groups(basins, snapped, functions, replace(strict, votes=1.2), votes)
    assert [each.function for each in groups] == ["dining area", "kitchen"]


def test_where_votes_are_few_a_share_of_them_is_enough_but_never_one_object() -> None:
    basins = np.ones((100, 100), np.int32)
    snapped = np.array([[10, 10], [12, 10], [90, 90], [92, 90], [50, 90]])
    functions = ("dining area", "dining area", "kitchen", "kitchen", "office")
    votes = np.array([1.0, 0.25, 0.4, 0.4, 1.0])  # 3.05 in all: a third of them is 1.02, a tenth 0.31
    few = replace(PARAMS, votes=2.0, vote_share=1 / 3)
    assert [g.function for g in seed_groups(basins, snapped, functions, few, votes)] == ["dining area"]
    fewer = replace(PARAMS, votes=2.0, vote_share=0.1)
    assert [g.function for g in seed_groups(basins, snapped, functions, fewer, votes)] == [
        "dining area",
        "kitchen",
    ]


def test_on_a_floor_with_hardly_any_objects_a_bed_alone_makes_a_bedroom_and_a_mug_no_kitchen() -> None:
    snapped = np.array([[10, 10], [10, 90], [90, 90], [90, 10]])
    functions = ("living room", "bedroom", "kitchen", "kitchen")
    votes = np.array([1.0, 1.0, 0.4, 0.4])  # 2.8 in all
    params = replace(PARAMS, votes=2.0)
    large, small = np.ones((140, 140), np.int32), np.ones((100, 100), np.int32)  # 49 and 25 square metres
    groups = seed_groups(large, snapped, functions, params, votes)
    assert sorted(group.function for group in groups) == ["bedroom", "living room"]
    (group,) = seed_groups(small, snapped, functions, params, votes)
    assert group.function == "bedroom"  # the first of those with the most votes


def test_where_no_group_has_votes_enough_the_most_common_function_has_the_core() -> None:
    basins = np.ones((100, 100), np.int32)
    snapped = np.array([[10, 10], [10, 20], [90, 90]])
    functions = ("office", "kitchen", "kitchen")  # the two kitchen things are far apart, so each group is one
    (group,) = seed_groups(basins, snapped, functions, replace(PARAMS, votes=3))
    assert (group.function, group.members) == ("kitchen", (0, 1, 2))


def test_a_tie_of_votes_goes_to_the_function_first_in_the_alphabet() -> None:
    basins = np.ones((100, 100), np.int32)
    snapped = np.array([[10, 10], [90, 90]])
    (group,) = seed_groups(basins, snapped, ("office", "kitchen"), replace(PARAMS, votes=2))
    assert group.function == "kitchen"


# 26: R


@pytest.mark.parametrize("growth", list(Growth))
def test_two_functions_in_one_hall_share_it_half_and_half(growth: Growth) -> None:
    params = PartitionParams(growth=growth)
    cut = partition_storey(hall(), cells((30, 12), (30, 47)), ("kitchen", "office"), params)
    assert (cut.labels > 0).all()
    assert np.bincount(cut.labels.ravel())[1:] == pytest.approx([1800, 1800], rel=0.1)


@pytest.mark.parametrize("growth", list(Growth))
def test_the_border_between_two_functions_of_one_core_is_near_the_doorway_half_way(growth: Growth) -> None:
    params = PartitionParams(growth=growth)
    cut = partition_storey(two_halls(16), cells((30, 25), (30, 97)), ("kitchen", "office"), params)
    assert cut.basins.max() == 1
    assert (cut.labels[:, :58] == 1).all()
    assert (cut.labels[:, 64:] == 2).all()


def test_on_clearance_the_deepest_marker_takes_the_hall_and_by_distance_they_share_it() -> None:
    middle_and_wall = cells((30, 30), (30, 1))
    functions = ("living room", "kitchen")
    paper = partition_storey(hall(), middle_and_wall, functions, PARAMS)
    ours = partition_storey(hall(), middle_and_wall, functions, replace(PARAMS, growth=Growth.DISTANCE))
    assert (paper.labels == 2).mean() < 0.03
    assert (ours.labels == 2).mean() == pytest.approx(
        0.25, abs=0.03
    )  # 15 of 60 columns are nearer to the wall's


def test_a_part_too_small_for_an_area_goes_to_the_others() -> None:
    corner_kitchen = cells(
        (30, 3), (30, 40), (10, 50), (50, 50)
    )  # its part would be a third of nine square metres
    functions = ("kitchen", "office", "office", "office")
    for least, named in ((2.0, ("kitchen", "office")), (4.0, ("office",))):
        params = replace(OURS, votes=0, min_part=least, eps=5.0)
        cut = partition_storey(hall(), corner_kitchen, functions, params)
        assert cut.functions == named
        assert (cut.labels > 0).all()


def test_by_distance_a_room_whose_marker_is_beside_its_door_keeps_itself_and_nothing_else() -> None:
    at = cells((30, 58), (3, 100), (57, 118))
    params = replace(OURS, votes=0)
    cut = partition_storey(two_halls(18), at, ("kitchen", "bedroom", "bedroom"), params)
    kitchen = cut.labels == 1 + cut.functions.index("kitchen")
    assert kitchen[:, :60].all()
    assert not kitchen[:, 62:].any()


def test_a_basin_without_a_marker_goes_to_its_neighbour() -> None:
    free = two_halls(10)
    free[:, 62 + 18 :] = False  # the right room: 60 x 18 cells, 2.7 square metres
    cut = partition_storey(free, cells((30, 30)), ("kitchen",), replace(OURS, min_unknown=5.0, dilation=6))
    assert cut.basins.max() == 2
    assert cut.functions == ("kitchen",)
    assert (cut.labels[free] == 1).all()


def test_grow_by_distance_keeps_the_basin_of_a_lone_group() -> None:
    basins = np.ones((20, 40), np.int32)
    basins[:, 20:] = 2
    markers = np.zeros_like(basins)
    markers[10, 5], markers[10, 22] = 1, 2
    groups = (SeedGroup("kitchen", 1, (0,)), SeedGroup("office", 2, (1,)))
    labels = grow(clearance_of(basins > 0, 0.05), basins, markers, groups, OURS)
    assert (labels == basins).all()


def test_rooms_without_a_door_are_regions_of_their_own() -> None:
    cut = partition_storey(two_halls(0), cells((30, 30)), ("kitchen",))
    assert cut.functions == ("kitchen", "unknown")
    assert cut.labels[0, 0] == 1
    assert cut.labels[0, -1] == 2


# merging


def test_regions_of_one_function_are_one_over_a_wide_border_and_two_over_a_door() -> None:
    at = cells((30, 25), (30, 97))
    for opening, regions in ((18, 2), (30, 1)):
        params = replace(OURS, dilation=16)  # so that the wide opening parts the cores too
        assert len(partition_storey(two_halls(opening), at, ("bedroom",) * 2, params).functions) == regions
    params = replace(OURS, dilation=16)
    assert len(partition_storey(two_halls(30), at, ("bedroom", "office"), params).functions) == 2


def test_merging_is_transitive_and_numbers_the_union_as_its_first_part() -> None:
    labels = np.repeat(np.array([[1, 2, 3, 4]], np.int32), 40, axis=0).repeat(10, axis=1)
    joined, functions = merged(labels, ["kitchen", "office", "office", "office"], OURS)
    assert functions == ("kitchen", "office")
    assert np.unique(joined[:, 10:]).tolist() == [2]
    apart, functions = merged(labels, ["kitchen", "office", "kitchen", "office"], OURS)
    assert (apart == labels).all()
    assert len(functions) == 4


# the smallest maps


@pytest.mark.parametrize("params", [PARAMS, OURS])
def test_the_smallest_maps_are_cut_too(params: PartitionParams) -> None:
    nothing = partition_storey(np.zeros((0, 0), bool), cells((0, 0)), ("kitchen",), params)
    assert nothing.functions == nothing.groups == ()
    assert partition_storey(np.zeros((4, 4), bool), cells(), (), params).functions == ()
    one = partition_storey(np.ones((1, 1), bool), cells(), (), params)
    assert one.functions == ("unknown",)
    assert one.labels.tolist() == [[1]]
    far = partition_storey(np.ones((1, 1), bool), cells((50, -50)), ("kitchen",), params)
    assert far.functions == ("kitchen",)


def test_without_objects_a_hall_is_one_unknown_region() -> None:
    cut = partition_storey(hall(), cells(), ())
    assert cut.functions == ("unknown",)
    assert (cut.labels == 1).all()


@settings(max_examples=60, deadline=None)
@given(MASKS, st.lists(st.tuples(st.floats(-5, 30), st.floats(-5, 30)), max_size=6), st.data())
def test_regions_lie_in_free_space_and_every_object_in_a_region(
    free: Bools, at: list[tuple[float, float]], data: st.DataObject
) -> None:
    functions = [data.draw(st.sampled_from(["kitchen", "office", "unknown"])) for _ in at]
    params = data.draw(st.sampled_from([PARAMS, OURS, replace(OURS, dilation=2, votes=0)]))
    cut = partition_storey(free, cells(*at), functions, params)
    assert not cut.labels[~free].any()
    assert sorted(np.unique(cut.labels[cut.labels > 0])) == [k + 1 for k in range(len(cut.functions))]
    assert bool(cut.functions) == bool(free.any())
    if free.any() and at:
        assert (labels_at(cut.labels, cells(*at)) >= 0).all()
    again = partition_storey(free, cells(*at), functions, params)
    assert again.labels.tolist() == cut.labels.tolist()


@settings(max_examples=40, deadline=None)
@given(MASKS, st.integers(1, 5), st.integers(1, 5))
def test_moving_the_grid_moves_the_regions(free: Bools, down: int, across: int) -> None:
    at = cells((3, 3), (12, 17), (20, 5))
    functions = ("kitchen", "office", "kitchen")
    params = replace(OURS, dilation=2, votes=0)
    moved = np.pad(free, ((down, 0), (across, 0)))
    there = partition_storey(moved, at + np.array([down, across]), functions, params)
    here = partition_storey(free, at, functions, params)
    assert there.labels[down:, across:].tolist() == here.labels.tolist()
    assert there.functions == here.functions
