"""Answers as JSON: the fields, and the change into the recording's own frame."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.answer_json import OutputFrame, answer_to_json, event_to_json, number, object_to_json
from ovip.scene.answers import (
    Answer,
    Candidate,
    Coverage,
    Goal,
    Outcome,
    RegionCoverage,
    TierReport,
    TierResult,
    TierStarted,
    Viewpoint,
)
from ovip.scene.types import F64, Box2, MapObject, Move, Presence, Relation, RelationKind
from tests.unit.ovip.map_objects import map_object

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0.5], [0, 0, 0, 1]])
"""Source (x, y, z) is world (x, -z, y + 0.5): y up, its origin half a metre above the world's."""


def answer(**changes: object) -> Answer:
    fields = {
        "outcome": Outcome.FOUND,
        "tier": 2,
        "object": Candidate(
            "mug",
            np.array([1.0, 2.0, 3.0]),
            0.9,
            "white",
            "o-1",
            np.array([0.0, 1.0, 2.0, 2.0, 3.0, 4.0]),
            "r.s.7",
            Box2(1, 2, 3, 4),
        ),
        "goal": Goal(np.array([1.0, 1.0, 0.0]), np.pi / 2),
        "path": np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]),
        "tiers": (TierReport(1, TierResult.AMBIGUOUS, "two mugs", 0, 1.23456),),
    }
    return Answer(**{**fields, **changes})  # type: ignore[arg-type]


def test_an_answer_has_the_fields_that_the_command_line_prints() -> None:
    body = answer_to_json(answer(), "s-1")
    assert list(body)[:6] == ["outcome", "tier", "object", "goal", "path", "tiers"]
    assert body["outcome"] == "found"
    assert body["tier"] == 2
    assert body["search_id"] == "s-1"
    assert body["object"]["position"] == [1.0, 2.0, 3.0]
    assert body["object"]["box"] == [0.0, 1.0, 2.0, 2.0, 3.0, 4.0]
    assert body["object"]["box2"] == [1.0, 2.0, 3.0, 4.0]
    assert body["tiers"] == [
        {"tier": 1, "result": "ambiguous", "why": "two mugs", "vlm_calls": 0, "ms": 1.235}
    ]
    assert json.loads(json.dumps(body, allow_nan=False)) == body


def test_an_answer_without_an_object_says_null_and_an_empty_path_is_an_empty_list() -> None:
    body = answer_to_json(
        answer(outcome=Outcome.UNRESOLVED, tier=4, object=None, goal=None, path=np.zeros((0, 3)))
    )
    assert (body["object"], body["goal"], body["path"], body["coverage"]) == (None, None, [], None)


def test_positions_boxes_and_paths_turn_into_the_recordings_frame() -> None:
    body = answer_to_json(answer(), "", Y_UP)
    assert body["frame"] == "source"
    assert body["object"]["position"] == [1.0, 2.5, -2.0]
    assert body["object"]["box"] == [0.0, 1.5, -3.0, 2.0, 3.5, -1.0]
    assert body["path"] == [[0.0, -0.5, 0.0], [1.0, -0.5, -1.0]]


def test_a_heading_in_the_recordings_frame_is_a_direction_and_no_angle() -> None:
    assert answer_to_json(answer())["goal"] == {
        "position": [1.0, 1.0, 0.0],
        "yaw": 1.5708,
        "facing": [0, 1, 0],
    }
    goal = answer_to_json(answer(), "", Y_UP)["goal"]
    assert goal["yaw"] is None
    assert goal["facing"] == [0.0, 0.0, -1.0]


def test_a_candidate_that_is_no_mapped_object_has_nulls() -> None:
    stray = Candidate("mug", np.zeros(3), float("nan"), "voxel vote")
    body = answer_to_json(answer(candidates=(stray,)))["candidates"][0]
    assert [body[name] for name in ("id", "box", "frame_id", "box2", "score")] == [None] * 5


def test_coverage_is_told_region_by_region() -> None:
    coverage = Coverage(6, 5, 1, (RegionCoverage("r-1", "kitchen", 9.0, 0.5, 0.25),), 0.125, False)
    body = answer_to_json(answer(coverage=coverage))["coverage"]
    assert body == {
        "planned": 6,
        "visited": 5,
        "unreachable": 1,
        "posterior_present": 0.125,
        "complete": False,
        "regions": [{"region_id": "r-1", "display_name": "kitchen", "area": 9.0, "seen": 0.5, "prior": 0.25}],
    }


def test_every_event_of_a_search_has_its_name() -> None:
    view = Viewpoint("v-1", np.array([1.0, 2.0, 0.0]), 0.0, "r-1", 1, 6, np.zeros((0, 3)))
    named = [
        event_to_json(event, "s-1")
        for event in (TierStarted(1), TierReport(1, TierResult.MISSING, "", 0, 0), view, answer())
    ]
    assert [name for name, _ in named] == ["tier_started", "tier_finished", "viewpoint", "answer"]
    assert all(body["search_id"] == "s-1" for _, body in named)
    assert named[2][1]["facing"] == [1.0, 0.0, 0.0]


def test_an_object_lists_its_labels_most_frequent_first_and_leaves_its_feature_out() -> None:
    obj = MapObject(
        "o-1",
        "mug",
        {"cup": 2, "bowl": 2, "mug": 5},
        np.zeros(3),
        np.zeros(6),
        np.ones(4, np.float32),
        1.0,
        9,
        7,
        1,
        2,
        30,
        np.array([1.0, 2.0, 3.0]),
        "",
        Box2(0, 0, 0, 0),
        4,
    )
    body = object_to_json(obj)
    assert list(body["label_counts"]) == ["mug", "bowl", "cup"]
    assert "feature" not in body
    assert (body["frame_id"], body["box2"]) == (None, None)


def test_an_object_tells_how_it_stands_whether_it_is_there_and_where_it_was() -> None:
    turned = np.array([[0.0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    obj = map_object(
        "o000001",
        presence=Presence.MOVED_OR_REMOVED,
        pinned=True,
        relations=(Relation(RelationKind.NEXT_TO, "o000002", {"gap": 0.12344}),),
        moves=(Move(5, np.array([1.0, 2.0, 3.0])),),
        revision=4,
    )

    body = object_to_json(obj, turned)

    assert (body["presence"], body["pinned"], body["label_given"]) == ("moved_or_removed", True, False)
    assert body["relations"] == [{"kind": "next_to", "object_id": "o000002", "evidence": {"gap": 0.1234}}]
    assert body["moves"] == [{"timestamp_ns": 5, "position": [-2.0, 1.0, 3.0]}]
    assert body["revision"] == 4


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_json_cannot_say_is_null(value: float) -> None:
    assert number(value) is None


def _rigid(angles: tuple[float, float, float], shift: tuple[float, float, float]) -> F64:
    a, b, c = angles
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(c), -np.sin(c)], [0, np.sin(c), np.cos(c)]])
    pose = np.eye(4)
    pose[:3, :3] = about_z @ about_y @ about_x
    pose[:3, 3] = shift
    return pose


_angles = st.tuples(*[st.floats(-3.2, 3.2)] * 3)
_shifts = st.tuples(*[st.floats(-20, 20)] * 3)


@given(_angles, _shifts, _angles, _shifts)
def test_a_pose_read_in_a_frame_is_the_pose_reported_in_it(
    turn: tuple[float, float, float],
    shift: tuple[float, float, float],
    camera_turn: tuple[float, float, float],
    camera_shift: tuple[float, float, float],
) -> None:
    frame, camera = OutputFrame(_rigid(turn, shift)), _rigid(camera_turn, camera_shift)
    np.testing.assert_allclose(frame.world_pose(frame.pose(camera)), camera, atol=1e-9)
    np.testing.assert_allclose(frame.points(camera[:3, 3])[0], frame.pose(camera)[:3, 3], atol=1e-9)


@given(_angles, _shifts, st.lists(st.tuples(*[st.floats(0, 1)] * 3), min_size=1, max_size=8))
def test_a_turned_box_holds_every_turned_point_of_the_box(
    turn: tuple[float, float, float],
    shift: tuple[float, float, float],
    shares: list[tuple[float, float, float]],
) -> None:
    frame = OutputFrame(_rigid(turn, shift))
    box = np.array([-1.0, 2.0, 0.0, 0.5, 2.2, 3.0])
    inside = box[:3] + np.array(shares) * (box[3:] - box[:3])
    turned, bounds = frame.points(inside), frame.box(box)
    assert (turned >= bounds[:3] - 1e-9).all()
    assert (turned <= bounds[3:] + 1e-9).all()
