"""What views say of places, when an object is given up, and which one turned up again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ovip.scene.camera import backproject
from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, I64, NEAREST_BLOCK, Intrinsics
from services.mapper.domain.presence import (
    MOST_SAMPLES,
    THERE,
    THROUGH,
    UNKNOWN,
    Evidence,
    Looks,
    PresenceParams,
    View,
    frustum_box,
    matching_departed,
    sight,
)

CAMERA = Intrinsics(100.0, 100.0, 31.5, 23.5, 64, 48)  # 16 x 12 blocks; at 1 m a block is 4 cm wide
AHEAD = np.eye(4)  # at the origin, looking along +z, x right, y down
STILL = PresenceParams(drift=0.0)
DRIFTING = PresenceParams()


def view(nearest: float | F32, pose: F64 = AHEAD) -> View:
    return View(np.broadcast_to(np.float32(nearest), (12, 16)).astype(np.float32), CAMERA, pose)


def at(*places: tuple[float, float, float]) -> F32:
    return np.array(places, np.float32).reshape(-1, 3)


def said_of(points: F32, seen: View, params: PresenceParams = STILL) -> list[int]:
    """Of one object's places."""
    said: list[int] = sight(points, np.zeros(len(points), np.int64), seen, params).tolist()
    return said


def blocks_of(depth: F32) -> F32:
    """The nearest measurement in each block of an image whose sides are whole blocks."""
    high, wide = (side // NEAREST_BLOCK for side in depth.shape)
    blocks = depth.reshape(high, NEAREST_BLOCK, wide, NEAREST_BLOCK)
    nearest = np.where(blocks > 0, blocks, np.inf).min(axis=(1, 3))
    return np.asarray(np.where(np.isfinite(nearest), nearest, 0), np.float32)


def cube(middle: tuple[float, float, float], side: float) -> F32:
    """Places 2 cm apart on and in a cube."""
    steps = np.arange(0, side + 1e-6, 0.02) - side / 2
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(grid + np.array(middle), np.float32)


class TestOnePlace:
    """One metre ahead, in the middle of the image."""

    place = at((0, 0, 1))

    @pytest.mark.parametrize(
        ("nearest", "said"),
        [(2.0, THROUGH), (1.0, THERE), (0.5, UNKNOWN), (0.0, UNKNOWN)],
        ids=["a wall behind it", "its surface", "something before it", "no depth"],
    )
    def test_is_seen_through_there_hidden_or_not_measured(self, nearest: float, said: int) -> None:
        assert said_of(self.place, view(nearest)) == [said]

    def test_needs_depth_beyond_a_margin_that_grows_with_the_square_of_its_own(self) -> None:
        """At 1 m 0.015 + 0.003 * 1 = 0.018; at 3 m 0.015 + 0.003 * 9 = 0.042."""
        assert said_of(self.place, view(1.017)) == [THERE]
        assert said_of(self.place, view(1.019)) == [THROUGH]
        assert said_of(at((0, 0, 3)), view(3.041)) == [THERE]
        assert said_of(at((0, 0, 3)), view(3.043)) == [THROUGH]

    def test_is_not_seen_through_where_depth_is_missing_in_its_block(self) -> None:
        """The ray of (0, 0, 1) goes through pixel (31.5, 23.5), the first of block row 6, column 8."""
        for block, said in (((6, 8), UNKNOWN), ((6, 7), THROUGH), ((5, 8), THROUGH)):
            nearest = np.full((12, 16), 2.0, np.float32)
            nearest[block] = 0.0
            assert said_of(self.place, view(nearest)) == [said]

    def test_is_not_seen_through_where_a_block_beside_its_ray_shows_something_nearer(self) -> None:
        """With a drift of 3 cm, 0.75 cm beside the ray count, 0.75 pixels: block columns 7 and 8, and not 9."""
        for column, said in ((7, UNKNOWN), (8, UNKNOWN), (9, THROUGH)):
            nearest = np.full((12, 16), 2.0, np.float32)
            nearest[:, column] = 0.8
            assert said_of(self.place, view(nearest), DRIFTING) == [said]

    @pytest.mark.parametrize("place", [(0, 0, -1), (2, 0, 1), (0, 0, 0.3), (0, 0, 5.1), (-0.318, 0, 1)])
    def test_says_nothing_behind_the_camera_outside_too_near_too_far_or_at_the_rim(
        self, place: tuple[float, float, float]
    ) -> None:
        assert said_of(at(place), view(9.0), DRIFTING) == [UNKNOWN]

    def test_is_judged_where_the_camera_stands(self) -> None:
        """The camera 1 m back: the wall 2 m ahead of it is where the place is."""
        pose = np.eye(4)
        pose[2, 3] = -1.0

        assert said_of(self.place, view(2.0, pose)) == [THERE]
        assert said_of(self.place, view(2.5, pose)) == [THROUGH]


class TestDrift:
    """A cube of 12 cm whose middle is 1 m ahead, its front at 0.94 m."""

    cup = cube((0, 0, 1), 0.12)

    def test_a_surface_off_by_less_than_the_drift_is_the_object_s(self) -> None:
        """Its front 2.5 cm farther than mapped: seen through as it stands, not once moved back."""
        front = self.cup[self.cup[:, 2] < 0.95]

        assert set(said_of(front, view(0.965), STILL)) == {THROUGH}
        assert set(said_of(front, view(0.965), DRIFTING)) == {THERE}

    def test_what_no_drift_explains_is_seen_through(self) -> None:
        assert set(said_of(self.cup, view(1.5), DRIFTING)) == {THROUGH}

    def test_a_thin_thing_stays_though_the_pose_is_off_sideways(self) -> None:
        """A leg 2 cm wide, 3 cm beside pixel 30 where it was mapped: in the next block, before a wall."""
        leg = cube((-0.015, 0, 1), 0.0) + np.array(
            [[0, y, 0] for y in np.arange(-0.1, 0.1, 0.02)], np.float32
        )
        depth = np.full((48, 64), 2.5, np.float32)
        depth[:, 32:34] = 1.0

        assert THROUGH in said_of(leg, view(blocks_of(depth)), STILL)
        assert THROUGH not in said_of(leg, view(blocks_of(depth)), DRIFTING)

    def test_a_thing_thinner_than_the_drift_is_never_seen_through_before_what_carried_it(self) -> None:
        sheet = self.cup[self.cup[:, 2] < 0.95]

        assert THROUGH not in said_of(sheet, view(0.94 + 0.03), DRIFTING)


images = arrays(
    np.float32, (12, 16), elements=st.sampled_from([0.0, 0.6, 1.0, 1.03, 1.5, 2.0, 4.0]).map(np.float32)
)
clouds = arrays(np.float32, st.tuples(st.integers(0, 30), st.just(3)), elements=st.floats(-1, 5, width=32))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_what_a_frame_itself_measured_is_never_seen_through(seed: int) -> None:
    depth = np.random.default_rng(seed).choice([0.0, 0.6, 1.0, 1.03, 1.5, 4.0], (48, 64)).astype(np.float32)
    points, _ = backproject(depth, CAMERA, AHEAD)

    assert THROUGH not in said_of(points, view(blocks_of(depth)), DRIFTING)


@settings(max_examples=200, deadline=None)
@given(images, clouds)
def test_a_place_behind_something_nearer_is_never_seen_through(nearest: F32, points: F32) -> None:
    said = np.array(said_of(points, view(nearest), DRIFTING), np.int8)
    through = points[said == THROUGH].astype(np.float64)
    columns = np.floor((100 * through[:, 0] / through[:, 2] + 32) / 4).astype(int)
    rows = np.floor((100 * through[:, 1] / through[:, 2] + 24) / 4).astype(int)

    assert (nearest[rows, columns] > through[:, 2]).all()


@settings(max_examples=60, deadline=None)
@given(images, st.lists(clouds, min_size=1, max_size=4))
def test_what_is_said_of_an_object_does_not_depend_on_the_others(nearest: F32, objects: list[F32]) -> None:
    owners = np.repeat(np.arange(len(objects)), [len(points) for points in objects])

    together = sight(np.concatenate(objects), owners, view(nearest), DRIFTING)

    assert together.tolist() == [
        said for points in objects for said in said_of(points, view(nearest), DRIFTING)
    ]


def test_nothing_is_said_of_no_places_or_by_a_view_without_depth() -> None:
    none = View(np.zeros((0, 0), np.float32), CAMERA, AHEAD)

    assert said_of(at(), view(1.0)) == []
    assert said_of(at((0, 0, 1)), none) == [UNKNOWN]
    assert frustum_box(none, STILL) is None
    assert frustum_box(view(0.0), STILL) is None


def test_the_frustum_s_box_by_hand() -> None:
    """32 pixels left and right of the axis at a focal length of 100 are 0.32 z, 24 above and below 0.24 z."""
    low_high = frustum_box(view(9.0), STILL)

    assert low_high == pytest.approx([-1.6, -1.2, 0, 1.6, 1.2, 5.0])


def test_the_frustum_ends_behind_the_farthest_measurement() -> None:
    """2 m and the margin at its widest, 0.015 + 0.003 * 25 = 0.09."""
    low_high = frustum_box(view(2.0), STILL)

    assert low_high is not None and low_high[5] == pytest.approx(2.09)


@settings(max_examples=60, deadline=None)
@given(images, clouds)
def test_all_that_a_view_says_something_of_lies_in_the_frustum_s_box(nearest: F32, points: F32) -> None:
    said = np.array(said_of(points, view(nearest), STILL))
    box = frustum_box(view(nearest), STILL)

    assert box is not None or not said.any()
    if box is not None:
        known = points[said != UNKNOWN]
        assert ((known >= box[:3] - 1e-5) & (known <= box[3:] + 1e-5)).all()


class TestEvidence:
    cup = cube((0, 0, 1), 0.1)  # small: more than a quarter of it must be seen through

    def said(self, share: float, otherwise: int = UNKNOWN) -> np.ndarray[tuple[int], np.dtype[np.int8]]:
        """The first `share` of the samples seen through."""
        count = len(Evidence.of(self.cup).points)
        return np.where(np.arange(count) < share * count, THROUGH, otherwise).astype(np.int8)

    def test_an_object_departs_with_the_third_view_through_enough_of_it_and_not_before(self) -> None:
        evidence, departed = Evidence.of(self.cup), []
        for _ in range(3):
            evidence = evidence.seen(self.said(0.3))
            departed.append(evidence.departed(DRIFTING))

        assert departed == [False, False, True]

    def test_a_view_through_too_little_of_it_never_suffices(self) -> None:
        evidence = Evidence.of(self.cup)
        for _ in range(200):
            evidence = evidence.seen(self.said(0.24))

        assert not evidence.departed(DRIFTING)
        assert evidence.counts.max() == 127

    def test_a_large_object_needs_more(self) -> None:
        sofa = Evidence.of(cube((0, 0, 3), 1.0))
        third = np.where(np.arange(len(sofa.points)) % 3 == 0, THROUGH, UNKNOWN).astype(np.int8)
        half = np.where(np.arange(len(sofa.points)) % 2 == 0, THROUGH, UNKNOWN).astype(np.int8)

        assert not sofa.seen(third).seen(third).seen(third).departed(DRIFTING)
        assert sofa.seen(half).seen(half).seen(half).departed(DRIFTING)

    def test_a_view_of_a_surface_there_starts_the_count_anew(self) -> None:
        evidence = Evidence.of(self.cup)
        for share in (1.0, 1.0, 0.0, 1.0, 1.0):
            evidence = evidence.seen(self.said(share, otherwise=THERE))

        assert not evidence.departed(DRIFTING)
        assert evidence.seen(self.said(1.0)).departed(DRIFTING)

    def test_a_view_that_says_nothing_changes_nothing(self) -> None:
        evidence = Evidence.of(self.cup).seen(self.said(1.0))

        assert evidence.seen(self.said(0.0)) is evidence

    def test_an_object_found_in_a_view_is_cleared_of_all(self) -> None:
        evidence = Evidence.of(self.cup).seen(self.said(1.0))

        assert not evidence.cleared().counts.any()
        assert np.array_equal(evidence.cleared().points, evidence.points)

    def test_an_infinite_share_never_gives_anything_up(self) -> None:
        never = replace(DRIFTING, departed_share=float("inf"), small_share=float("inf"))
        evidence = Evidence.of(self.cup)
        for _ in range(5):
            evidence = evidence.seen(self.said(1.0))

        assert not evidence.departed(never)

    def test_samples_are_the_cloud_s_own_few_and_spread_over_all_of_it(self) -> None:
        table = cube((0, 0, 0), 0.6)
        samples = Evidence.of(table).points
        gaps = np.linalg.norm(table[::97, None] - samples[None], axis=2).min(axis=1)

        assert MOST_SAMPLES / 4 < len(samples) <= MOST_SAMPLES
        assert {tuple(p) for p in samples.tolist()} <= {tuple(p) for p in table.tolist()}
        assert gaps.max() < 0.2

    def test_a_cloud_of_nothing_has_no_evidence_and_stays(self) -> None:
        none = Evidence.of(np.zeros((0, 3), np.float32))

        assert len(none.points) == len(none.counts) == 0
        assert not none.seen(np.zeros(0, np.int8)).departed(DRIFTING)
        assert len(none.renewed(self.cup).points) > 0

    def test_renewed_evidence_keeps_what_was_known_of_the_same_places(self) -> None:
        known = Evidence.of(self.cup).seen(self.said(1.0))
        grown = np.concatenate([self.cup, self.cup + np.array([0.5, 0, 0], np.float32)])

        renewed = known.renewed(grown)

        old = renewed.points[:, 0] < 0.25
        assert set(renewed.counts[old].tolist()) == {1}
        assert set(renewed.counts[~old].tolist()) == {0}

    @given(st.lists(st.sampled_from([THROUGH, UNKNOWN, THERE]), max_size=12))
    def test_nothing_departs_within_fewer_views_than_the_bound_and_all_do_with_as_many(
        self, views: list[int]
    ) -> None:
        """Of views that say the same of every place, the last three that said anything must have seen through."""
        evidence = Evidence.of(self.cup)
        for said in views:
            evidence = evidence.seen(np.full(len(evidence.points), said, np.int8))
        telling = [said for said in views if said != UNKNOWN]

        assert evidence.departed(DRIFTING) == (len(telling) >= 3 and telling[-3:] == [THROUGH] * 3)


NS = 1_000_000_000


def looks(*rows: tuple[F32, str, int, int]) -> Looks:
    """Feature, label, first and last seen in seconds."""
    return Looks(
        np.array([row[0] for row in rows], np.float32).reshape(len(rows), 4),
        [row[1] for row in rows],
        seconds(rows, 2),
        seconds(rows, 3),
    )


def seconds(rows: tuple[tuple[F32, str, int, int], ...], column: int) -> I64:
    return np.array([row[column] for row in rows], np.int64) * NS


def feature(*values: float) -> F32:
    return normalize(np.array(values, np.float32))


class TestMoves:
    red, blue, odd = feature(1, 0, 0, 0), feature(0.8, 0.6, 0, 0), feature(0, 0, 1, 0)
    nobody = looks()

    def test_a_mug_that_looks_like_the_one_that_went_is_that_one(self) -> None:
        new = looks((self.red, "mug", 20, 30))
        gone = looks((self.odd, "mug", 0, 9), (feature(1, 0.1, 0, 0), "mug", 0, 10))

        assert matching_departed(new, gone, self.nobody, DRIFTING) == 1

    def test_what_looks_too_different_is_another(self) -> None:
        """cos = 0.8 < 0.88."""
        new = looks((self.red, "mug", 20, 30))

        assert matching_departed(new, looks((self.blue, "mug", 0, 10)), self.nobody, DRIFTING) is None

    def test_another_label_is_another_thing(self) -> None:
        new = looks((self.red, "vase", 20, 30))

        assert matching_departed(new, looks((self.red, "mug", 0, 10)), self.nobody, DRIFTING) is None

    def test_what_was_there_while_the_other_still_was_is_another(self) -> None:
        new = looks((self.red, "mug", 10, 30))

        assert matching_departed(new, looks((self.red, "mug", 0, 10)), self.nobody, DRIFTING) is None
        assert matching_departed(new, looks((self.red, "mug", 0, 9)), self.nobody, DRIFTING) == 0

    def test_of_three_equal_chairs_nobody_can_say_which_moved(self) -> None:
        new = looks((self.red, "chair", 20, 30))
        one, two = (self.red, "chair", 0, 10), (feature(1, 0.1, 0, 0), "chair", 0, 10)

        assert matching_departed(new, looks(one, two), self.nobody, DRIFTING) is None
        assert matching_departed(new, looks(one), looks(two, two), DRIFTING) is None

    def test_other_kinds_in_place_do_not_make_it_ambiguous(self) -> None:
        new, gone = looks((self.red, "chair", 20, 30)), looks((self.red, "chair", 0, 10))

        assert matching_departed(new, gone, looks((self.red, "stool", 0, 30)), DRIFTING) == 0

    def test_nothing_departed_nothing_found(self) -> None:
        assert matching_departed(looks((self.red, "mug", 20, 30)), self.nobody, self.nobody, DRIFTING) is None
