"""Frames of the history, where perception stands, how depth is encoded."""

from __future__ import annotations

from ovip.codec.geometry import (
    intrinsics_message,
    intrinsics_value,
    matrix_numbers,
    matrix_value,
    pose_message,
    pose_value,
)
from ovip.scene.answers import FrameRecord, PerceptionStatus
from ovip.v1 import perception_pb2, types_pb2

DEPTH_ENCODINGS = {
    types_pb2.DepthImage.ENCODING_UNSPECIFIED: "unspecified",
    types_pb2.DepthImage.ENCODING_PNG16: "png16",
    types_pb2.DepthImage.ENCODING_SHUFFLE_ZSTD: "shuffle_zstd",
}
DEPTH_ENCODING_NUMBERS = {name: number for number, name in DEPTH_ENCODINGS.items()}


def frame_record_message(r: FrameRecord) -> perception_pb2.FrameRecord:
    return perception_pb2.FrameRecord(
        frame_id=r.frame_id,
        timestamp_ns=r.timestamp_ns,
        pose=pose_message(r.world_from_camera),
        intrinsics=intrinsics_message(r.intrinsics),
        tags=r.tags,
        processed=r.processed,
        log_id=r.log_id,
    )


def frame_record_value(m: perception_pb2.FrameRecord) -> FrameRecord:
    return FrameRecord(
        frame_id=m.frame_id,
        timestamp_ns=m.timestamp_ns,
        world_from_camera=pose_value(m.pose),
        intrinsics=intrinsics_value(m.intrinsics),
        tags=tuple(m.tags),
        processed=m.processed,
        log_id=m.log_id,
    )


def perception_status_message(s: PerceptionStatus) -> perception_pb2.GetPerceptionStatusResponse:
    return perception_pb2.GetPerceptionStatusResponse(
        frames_durable=s.frames_durable,
        frames_processed=s.frames_processed,
        frames_skipped=s.frames_skipped,
        vocabulary=s.vocabulary,
        world_from_source=matrix_numbers(s.world_from_source),
        backend=s.backend,
        feature_space=s.feature_space,
        detections=s.detections,
        newest_detections_id=s.newest_detections_id,
    )


def perception_status_value(m: perception_pb2.GetPerceptionStatusResponse) -> PerceptionStatus:
    return PerceptionStatus(
        frames_durable=m.frames_durable,
        frames_processed=m.frames_processed,
        frames_skipped=m.frames_skipped,
        vocabulary=tuple(m.vocabulary),
        world_from_source=matrix_value(m.world_from_source, "world_from_source"),
        backend=m.backend,
        feature_space=m.feature_space,
        detections=m.detections,
        newest_detections_id=m.newest_detections_id,
    )
