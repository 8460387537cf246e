from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from services.retrieval.domain.votes import VoteParams, sight, vote, voxels_of
from tests.unit.services.retrieval.builders import detection


def seen(frame: int, x: float, y: float = 0.1, z: float = 0.1, score: float = 0.8):
    return sight(f"f{frame:03d}", detection("cup", x, y, z, score))


def test_three_distinct_frames_in_one_voxel_survive() -> None:
    (survivor,) = vote([seen(0, 0.10), seen(1, 0.12), seen(2, 0.14)])
    assert survivor.voxel == (0, 0, 0)
    assert survivor.frames == ("f000", "f001", "f002")
    # equal scores: the plain mean of .10, .12, .14
    np.testing.assert_allclose(survivor.position, [0.12, 0.1, 0.1], atol=1e-9)


def test_two_frames_do_not_however_many_detections() -> None:
    assert vote([seen(0, 0.10), seen(0, 0.11), seen(0, 0.12), seen(1, 0.12)]) == ()


def test_neighbouring_voxels_do_not_add_up() -> None:
    # 0.25 is the border: two frames on one side, two on the other, to the paper's letter no consensus
    assert vote([seen(0, 0.15), seen(1, 0.15), seen(2, 0.35), seen(3, 0.35)]) == ()


def test_an_object_across_a_border_votes_in_both_voxels() -> None:
    across = seen(0, 0.25)
    assert across.voxels == ((0, 0, 0), (1, 0, 0))
    (survivor,) = vote([across, seen(1, 0.15), seen(2, 0.15)])
    assert survivor.voxel == (0, 0, 0)


def test_stray_points_cast_no_vote() -> None:
    points = np.array([[0.1, 0.1, 0.1]] * 20 + [[2.0, 0.1, 0.1]] * 5)
    assert voxels_of(points, VoteParams(share=0.3)) == ((0, 0, 0),)
    assert voxels_of(points, VoteParams(share=0.25)) == ((0, 0, 0), (8, 0, 0))


def test_two_objects_give_two_survivors_most_frames_first() -> None:
    near = [seen(k, 0.1) for k in range(3)]
    far = [seen(k, 2.1) for k in range(5)]
    survivors = vote([*near, *far])
    assert [len(s.frames) for s in survivors] == [5, 3]
    assert survivors[0].voxel == (8, 0, 0)


def test_one_object_gives_one_survivor_though_it_lies_across_a_border() -> None:
    assert len(vote([seen(k, 0.25) for k in range(4)])) == 1


def test_ties_go_to_the_greater_score_then_to_the_lower_voxel() -> None:
    weak, strong = [seen(k, 0.1, score=0.5) for k in range(3)], [seen(k, 2.1, score=0.9) for k in range(3)]
    assert [s.voxel[0] for s in vote([*weak, *strong])] == [8, 0]
    even = [seen(k, x) for x in (2.1, 0.1) for k in range(3)]
    assert [s.voxel[0] for s in vote(even)] == [0, 8]


def test_no_sightings_no_survivors() -> None:
    assert vote([]) == ()


def test_negative_coordinates_have_voxels_of_their_own() -> None:
    assert seen(0, -0.1, -0.1, -0.1).voxels == ((-1, -1, -1),)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(st.integers(0, 5), st.floats(-1, 1), st.floats(-1, 1)), max_size=20), st.randoms())
def test_the_order_of_sightings_changes_nothing_but_order_of_equals(items, random) -> None:
    sightings = [seen(k, x, y) for k, x, y in items]
    shuffled = list(sightings)
    random.shuffle(shuffled)
    first = sorted((s.voxel, s.frames) for s in vote(sightings))
    assert first == sorted((s.voxel, s.frames) for s in vote(shuffled))
    assert all(len(frames) >= 3 for _, frames in first)
