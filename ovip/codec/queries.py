"""Questions, and what happens while they are answered."""

from __future__ import annotations

from ovip.codec.answers import answer_message, answer_value, tier_report_message, tier_report_value
from ovip.codec.geometry import pose_message, pose_value, vector_message, vector_value, vectors_value
from ovip.errors import Corrupt
from ovip.scene.answers import Answer, Query, SearchEvent, TierReport, TierStarted, Viewpoint
from ovip.v1 import retrieval_pb2


def query_message(q: Query) -> retrieval_pb2.FindRequest:
    message = retrieval_pb2.FindRequest(
        scene=q.scene,
        text=q.text,
        region_hint=q.region_hint,
        min_tier=q.min_tier,
        max_tier=q.max_tier,
        max_vlm_calls=q.max_vlm_calls,
        max_viewpoints=q.max_viewpoints,
    )
    if q.robot_pose is not None or q.robot_radius:
        message.robot.radius = q.robot_radius
    if q.robot_pose is not None:
        message.robot.pose.CopyFrom(pose_message(q.robot_pose))
    return message


def query_value(m: retrieval_pb2.FindRequest) -> Query:
    return Query(
        scene=m.scene,
        text=m.text,
        robot_pose=pose_value(m.robot.pose) if m.robot.HasField("pose") else None,
        robot_radius=m.robot.radius,
        region_hint=m.region_hint,
        min_tier=m.min_tier,
        max_tier=m.max_tier,
        max_vlm_calls=m.max_vlm_calls,
        max_viewpoints=m.max_viewpoints,
    )


def event_message(event: SearchEvent) -> retrieval_pb2.FindEvent:
    match event:
        case TierStarted():
            return retrieval_pb2.FindEvent(tier_started=event.tier)
        case TierReport():
            return retrieval_pb2.FindEvent(tier_finished=tier_report_message(event))
        case Viewpoint():
            return retrieval_pb2.FindEvent(viewpoint=_viewpoint_message(event))
        case Answer():
            return retrieval_pb2.FindEvent(answer=answer_message(event))


def event_value(m: retrieval_pb2.FindEvent) -> SearchEvent:
    match m.WhichOneof("event"):
        case "tier_started":
            return TierStarted(m.tier_started)
        case "tier_finished":
            return tier_report_value(m.tier_finished)
        case "viewpoint":
            return _viewpoint_value(m.viewpoint)
        case "answer":
            return answer_value(m.answer)
        case other:
            raise Corrupt(f"search event: expected one of four kinds, got {other}")


def _viewpoint_message(v: Viewpoint) -> retrieval_pb2.Viewpoint:
    return retrieval_pb2.Viewpoint(
        viewpoint_id=v.viewpoint_id,
        position=vector_message(v.position),
        yaw=v.yaw,
        region_id=v.region_id,
        index=v.index,
        total=v.total,
        path=[vector_message(p) for p in v.path],
    )


def _viewpoint_value(m: retrieval_pb2.Viewpoint) -> Viewpoint:
    return Viewpoint(
        m.viewpoint_id, vector_value(m.position), m.yaw, m.region_id, m.index, m.total, vectors_value(m.path)
    )
