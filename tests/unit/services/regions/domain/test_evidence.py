"""Floor evidence: what one frame adds, and that sums do not depend on how they were made."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from ovip.errors import Corrupt, InvalidInput
from services.regions.domain.bricks import Bricks
from services.regions.domain.evidence import Counts, EvidenceParams, FloorEvidence, pack_voxel, unpack_voxel

CLOUDS = arrays.arrays(
    np.float32, st.tuples(st.integers(0, 6), st.just(3)), elements=st.floats(-3, 3, width=32)
)


SHORT = b"OVIPFE02" + zlib.compress(zlib.decompress(FloorEvidence().to_bytes()[8:])[:-9])


def boxes(counts: Bricks | Counts) -> dict[tuple[int, ...], int]:
    keys, values = counts.items()
    return {
        tuple(index): int(value) for index, value in zip(unpack_voxel(keys).tolist(), values, strict=True)
    }


def test_a_point_is_a_hit_in_its_voxel_and_its_ray_passes_what_lies_before_it() -> None:
    evidence = FloorEvidence()
    evidence.add("f", np.array([[0.52, 0.02, 1.02]], np.float32), np.array([0.02, 0.02, 1.02]))
    assert boxes(evidence.hits) == {(10, 0, 20): 1}
    assert boxes(evidence.stood) == {(0, 0, 20): 1}
    # samples every 0.05 m from x = 0.02 while short of 0.42: cells 0 to 7 or 8, in the slab 1.0 .. 1.25
    passed = boxes(evidence.passes)
    assert set(passed) - {(8, 0, 4)} == {(x, 0, 4) for x in range(8)}


def test_a_box_that_was_hit_was_not_passed_in_the_same_frame() -> None:
    near_and_far = np.array([[0.52, 0.02, 1.02], [1.52, 0.02, 1.02]], np.float32)
    evidence = FloorEvidence()
    evidence.add("f", near_and_far, np.array([0.02, 0.02, 1.02]))
    assert (10, 0, 4) not in boxes(evidence.passes)
    assert {(9, 0, 4), (11, 0, 4)} <= set(boxes(evidence.passes))


def test_frames_are_counted_not_points() -> None:
    evidence = FloorEvidence()
    for name in ("a", "b"):
        evidence.add(name, np.array([[1.01, 0, 0], [1.02, 0, 0]], np.float32), np.array([0, 0, 1.0]))
    assert boxes(evidence.hits) == {(20, 0, 0): 2}


def test_heights_are_kept_apart_by_whether_the_camera_is_above() -> None:
    evidence = FloorEvidence()
    evidence.add("f", np.array([[1, 0, 0.005], [1, 0, 2.505]], np.float32), np.array([0, 0, 1.0]))
    assert evidence.heights_below.items()[0].tolist() == [0]
    assert evidence.heights_above.items()[0].tolist() == [250]


def test_a_frame_added_twice_counts_once() -> None:
    once, twice = FloorEvidence(), FloorEvidence()
    points = np.array([[1, 0, 0]], np.float32)
    once.add("f", points, np.array([0, 0, 1.0]))
    for _ in range(2):
        twice.add("f", points, np.array([0, 0, 1.0]))
    assert twice.to_bytes() == once.to_bytes()


def test_points_that_are_far_or_not_finite_are_left_out() -> None:
    evidence = FloorEvidence()
    points = np.array([[np.nan, 0, 0], [np.inf, 0, 0], [9, 0, 0], [1, 0, 0]], np.float32)
    evidence.add("f", points, np.zeros(3), EvidenceParams(max_range=8.0))
    assert boxes(evidence.hits) == {(20, 0, 0): 1}


def test_a_frame_without_points_still_says_where_it_was_taken() -> None:
    evidence = FloorEvidence()
    evidence.add("f", np.zeros((0, 3), np.float32), np.array([1.0, 2.0, 3.0]))
    assert evidence.cameras == {"f": (1.0, 2.0, 3.0)}
    assert boxes(evidence.passes) == {}


@pytest.mark.parametrize("camera", [[np.nan, 0, 0], [1e9, 0, 0], [0, 0]])
def test_a_camera_that_is_nowhere_is_refused(camera: list[float]) -> None:
    with pytest.raises(InvalidInput, match="camera position"):
        FloorEvidence().add("f", np.zeros((0, 3), np.float32), np.array(camera))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(CLOUDS, st.tuples(*[st.floats(-3, 3)] * 3)), max_size=5), st.randoms())
def test_the_order_of_frames_changes_nothing(frames: list, random: object) -> None:
    numbered = [(f"f{number}", points, np.array(camera)) for number, (points, camera) in enumerate(frames)]
    one, other = FloorEvidence(), FloorEvidence()
    for frame in numbered:
        one.add(*frame)
    random.shuffle(numbered)  # type: ignore[attr-defined]
    for frame in numbered:
        other.add(*frame)
        other.hits.items()  # merging early changes nothing either
    assert one.to_bytes() == other.to_bytes()


@settings(max_examples=40, deadline=None)
@given(CLOUDS, st.text(max_size=8))
def test_the_bytes_give_back_the_evidence(points: np.ndarray, frame_id: str) -> None:
    evidence = FloorEvidence()
    evidence.add(frame_id, points, np.array([0.1, 0.2, 1.3]))
    again = FloorEvidence.from_bytes(evidence.to_bytes())
    assert again.cameras == evidence.cameras
    assert {name: view.tolist() for name, view in again.views.items()} == {
        name: view.tolist() for name, view in evidence.views.items()
    }
    assert again.to_bytes() == evidence.to_bytes()


@pytest.mark.parametrize("data", [b"", b"nonsense", FloorEvidence().to_bytes()[:-3], b"OVIPFE02xyz", SHORT])
def test_other_bytes_are_corrupt(data: bytes) -> None:
    with pytest.raises(Corrupt):
        FloorEvidence.from_bytes(data)


@given(
    arrays.arrays(
        np.int64, st.tuples(st.integers(0, 5), st.just(3)), elements=st.integers(-(2**20), 2**20 - 1)
    )
)
def test_packing_a_voxel_can_be_undone(index: np.ndarray) -> None:
    assert unpack_voxel(pack_voxel(index)).tolist() == index.tolist()


def test_a_view_is_the_coarse_cubes_of_what_the_frame_saw() -> None:
    evidence = FloorEvidence()
    points = np.array([[0.6, 0.1, 0.1], [0.9, 0.4, 0.2], [-0.1, 0.1, 0.1], [20, 0, 0]], np.float32)
    evidence.add("f", points, np.array([0.0, 0.0, 1.0]))
    assert unpack_voxel(evidence.views["f"]).tolist() == [[-1, 0, 0], [1, 0, 0]]


def test_a_frame_far_from_the_origin_counts_as_one_near_it() -> None:
    """40 km away, where a cell is still a cell."""
    near, far = FloorEvidence(), FloorEvidence()
    shift = np.array([40_000.0, -40_000.0, 0.0])
    near.add("f", np.array([[0.5, 0.0, 0.5]], np.float32), np.array([0.0, 0.0, 1.0]))
    far.add("f", np.array([[0.5, 0.0, 0.5]]) + shift, shift + np.array([0.0, 0.0, 1.0]))
    assert len(far.hits.items()[0]) == 1
    assert far.heights_below.items()[0].tolist() == near.heights_below.items()[0].tolist()


def gathered(frames: list, until: int | None = None) -> FloorEvidence:
    evidence = FloorEvidence()
    for number, (points, camera) in enumerate(frames[:until]):
        evidence.add(f"f{number}", points, np.array(camera))
    return evidence


FRAMES = st.lists(st.tuples(CLOUDS, st.tuples(*[st.floats(-3, 3)] * 3)), max_size=6)


@settings(max_examples=40, deadline=None)
@given(FRAMES, st.lists(st.integers(0, 6), max_size=3))
def test_segments_put_together_are_the_evidence(frames: list, stops: list[int]) -> None:
    evidence, parts, before = FloorEvidence(), [], 0
    stops = sorted({*(stop for stop in stops if stop < len(frames)), len(frames)})
    for number, (points, camera) in enumerate(frames):
        if number in stops:
            parts.append(evidence.segment(before))
            before = evidence.revision
        evidence.add(f"f{number}", points, np.array(camera))
    parts.append(evidence.segment(before))
    restored = FloorEvidence.restore(parts)
    assert restored.revision == len(frames)
    assert restored.to_bytes() == evidence.to_bytes()


@settings(max_examples=20, deadline=None)
@given(FRAMES, st.integers(0, 6))
def test_what_was_restored_goes_on_as_if_it_had_never_stopped(frames: list, stop: int) -> None:
    whole = gathered(frames)
    first = gathered(frames, stop).segment(0)
    again = FloorEvidence.restore([first])
    started = again.revision
    for number, (points, camera) in enumerate(frames):
        again.add(f"f{number}", points, np.array(camera))
    assert again.to_bytes() == whole.to_bytes()
    assert FloorEvidence.restore([first, again.segment(started)]).to_bytes() == whole.to_bytes()


def test_a_segment_holds_only_what_changed() -> None:
    """A frame 100 m away says nothing of the first hundred."""
    evidence = FloorEvidence()
    cloud = np.random.default_rng(0).uniform(0, 3, (2000, 3)).astype(np.float32)
    for number in range(10):
        evidence.add(f"near{number}", cloud, np.array([1.0, 1.0, 1.0]))
    evidence.add("far", np.array([[101.0, 0, 0]], np.float32), np.array([100.0, 0.0, 1.0]))
    assert len(evidence.segment(10)) < 0.1 * len(evidence.segment(0))
    assert len(evidence.segment(11)) < len(evidence.segment(10))


def test_frames_that_came_from_bytes_are_told_apart_no_more() -> None:
    evidence = gathered([(np.array([[1, 0, 0]], np.float32), (0, 0, 1))] * 3)
    restored = FloorEvidence.restore([evidence.segment(0)])
    assert restored.segment(1) == restored.segment(0)


def test_no_segments_are_no_evidence() -> None:
    assert FloorEvidence.restore([]).to_bytes() == FloorEvidence().to_bytes()


def test_a_missing_segment_is_corrupt() -> None:
    evidence = gathered([(np.array([[1, 0, 0]], np.float32), (0, 0, 1))] * 3)
    with pytest.raises(Corrupt, match="from frame 0"):
        FloorEvidence.restore([evidence.segment(2)])


def test_counts_stay_exact_past_what_a_byte_holds() -> None:
    evidence = gathered([(np.array([[1.01, 0, 0]], np.float32), (0, 0, 1))] * 300)
    assert boxes(evidence.hits) == {(20, 0, 0): 300}
    assert boxes(FloorEvidence.from_bytes(evidence.to_bytes()).hits) == {(20, 0, 0): 300}
