"""The codec: every value goes to a message and comes back the same, and the same value gives the same bytes."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip import codec
from ovip.errors import Corrupt, InvalidInput
from ovip.scene import answers as a
from ovip.scene import edits as e
from ovip.scene import types as t
from ovip.scene import versions as v
from ovip.scene.grid import FloorGrid
from ovip.v1 import mapper_pb2, perception_pb2, regions_pb2, retrieval_pb2, types_pb2
from tests.builders import axis, camera, detection, pose, same

POINT = np.array([1.5, -2.25, 0.125])
BOX = np.array([0.0, 1, 2, 3, 4, 5])
RING = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])

MAP_OBJECT = t.MapObject(
    object_id="o000007",
    label="cup",
    label_counts={"cup": 3, "bowl": 1},
    centroid=POINT,
    box=BOX,
    feature=axis(2),
    view_weight=0.75,
    observations=4,
    frames=3,
    first_seen_ns=10,
    last_seen_ns=2**62,
    voxels=123,
    mean_color=np.array([1.0, 2.5, 255.0]),
    best_frame_id="r.s.00000003",
    best_box2=t.Box2(1.5, 2.5, 3.5, 4.5),
    version=9,
    revision=5,
    presence=t.Presence.MOVED_OR_REMOVED,
    pinned=True,
    label_given=True,
    relations=tuple(
        t.Relation(kind, f"o{i:06d}", {"gap": 0.125, "share": 0.5}) for i, kind in enumerate(t.RelationKind)
    ),
    moves=(t.Move(7, POINT), t.Move(2**62, -POINT)),
)
DETECTION = replace(detection(detection_id="r.s.00000001/cup/0"), second_feature=axis(1, 5))
NEAREST = (np.arange(12 * 16).reshape(12, 16) / np.float32(1000.0)).astype(np.float32)
BATCH = t.DetectionBatch(
    "r.s.00000001",
    2**62,
    camera(),
    pose(1, 2, 3, 0.4, 0.1),
    (DETECTION,),
    DETECTION.points,
    ("cup",),
    nearest=NEAREST,
)
DELTA = t.MapDelta(
    version=4,
    frame_id="r.s.00000002",
    kind=t.StepKind.UPKEEP,
    created=("o2",),
    updated=("o1", "o6", "o7", "o8"),
    removed=("o3",),
    aliases={"o5": "o1", "o4": "o1"},
    departed=("o6",),
    returned=("o7",),
    moved=("o8",),
)
PLAIN_OBJECT = replace(MAP_OBJECT, feature=np.zeros(0, np.float32))
DIFF = v.MapDiff(
    3,
    9,
    (
        v.ObjectChange("o000007", replace(PLAIN_OBJECT, label="mug"), PLAIN_OBJECT, ("label",)),
        v.ObjectChange("o000008", None, PLAIN_OBJECT),
        v.ObjectChange("o000009", PLAIN_OBJECT, None, (), "o000007"),
    ),
)
VERIFICATION = v.Verification(9, "ab", "cd", 3, (4, 8), 12)
ALIGNMENT = v.Alignment(pose(1, 2, 3, 0.4), 0.75, 0.0125)
EDITS = {
    "rename": e.Rename("o000007", "mug"),
    "rename back": e.Rename("o000007", ""),
    "merge": e.Merge("o000007", ("o000008", "o000009")),
    "split": e.Split("o000007", BOX, "lid"),
    "delete": e.Delete("o000007"),
    "pin": e.Pin("o000007"),
    "unpin": e.Pin("o000007", pinned=False),
}
REQUESTS = {name: e.EditRequest(f"e-{name}", 9, "ada", edit) for name, edit in EDITS.items()}
REGION = t.Region(
    "r1", 1, "kitchen", "kitchen 2", 12.5, POINT, (RING, RING + 3), (RING * 0.1,), ("o1",), ("f1", "f2")
)
PARTITION = t.Partition(
    map_version=7,
    revision=2,
    floors=(t.Floor(0, -0.1, 2.4, 30.0), t.Floor(1, 2.6, None, 28.0)),
    regions=(REGION, replace(REGION, region_id="r2", outlines=(), holes=())),
    edges=(t.RegionEdge("r1", "r2", 0.9, POINT),),
    fallbacks=("grouping: function table",),
)
GRID = FloorGrid(
    floor=1,
    origin=(-1.25, 3.5),
    resolution=0.05,
    occupancy=np.arange(6, dtype=np.uint8).reshape(2, 3),
    regions=np.array([[0, 1, 2], [65535, 1, 0]], np.uint16),
    region_ids=("r1", "r2"),
    revision=3,
)
RECORD = a.FrameRecord("r.s.00000001", 5, pose(1), camera(), ("cup", "table"), True, "1700-0")
STATUS = a.PerceptionStatus(9, 7, 1, ("cup",), pose(yaw=0.3), "embedded", "space", 44)
CANDIDATE = a.Candidate("cup", POINT, 0.5, "near the sink", "o1", BOX, "f1", t.Box2(0, 1, 2, 3))
REPORTS = tuple(a.TierReport(i, result, "why", i, 1.5) for i, result in enumerate(a.TierResult))
COVERAGE = a.Coverage(6, 4, 1, (a.RegionCoverage("r1", "kitchen", 12.0, 0.5, 0.25),), 0.125, False)
ANSWER = a.Answer(
    outcome=a.Outcome.FOUND,
    tier=1,
    object=CANDIDATE,
    goal=a.Goal(POINT, -1.25),
    path=np.array([[0.0, 0, 0], [1, 2, 0]]),
    tiers=REPORTS,
    candidates=(CANDIDATE, a.Candidate("bowl", POINT, 0.0, "")),
    rejected=(CANDIDATE,),
    fallbacks=("no VLM",),
    map_version=7,
    regions_revision=2,
    coverage=COVERAGE,
    needs="a robot",
)
NOTHING = a.Answer(a.Outcome.UNRESOLVED, 0, None, None, np.zeros((0, 3)), ())
VIEWPOINT = a.Viewpoint("v1", POINT, 0.5, "r1", 2, 6, np.array([[0.0, 0, 0], [1, 1, 0]]))

ROUND_TRIPS: dict[str, tuple[Any, Callable[[Any], Any], Callable[[Any], Any]]] = {
    "box": (BOX, codec.box_message, codec.box_value),
    "box2": (t.Box2(-1.5, 0, 2, 3), codec.box2_message, codec.box2_value),
    "pose": (pose(1, 2, 3, 0.4), codec.pose_message, codec.pose_value),
    "intrinsics": (camera(), codec.intrinsics_message, codec.intrinsics_value),
    "detection": (DETECTION, codec.detection_message, codec.detection_value),
    "object": (MAP_OBJECT, codec.object_message, codec.object_value),
    "delta": (DELTA, codec.delta_message, codec.delta_value),
    "diff": (DIFF, codec.diff_message, codec.diff_value),
    "verification": (VERIFICATION, codec.verification_message, codec.verification_value),
    "alignment": (ALIGNMENT, codec.alignment_message, codec.alignment_value),
    **{
        name: (request, codec.edit_request_message, codec.edit_request_value)
        for name, request in REQUESTS.items()
    },
    "partition": (PARTITION, codec.partition_message, codec.partition_value),
    "empty partition": (t.Partition(0, 0), codec.partition_message, codec.partition_value),
    "floor grid": (GRID, codec.floor_grid_message, codec.floor_grid_value),
    "frame record": (RECORD, codec.frame_record_message, codec.frame_record_value),
    "status": (STATUS, codec.perception_status_message, codec.perception_status_value),
    "query": (
        a.Query("k", "the cup", pose(), 0.3, "kitchen", 1, 4, 5, 6),
        codec.query_message,
        codec.query_value,
    ),
    "bare query": (a.Query("k", "the cup"), codec.query_message, codec.query_value),
    "query of a radius": (a.Query("k", "cup", robot_radius=0.2), codec.query_message, codec.query_value),
    "answer": (ANSWER, codec.answer_message, codec.answer_value),
    "absent": (replace(NOTHING, outcome=a.Outcome.ABSENT), codec.answer_message, codec.answer_value),
    "unresolved": (NOTHING, codec.answer_message, codec.answer_value),
    "tier started": (a.TierStarted(2), codec.event_message, codec.event_value),
    "tier 0 started": (a.TierStarted(0), codec.event_message, codec.event_value),
    "tier report": (REPORTS[0], codec.event_message, codec.event_value),
    "viewpoint": (VIEWPOINT, codec.event_message, codec.event_value),
    "answer event": (ANSWER, codec.event_message, codec.event_value),
}
ENCODINGS: dict[str, tuple[Any, Callable[[Any], bytes], Callable[[bytes], Any]]] = {
    "detection batch": (BATCH, codec.encode_detection_batch, codec.decode_detection_batch),
    "late batch": (
        replace(
            BATCH,
            late=True,
            surface=np.zeros((0, 3), np.float32),
            detections=(),
            nearest=np.zeros((0, 0), np.float32),
        ),
        codec.encode_detection_batch,
        codec.decode_detection_batch,
    ),
    "delta": (DELTA, codec.encode_delta, codec.decode_delta),
    "partition": (PARTITION, codec.encode_partition, codec.decode_partition),
    "floor grid": (GRID, codec.encode_floor_grid, codec.decode_floor_grid),
    "answer": (ANSWER, codec.encode_answer, codec.decode_answer),
    **{
        name: (request, codec.encode_edit_request, codec.decode_edit_request)
        for name, request in REQUESTS.items()
    },
}


@pytest.mark.parametrize("kind", ROUND_TRIPS)
def test_a_value_comes_back_from_its_message_the_same(kind: str) -> None:
    value, message, back = ROUND_TRIPS[kind]

    made = message(value)
    over_the_wire = type(made).FromString(made.SerializeToString())

    assert same(back(over_the_wire), value)


@pytest.mark.parametrize("kind", ENCODINGS)
def test_a_value_comes_back_from_its_bytes_the_same_and_the_bytes_are_the_same_again(kind: str) -> None:
    value, encode, decode = ENCODINGS[kind]
    data = encode(value)

    assert same(decode(data), value)
    assert encode(decode(data)) == data


def test_the_bytes_of_a_delta_do_not_depend_on_the_order_its_aliases_came_in() -> None:
    turned = replace(DELTA, aliases=dict(reversed(DELTA.aliases.items())))

    assert codec.encode_delta(turned) == codec.encode_delta(DELTA)


@pytest.mark.parametrize("kind", ENCODINGS)
def test_bytes_cut_off_are_corrupt_or_another_value_and_never_a_crash(kind: str) -> None:
    _, encode, decode = ENCODINGS[kind]
    data = encode(ENCODINGS[kind][0])
    for end in range(0, len(data), max(1, len(data) // 60)):
        with contextlib.suppress(Corrupt, InvalidInput):
            decode(data[:end])


@given(st.sampled_from(sorted(ENCODINGS)), st.binary(max_size=80))
def test_no_bytes_raise_anything_but_corrupt_or_invalid_input(kind: str, data: bytes) -> None:
    with contextlib.suppress(Corrupt, InvalidInput):
        ENCODINGS[kind][2](data)


def test_bytes_that_do_not_parse_are_corrupt_in_words() -> None:
    with pytest.raises(Corrupt, match="DetectionBatch: 3 bytes do not parse"):
        codec.decode_detection_batch(b"\xff\xff\xff")


@given(hnp.arrays(np.float32, st.tuples(st.integers(0, 5), st.just(3)), elements=st.floats(width=32)))
def test_float_arrays_come_back_bit_for_bit(points: t.F32) -> None:
    again = codec.floats_value(codec.floats(points), 3)

    assert again.shape == points.shape
    assert again.tobytes() == points.tobytes()


def test_arrays_of_another_layout_are_written_in_order() -> None:
    points = np.asfortranarray(np.arange(6, dtype=np.float32).reshape(2, 3))

    assert codec.floats_value(codec.floats(points), 3).tolist() == [[0, 1, 2], [3, 4, 5]]


def test_lengths_that_are_no_array_are_corrupt() -> None:
    with pytest.raises(Corrupt, match="multiple of 12 bytes of float32, got 8"):
        codec.floats_value(b"\0" * 8, 3)
    with pytest.raises(Corrupt, match="multiple of 4 bytes of float32, got 3"):
        codec.floats_value(b"\0" * 3)
    with pytest.raises(Corrupt, match="multiple of 3 bytes of RGB, got 4"):
        codec.colors_value(b"\0" * 4)


def test_points_without_their_colours_are_corrupt() -> None:
    message = codec.detection_message(DETECTION)
    message.colors = b""

    with pytest.raises(Corrupt, match=r"r\.s\.00000001/cup/0"):
        codec.detection_value(message)


@pytest.mark.parametrize("count", [0, 9, 15, 17])
def test_a_pose_of_any_other_count_than_16_is_refused(count: int) -> None:
    with pytest.raises(InvalidInput, match=f"pose: expected 16 numbers .* got {count}"):
        codec.pose_value(types_pb2.Pose(world_from_camera=[0.0] * count))


def test_an_answer_from_the_future_is_corrupt() -> None:
    with pytest.raises(Corrupt, match="outcome 77"):
        codec.answer_value(retrieval_pb2.Answer(outcome=77))
    with pytest.raises(Corrupt, match="result 77"):
        codec.tier_report_value(retrieval_pb2.TierReport(result=77))
    with pytest.raises(Corrupt, match="expected one of four kinds"):
        codec.event_value(retrieval_pb2.FindEvent())


def test_enum_members_from_the_future_are_corrupt_in_words() -> None:
    relation = types_pb2.Relation(kind=99, other_id="o2")
    with pytest.raises(Corrupt, match="object o1: presence 77 is not known"):
        codec.object_value(types_pb2.MapObject(object_id="o1", presence=77))
    for unknown in (relation, types_pb2.Relation(other_id="o2")):
        with pytest.raises(Corrupt, match=r"object o1: relation (99|0) is not known"):
            codec.object_value(types_pb2.MapObject(object_id="o1", relations=[unknown]))
    with pytest.raises(Corrupt, match="map version 4: step kind 77 is not known"):
        codec.delta_value(mapper_pb2.MapDelta(version=4, kind=77))


def test_what_was_written_before_a_field_was_there_reads_as_what_it_meant() -> None:
    assert codec.delta_value(mapper_pb2.MapDelta(version=4)).kind is t.StepKind.FRAME
    assert codec.object_value(types_pb2.MapObject(object_id="o1")).presence is t.Presence.PRESENT
    assert codec.detection_value(types_pb2.Detection(detection_id="d")).second_feature.size == 0


def test_a_grid_whose_bytes_do_not_match_its_size_is_corrupt() -> None:
    message = codec.floor_grid_message(GRID)
    message.rows = 3

    with pytest.raises(Corrupt, match="3 x 3 cells"):
        codec.floor_grid_value(message)


def test_every_field_of_the_values_travels() -> None:
    """A field that a message lacks would be lost in silence."""
    for value, message in (
        (BATCH, types_pb2.DetectionBatch),
        (DETECTION, types_pb2.Detection),
        (MAP_OBJECT, types_pb2.MapObject),
        (DELTA, mapper_pb2.MapDelta),
        (MAP_OBJECT.relations[0], types_pb2.Relation),
        (MAP_OBJECT.moves[0], types_pb2.Move),
        (DIFF, mapper_pb2.DiffMapResponse),
        (DIFF.changes[0], mapper_pb2.ObjectChange),
        (VERIFICATION, mapper_pb2.VerifyMapResponse),
        (ALIGNMENT, mapper_pb2.AlignMapResponse),
        (EDITS["rename"], mapper_pb2.RenameEdit),
        (EDITS["merge"], mapper_pb2.MergeEdit),
        (EDITS["split"], mapper_pb2.SplitEdit),
        (EDITS["delete"], mapper_pb2.DeleteEdit),
        (EDITS["pin"], mapper_pb2.PinEdit),
        (REGION, regions_pb2.Region),
        (RECORD, perception_pb2.FrameRecord),
        (STATUS, perception_pb2.GetPerceptionStatusResponse),
        (CANDIDATE, retrieval_pb2.Candidate),
        (ANSWER, retrieval_pb2.Answer),
    ):
        assert len(message.DESCRIPTOR.fields) == len(type(value).__slots__), message.DESCRIPTOR.name
