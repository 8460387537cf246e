"""What KGSW is compared with, on rooms that can be checked by eye."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.scene.types import F64, I32
from services.regions.domain.baselines.auto_k import AutoKParams, auto_k_rooms, choose_k, silhouette
from services.regions.domain.baselines.heights import ceiling_of, filled_voxels
from services.regions.domain.baselines.hovsg import hovsg_floors, hovsg_rooms
from services.regions.domain.baselines.sysnav import SysNavParams, sysnav_rooms
from services.regions.domain.evidence import Counts, FloorEvidence
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace
from services.regions.domain.partition import Growth, PartitionParams
from services.regions.domain.survey import SurveyedStorey, survey
from tests.unit.services.regions.rooms import plane, room, seen, two_rooms

EMPTY = np.zeros((0, 0), bool)
NOWHERE = FreeSpace((0.0, 0.0), 0.05, EMPTY, EMPTY, EMPTY.astype(np.uint8))
STOREY = Storey(0.0, 2.5, -np.inf, np.inf)


def open_room() -> FloorEvidence:
    return seen((room((0.0, 6.0), (0.0, 5.0)), (3.0, 2.5, 1.2)))


def only(evidence: FloorEvidence) -> SurveyedStorey:
    (storey,) = survey(evidence)
    return storey


def at(labels: I32, here: SurveyedStorey, x: float, y: float) -> int:
    row, column = (
        int((value - low) / 0.05) for value, low in zip((y, x), here.space.origin[::-1], strict=True)
    )
    return int(labels[row, column])


def square_metres(labels: I32) -> list[float]:
    return [float(cells) * 0.05**2 for cells in np.bincount(labels.ravel())[1:]]


# the cloud


def test_a_voxel_counts_once_however_often_it_was_hit() -> None:
    post = np.array([[1.01, 1.01, z] for z in (1.01, 1.02, 1.06)], np.float32)
    floor = plane((0.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    evidence = seen(*[(np.concatenate([floor, post]), (0.5, 0.5, 1.2))] * 3)
    here = only(evidence)
    counts = filled_voxels(evidence, here.space, 0.5, 2.0)
    assert counts.sum() == 2
    assert at(counts.astype(np.int32), here, 1.01, 1.01) == 2


def test_an_unseen_ceiling_is_as_high_as_the_highest_surface() -> None:
    evidence = seen((np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 2.31]], np.float32), (0.0, 0.0, 1.2)))
    assert ceiling_of(evidence, Storey(0.0, None, -np.inf, np.inf)) == pytest.approx(2.35)
    assert ceiling_of(evidence, STOREY) == 2.5
    assert ceiling_of(FloorEvidence(), Storey(0.3, None, -np.inf, np.inf)) == 0.3


# HOV-SG


def test_hovsg_cuts_two_rooms_at_their_door() -> None:
    evidence = two_rooms()
    here = only(evidence)
    rooms = hovsg_rooms(evidence, here.storey, here.space)
    left, right = at(rooms, here, 2.0, 2.0), at(rooms, here, 6.2, 2.0)
    assert {left, right} == {1, 2}
    assert square_metres(rooms) == pytest.approx([16.0, 16.0], abs=1.5)
    assert at(rooms, here, 3.7, 2.0) == left
    assert at(rooms, here, 4.5, 2.0) == right


def test_hovsg_leaves_one_open_room_whole() -> None:
    evidence = open_room()
    here = only(evidence)
    assert square_metres(hovsg_rooms(evidence, here.storey, here.space)) == pytest.approx([30.0], abs=2.0)


def test_hovsg_finds_nothing_where_nothing_was_seen() -> None:
    assert hovsg_rooms(FloorEvidence(), STOREY, NOWHERE).shape == (0, 0)
    assert hovsg_floors(FloorEvidence()) == ()


def levels(*heights: tuple[float, int]) -> FloorEvidence:
    """Points seen at some heights, on top of a few at every height from the lowest to the highest."""
    low, high = (round(f(z for z, _ in heights) / 0.01) for f in (min, max))
    bins = np.arange(low - 20, high + 21)
    counts = np.ones(len(bins), np.int64)
    for z, points in heights:
        counts[round(z / 0.01) - bins[0]] += points
    return FloorEvidence(heights_below=Counts(bins, counts))


def test_hovsg_pairs_floor_and_ceiling() -> None:
    (floor,) = hovsg_floors(levels((0.0, 9000), (2.5, 8000)))
    assert floor == pytest.approx((0.0, 2.5))


def test_hovsg_takes_two_levels_from_the_cluster_between_two_storeys() -> None:
    lower, upper = hovsg_floors(levels((0.0, 9000), (2.5, 8000), (2.8, 9000), (5.3, 8000)))
    assert lower == pytest.approx((0.0, 2.5))
    assert upper == pytest.approx((2.8, 5.3))


def test_hovsg_takes_the_higher_peak_of_the_lowest_cluster() -> None:
    (floor,) = hovsg_floors(levels((0.0, 9000), (0.4, 3000), (2.5, 8000)))
    assert floor == pytest.approx((0.0, 2.5))


def test_hovsg_has_no_floor_where_only_one_level_stands_out() -> None:
    assert hovsg_floors(levels((1.0, 9000))) == ()


# SysNav


def test_sysnav_cuts_two_rooms_at_their_door_and_grows_them_back() -> None:
    evidence = two_rooms()
    here = only(evidence)
    rooms = sysnav_rooms(evidence, here.storey, here.space)
    assert {at(rooms, here, 2.0, 2.0), at(rooms, here, 6.2, 2.0)} == {1, 2}
    assert square_metres(rooms) == pytest.approx([15.5, 15.5], abs=0.8)
    assert not (rooms[~here.space.free]).any()


def test_sysnav_leaves_one_open_room_whole() -> None:
    evidence = open_room()
    here = only(evidence)
    assert square_metres(sysnav_rooms(evidence, here.storey, here.space)) == pytest.approx([29.0], abs=1.5)


def test_sysnav_joins_rooms_where_walls_are_not_drawn_on_over_a_wide_opening() -> None:
    evidence = two_rooms()
    here = only(evidence)
    narrow = SysNavParams(lengthened=0.0, dilation=1)
    assert len(square_metres(sysnav_rooms(evidence, here.storey, here.space, narrow))) == 1


def test_sysnav_takes_a_post_for_no_wall() -> None:
    post = plane((3.0, 3.2), (2.4, 2.4), (0.0, 2.5))
    evidence = seen((np.concatenate([room((0.0, 6.0), (0.0, 5.0)), post]), (3.0, 4.0, 1.2)))
    here = only(evidence)
    assert len(square_metres(sysnav_rooms(evidence, here.storey, here.space))) == 1


def test_sysnav_finds_nothing_where_nothing_was_seen_or_all_is_narrow() -> None:
    assert sysnav_rooms(FloorEvidence(), STOREY, NOWHERE).shape == (0, 0)
    corridor = seen((room((0.0, 0.6), (0.0, 5.0)), (0.3, 2.5, 1.2)))
    here = only(corridor)
    assert not sysnav_rooms(corridor, here.storey, here.space).any()


# auto-K


def heaps(*centres: tuple[float, float], size: int = 8) -> F64:
    """Points in a ring of 0.3 m about each centre."""
    angle = np.linspace(0, 2 * np.pi, size, endpoint=False)
    ring = 0.3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.concatenate([np.asarray(centre) + ring for centre in centres])


@pytest.mark.parametrize("k", [2, 3, 5])
def test_as_many_clusters_as_heaps(k: int) -> None:
    places = [(0.0, 0.0), (5.0, 0.0), (0.0, 6.0), (7.0, 7.0), (12.0, 3.0)][:k]
    clustering = choose_k(heaps(*places), 0)
    assert len(set(clustering.cluster.tolist())) == k
    assert all(len(set(part)) == 1 for part in np.split(clustering.cluster, k))
    assert max(clustering.silhouettes, key=lambda tried: clustering.silhouettes[tried]) == k


def test_silhouette_by_hand() -> None:
    points = np.array([[0.0], [1.0], [10.0], [12.0]])
    distance = np.abs(points - points.T)
    #    0: a 1, b 11; 1: a 1, b 10; 10: a 2, b 9.5; 12: a 2, b 11.5
    by_hand = (10 / 11 + 9 / 10 + 7.5 / 9.5 + 9.5 / 11.5) / 4
    assert silhouette(distance, np.array([0, 0, 1, 1])) == pytest.approx(by_hand)
    assert silhouette(distance[:3, :3], np.array([0, 0, 1])) == pytest.approx((9 / 10 + 8 / 9 + 0) / 3)


@settings(max_examples=25, deadline=None)
@given(arrays.arrays(np.float64, st.tuples(st.integers(0, 14), st.just(2)), elements=st.integers(0, 9)))
def test_every_point_is_in_a_cluster_and_the_same_seed_gives_the_same(points: F64) -> None:
    once, again = choose_k(points, 3), choose_k(points, 3)
    assert once.cluster.tolist() == again.cluster.tolist()
    assert once.silhouettes == again.silhouettes
    assert len(once.cluster) == len(points)
    distinct = len(np.unique(points, axis=0)) if len(points) else 0
    assert set(once.silhouettes) <= set(range(2, min(12, max(distinct - 1, 0)) + 1))
    assert all(-1 <= score <= 1 for score in once.silhouettes.values())


def test_too_few_points_are_one_cluster() -> None:
    assert choose_k(np.zeros((0, 2)), 0).cluster.tolist() == []
    assert choose_k(np.array([[0.0, 0.0], [4.0, 0.0]]), 0).cluster.tolist() == [0, 0]
    assert choose_k(np.tile([[1.0, 2.0]], (9, 1)), 0).cluster.tolist() == [0] * 9


@pytest.mark.parametrize("growth", list(Growth))
def test_two_heaps_of_objects_share_an_open_room_between_them(growth: Growth) -> None:
    free = np.ones((100, 200), bool)
    cells = heaps((2.5, 2.5), (2.5, 7.5)) / 0.05
    labels, clustering = auto_k_rooms(free, cells, 0, PartitionParams(growth=growth))
    assert labels[50, 50] != labels[50, 150]
    assert (labels > 0).all()
    assert square_metres(labels) == pytest.approx([25.0, 25.0], abs=6.0)
    assert max(clustering.silhouettes, key=lambda k: clustering.silhouettes[k]) == 2


def test_without_objects_or_floor_there_are_no_regions() -> None:
    labels, _ = auto_k_rooms(np.ones((5, 5), bool), np.zeros((0, 2)), 0)
    assert not labels.any()
    labels, _ = auto_k_rooms(np.zeros((5, 5), bool), np.ones((3, 2)), 0, k=AutoKParams(most=3))
    assert not labels.any()
