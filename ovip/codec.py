"""The only translator between protobuf messages and the values of the scene.

`*_message` makes a message, `*_value` reads one, `encode_*` and `decode_*` go to bytes. Reading raises Corrupt
for what cannot be a value (lengths, enum members, bytes that do not parse), InvalidInput for a matrix not 4x4.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np
from google.protobuf.message import DecodeError, Message

from ovip.errors import Corrupt, InvalidInput
from ovip.scene import answers as a
from ovip.scene import types as t
from ovip.scene.grid import FloorGrid
from ovip.v1 import mapper_pb2, perception_pb2, regions_pb2, retrieval_pb2, types_pb2

_Message = TypeVar("_Message", bound=Message)

DEPTH_ENCODINGS = {
    types_pb2.DepthImage.ENCODING_UNSPECIFIED: "unspecified",
    types_pb2.DepthImage.ENCODING_PNG16: "png16",
    types_pb2.DepthImage.ENCODING_SHUFFLE_ZSTD: "shuffle_zstd",
}
DEPTH_ENCODING_NUMBERS = {name: number for number, name in DEPTH_ENCODINGS.items()}
_OUTCOMES = {
    a.Outcome.FOUND: retrieval_pb2.Answer.OUTCOME_FOUND,
    a.Outcome.ABSENT: retrieval_pb2.Answer.OUTCOME_ABSENT,
    a.Outcome.UNRESOLVED: retrieval_pb2.Answer.OUTCOME_UNRESOLVED,
}
_RESULTS: dict[a.TierResult, Any] = {
    result: retrieval_pb2.TierReport.Result.Value(f"RESULT_{result.name}") for result in a.TierResult
}


# Geometry


def vector_message(v: Sequence[float] | t.F64) -> types_pb2.Vector3:
    return types_pb2.Vector3(x=float(v[0]), y=float(v[1]), z=float(v[2]))


def vector_value(m: types_pb2.Vector3) -> t.F64:
    return np.array([m.x, m.y, m.z])


def box_message(box: t.F64) -> types_pb2.Box3:
    return types_pb2.Box3(low=vector_message(box[:3]), high=vector_message(box[3:]))


def box_value(m: types_pb2.Box3) -> t.F64:
    return np.concatenate([vector_value(m.low), vector_value(m.high)])


def box2_message(box: t.Box2) -> types_pb2.Box2:
    return types_pb2.Box2(x0=box.x0, y0=box.y0, x1=box.x1, y1=box.y1)


def box2_value(m: types_pb2.Box2) -> t.Box2:
    return t.Box2(m.x0, m.y0, m.x1, m.y1)


def pose_message(pose: t.F64) -> types_pb2.Pose:
    return types_pb2.Pose(world_from_camera=np.asarray(pose, np.float64).ravel().tolist())


def pose_value(m: types_pb2.Pose) -> t.F64:
    """`(4, 4)`; only the count is checked here, `camera.check_pose` checks the rest."""
    return matrix_value(m.world_from_camera, "pose")


def matrix_value(numbers: Iterable[float], what: str) -> t.F64:
    matrix = np.array(list(numbers), dtype=np.float64)
    if matrix.size != 16:
        raise InvalidInput(f"{what}: expected 16 numbers (4x4 row-major), got {matrix.size}")
    return matrix.reshape(4, 4)


def intrinsics_message(k: t.Intrinsics) -> types_pb2.Intrinsics:
    return types_pb2.Intrinsics(fx=k.fx, fy=k.fy, cx=k.cx, cy=k.cy, width=k.width, height=k.height)


def intrinsics_value(m: types_pb2.Intrinsics) -> t.Intrinsics:
    return t.Intrinsics(m.fx, m.fy, m.cx, m.cy, m.width, m.height)


# Arrays as little-endian bytes


def floats(array: t.F32) -> bytes:
    return np.ascontiguousarray(array, dtype="<f4").tobytes()


def floats_value(data: bytes, columns: int = 0) -> t.F32:
    """float32 bytes -> `(N,)`, or `(N, columns)`."""
    if len(data) % (4 * max(columns, 1)):
        raise Corrupt(f"expected a multiple of {4 * max(columns, 1)} bytes of float32, got {len(data)}")
    array = np.frombuffer(data, dtype="<f4").astype(np.float32)
    return array.reshape(-1, columns) if columns else array


def colors_value(data: bytes) -> t.U8:
    """uint8 bytes -> `(N, 3)`."""
    if len(data) % 3:
        raise Corrupt(f"expected a multiple of 3 bytes of RGB, got {len(data)}")
    return np.frombuffer(data, dtype=np.uint8).reshape(-1, 3)


# Detections


def detection_message(d: t.Detection) -> types_pb2.Detection:
    return types_pb2.Detection(
        detection_id=d.detection_id,
        label=d.label,
        score=d.score,
        box2=box2_message(d.box2),
        box3=box_message(d.box),
        feature=floats(d.feature),
        points=floats(d.points),
        colors=np.ascontiguousarray(d.colors).tobytes(),
    )


def detection_value(m: types_pb2.Detection) -> t.Detection:
    if len(m.points) != 4 * len(m.colors):
        raise Corrupt(
            f"detection {m.detection_id}: {len(m.points)} bytes of points, {len(m.colors)} of colours"
        )
    return t.Detection(
        detection_id=m.detection_id,
        label=m.label,
        score=m.score,
        box2=box2_value(m.box2),
        box=box_value(m.box3),
        feature=floats_value(m.feature),
        points=floats_value(m.points, 3),
        colors=colors_value(m.colors),
    )


def encode_detection_batch(batch: t.DetectionBatch) -> bytes:
    """The bytes of a batch, the same for the same batch."""
    return types_pb2.DetectionBatch(
        frame_id=batch.frame_id,
        pose=pose_message(batch.world_from_camera),
        intrinsics=intrinsics_message(batch.intrinsics),
        timestamp_ns=batch.timestamp_ns,
        detections=[detection_message(d) for d in batch.detections],
        surface_points=floats(batch.surface),
        late=batch.late,
        words=batch.words,
    ).SerializeToString(deterministic=True)


def decode_detection_batch(data: bytes) -> t.DetectionBatch:
    m = _parsed(types_pb2.DetectionBatch, data)
    return t.DetectionBatch(
        frame_id=m.frame_id,
        timestamp_ns=m.timestamp_ns,
        intrinsics=intrinsics_value(m.intrinsics),
        world_from_camera=pose_value(m.pose),
        detections=tuple(detection_value(d) for d in m.detections),
        surface=floats_value(m.surface_points, 3),
        words=tuple(m.words),
        late=m.late,
    )


# Map


def object_message(o: t.MapObject) -> types_pb2.MapObject:
    return types_pb2.MapObject(
        object_id=o.object_id,
        label=o.label,
        label_counts=o.label_counts,
        centroid=vector_message(o.centroid),
        box=box_message(o.box),
        feature=floats(o.feature),
        view_weight=o.view_weight,
        observations=o.observations,
        frames=o.frames,
        first_seen_ns=o.first_seen_ns,
        last_seen_ns=o.last_seen_ns,
        voxels=o.voxels,
        mean_color=o.mean_color.tolist(),
        best_frame_id=o.best_frame_id,
        best_box=box2_message(o.best_box2),
        version=o.version,
    )


def object_value(m: types_pb2.MapObject) -> t.MapObject:
    return t.MapObject(
        object_id=m.object_id,
        label=m.label,
        label_counts=dict(m.label_counts),
        centroid=vector_value(m.centroid),
        box=box_value(m.box),
        feature=floats_value(m.feature),
        view_weight=m.view_weight,
        observations=m.observations,
        frames=m.frames,
        first_seen_ns=m.first_seen_ns,
        last_seen_ns=m.last_seen_ns,
        voxels=m.voxels,
        mean_color=np.array(m.mean_color),
        best_frame_id=m.best_frame_id,
        best_box2=box2_value(m.best_box),
        version=m.version,
    )


def map_message(scene_map: t.SceneMap) -> mapper_pb2.GetMapResponse:
    return mapper_pb2.GetMapResponse(
        scene=scene_map.scene,
        version=scene_map.version,
        objects=[object_message(o) for o in scene_map.objects],
        state_hash=scene_map.state_hash,
        frames=scene_map.frames,
        detections=scene_map.detections,
        applied_log_id=scene_map.applied_log_id,
    )


def map_value(m: mapper_pb2.GetMapResponse) -> t.SceneMap:
    return t.SceneMap(
        scene=m.scene,
        version=m.version,
        objects=tuple(object_value(o) for o in m.objects),
        state_hash=m.state_hash,
        frames=m.frames,
        detections=m.detections,
        applied_log_id=m.applied_log_id,
    )


def delta_message(delta: t.MapDelta) -> mapper_pb2.MapDelta:
    return mapper_pb2.MapDelta(
        version=delta.version,
        frame_id=delta.frame_id,
        created=delta.created,
        updated=delta.updated,
        removed=delta.removed,
        aliases=delta.aliases,
    )


def delta_value(m: mapper_pb2.MapDelta) -> t.MapDelta:
    return t.MapDelta(
        version=m.version,
        frame_id=m.frame_id,
        created=tuple(m.created),
        updated=tuple(m.updated),
        removed=tuple(m.removed),
        aliases=dict(m.aliases),
    )


def encode_delta(delta: t.MapDelta) -> bytes:
    return delta_message(delta).SerializeToString(deterministic=True)


def decode_delta(data: bytes) -> t.MapDelta:
    return delta_value(_parsed(mapper_pb2.MapDelta, data))


# Regions


def partition_message(p: t.Partition) -> regions_pb2.Partition:
    return regions_pb2.Partition(
        map_version=p.map_version,
        revision=p.revision,
        floors=[
            regions_pb2.FloorSummary(floor=f.floor, z=f.z, ceiling_z=f.ceiling_z or 0.0, area=f.area)
            for f in p.floors
        ],
        regions=[
            regions_pb2.Region(
                region_id=r.region_id,
                floor=r.floor,
                function=r.function,
                display_name=r.display_name,
                area=r.area,
                centroid=vector_message(r.centroid),
                outlines=[_polygon_message(ring) for ring in r.outlines],
                holes=[_polygon_message(ring) for ring in r.holes],
                object_ids=r.object_ids,
                frame_ids=r.frame_ids,
            )
            for r in p.regions
        ],
        edges=[
            regions_pb2.RegionEdge(a=e.a, b=e.b, width=e.width, position=vector_message(e.position))
            for e in p.edges
        ],
        fallbacks=p.fallbacks,
    )


def partition_value(m: regions_pb2.Partition) -> t.Partition:
    return t.Partition(
        map_version=m.map_version,
        revision=m.revision,
        floors=tuple(t.Floor(f.floor, f.z, f.ceiling_z or None, f.area) for f in m.floors),
        regions=tuple(
            t.Region(
                region_id=r.region_id,
                floor=r.floor,
                function=r.function,
                display_name=r.display_name,
                area=r.area,
                centroid=vector_value(r.centroid),
                outlines=tuple(_polygon_value(ring) for ring in r.outlines),
                holes=tuple(_polygon_value(ring) for ring in r.holes),
                object_ids=tuple(r.object_ids),
                frame_ids=tuple(r.frame_ids),
            )
            for r in m.regions
        ),
        edges=tuple(t.RegionEdge(e.a, e.b, e.width, vector_value(e.position)) for e in m.edges),
        fallbacks=tuple(m.fallbacks),
    )


def encode_partition(p: t.Partition) -> bytes:
    return partition_message(p).SerializeToString(deterministic=True)


def decode_partition(data: bytes) -> t.Partition:
    return partition_value(_parsed(regions_pb2.Partition, data))


def floor_grid_message(g: FloorGrid) -> regions_pb2.GetFloorGridResponse:
    return regions_pb2.GetFloorGridResponse(
        floor=g.floor,
        origin_x=g.origin[0],
        origin_y=g.origin[1],
        resolution=g.resolution,
        rows=g.occupancy.shape[0],
        columns=g.occupancy.shape[1],
        occupancy=np.ascontiguousarray(g.occupancy).tobytes(),
        regions=np.ascontiguousarray(g.regions, dtype="<u2").tobytes(),
        region_ids=g.region_ids,
        revision=g.revision,
    )


def floor_grid_value(m: regions_pb2.GetFloorGridResponse) -> FloorGrid:
    shape = (m.rows, m.columns)
    if len(m.occupancy) != m.rows * m.columns or len(m.regions) != 2 * m.rows * m.columns:
        raise Corrupt(f"floor grid: {m.rows} x {m.columns} cells do not match the bytes that came with them")
    return FloorGrid(
        floor=m.floor,
        origin=(m.origin_x, m.origin_y),
        resolution=m.resolution,
        occupancy=np.frombuffer(m.occupancy, np.uint8).reshape(shape),
        regions=np.frombuffer(m.regions, "<u2").astype(np.uint16).reshape(shape),
        region_ids=tuple(m.region_ids),
        revision=m.revision,
    )


def encode_floor_grid(g: FloorGrid) -> bytes:
    return floor_grid_message(g).SerializeToString(deterministic=True)


def decode_floor_grid(data: bytes) -> FloorGrid:
    return floor_grid_value(_parsed(regions_pb2.GetFloorGridResponse, data))


# Frames


def frame_record_message(r: a.FrameRecord) -> perception_pb2.FrameRecord:
    return perception_pb2.FrameRecord(
        frame_id=r.frame_id,
        timestamp_ns=r.timestamp_ns,
        pose=pose_message(r.world_from_camera),
        intrinsics=intrinsics_message(r.intrinsics),
        tags=r.tags,
        processed=r.processed,
        log_id=r.log_id,
    )


def frame_record_value(m: perception_pb2.FrameRecord) -> a.FrameRecord:
    return a.FrameRecord(
        frame_id=m.frame_id,
        timestamp_ns=m.timestamp_ns,
        world_from_camera=pose_value(m.pose),
        intrinsics=intrinsics_value(m.intrinsics),
        tags=tuple(m.tags),
        processed=m.processed,
        log_id=m.log_id,
    )


def perception_status_message(s: a.PerceptionStatus) -> perception_pb2.GetPerceptionStatusResponse:
    return perception_pb2.GetPerceptionStatusResponse(
        frames_durable=s.frames_durable,
        frames_processed=s.frames_processed,
        frames_skipped=s.frames_skipped,
        vocabulary=s.vocabulary,
        world_from_source=s.world_from_source.ravel().tolist(),
        backend=s.backend,
        feature_space=s.feature_space,
        detections=s.detections,
        newest_detections_id=s.newest_detections_id,
    )


def perception_status_value(m: perception_pb2.GetPerceptionStatusResponse) -> a.PerceptionStatus:
    return a.PerceptionStatus(
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


# Questions and answers


def query_message(q: a.Query) -> retrieval_pb2.FindRequest:
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


def query_value(m: retrieval_pb2.FindRequest) -> a.Query:
    return a.Query(
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


def event_message(event: a.SearchEvent) -> retrieval_pb2.FindEvent:
    match event:
        case a.TierStarted():
            return retrieval_pb2.FindEvent(tier_started=event.tier)
        case a.TierReport():
            return retrieval_pb2.FindEvent(tier_finished=tier_report_message(event))
        case a.Viewpoint():
            return retrieval_pb2.FindEvent(viewpoint=_viewpoint_message(event))
        case a.Answer():
            return retrieval_pb2.FindEvent(answer=answer_message(event))


def event_value(m: retrieval_pb2.FindEvent) -> a.SearchEvent:
    match m.WhichOneof("event"):
        case "tier_started":
            return a.TierStarted(m.tier_started)
        case "tier_finished":
            return tier_report_value(m.tier_finished)
        case "viewpoint":
            return _viewpoint_value(m.viewpoint)
        case "answer":
            return answer_value(m.answer)
        case other:
            raise Corrupt(f"search event: expected one of four kinds, got {other}")


def answer_message(answer: a.Answer) -> retrieval_pb2.Answer:
    message = retrieval_pb2.Answer(
        outcome=_OUTCOMES[answer.outcome],
        tier=answer.tier,
        path=[vector_message(p) for p in answer.path],
        tiers=[tier_report_message(r) for r in answer.tiers],
        candidates=[_candidate_message(c) for c in answer.candidates],
        rejected=[_candidate_message(c) for c in answer.rejected],
        fallbacks=answer.fallbacks,
        map_version=answer.map_version,
        regions_revision=answer.regions_revision,
        needs=answer.needs,
    )
    if answer.object:
        message.object.CopyFrom(_candidate_message(answer.object))
    if answer.goal:
        message.goal.position.CopyFrom(vector_message(answer.goal.position))
        message.goal.yaw = answer.goal.yaw
    if answer.coverage:
        message.coverage.CopyFrom(_coverage_message(answer.coverage))
    return message


def answer_value(m: retrieval_pb2.Answer) -> a.Answer:
    outcomes = {number: outcome for outcome, number in _OUTCOMES.items()}
    if m.outcome not in outcomes:
        raise Corrupt(f"answer: outcome {m.outcome} is not known")
    return a.Answer(
        outcome=outcomes[m.outcome],
        tier=m.tier,
        object=_candidate_value(m.object) if m.HasField("object") else None,
        goal=a.Goal(vector_value(m.goal.position), m.goal.yaw) if m.HasField("goal") else None,
        path=_points_value(m.path),
        tiers=tuple(tier_report_value(r) for r in m.tiers),
        candidates=tuple(_candidate_value(c) for c in m.candidates),
        rejected=tuple(_candidate_value(c) for c in m.rejected),
        fallbacks=tuple(m.fallbacks),
        map_version=m.map_version,
        regions_revision=m.regions_revision,
        coverage=_coverage_value(m.coverage) if m.HasField("coverage") else None,
        needs=m.needs,
    )


def encode_answer(answer: a.Answer) -> bytes:
    return answer_message(answer).SerializeToString(deterministic=True)


def decode_answer(data: bytes) -> a.Answer:
    return answer_value(_parsed(retrieval_pb2.Answer, data))


def tier_report_message(r: a.TierReport) -> retrieval_pb2.TierReport:
    return retrieval_pb2.TierReport(
        tier=r.tier, result=_RESULTS[r.result], why=r.why, vlm_calls=r.vlm_calls, milliseconds=r.ms
    )


def tier_report_value(m: retrieval_pb2.TierReport) -> a.TierReport:
    results = {number: result for result, number in _RESULTS.items()}
    if m.result not in results:
        raise Corrupt(f"tier report: result {m.result} is not known")
    return a.TierReport(m.tier, results[m.result], m.why, m.vlm_calls, m.milliseconds)


def _candidate_message(c: a.Candidate) -> retrieval_pb2.Candidate:
    message = retrieval_pb2.Candidate(
        object_id=c.object_id,
        label=c.label,
        position=vector_message(c.position),
        score=c.score,
        why=c.why,
        frame_id=c.frame_id,
    )
    if c.box is not None:
        message.box.CopyFrom(box_message(c.box))
    if c.box2 is not None:
        message.box2.CopyFrom(box2_message(c.box2))
    return message


def _candidate_value(m: retrieval_pb2.Candidate) -> a.Candidate:
    return a.Candidate(
        label=m.label,
        position=vector_value(m.position),
        score=m.score,
        why=m.why,
        object_id=m.object_id,
        box=box_value(m.box) if m.HasField("box") else None,
        frame_id=m.frame_id,
        box2=box2_value(m.box2) if m.HasField("box2") else None,
    )


def _viewpoint_message(v: a.Viewpoint) -> retrieval_pb2.Viewpoint:
    return retrieval_pb2.Viewpoint(
        viewpoint_id=v.viewpoint_id,
        position=vector_message(v.position),
        yaw=v.yaw,
        region_id=v.region_id,
        index=v.index,
        total=v.total,
        path=[vector_message(p) for p in v.path],
    )


def _viewpoint_value(m: retrieval_pb2.Viewpoint) -> a.Viewpoint:
    return a.Viewpoint(
        m.viewpoint_id, vector_value(m.position), m.yaw, m.region_id, m.index, m.total, _points_value(m.path)
    )


def _coverage_message(c: a.Coverage) -> retrieval_pb2.Coverage:
    return retrieval_pb2.Coverage(
        planned=c.planned,
        visited=c.visited,
        unreachable=c.unreachable,
        regions=[
            retrieval_pb2.RegionCoverage(
                region_id=r.region_id, display_name=r.display_name, area=r.area, seen=r.seen, prior=r.prior
            )
            for r in c.regions
        ],
        posterior_present=c.posterior_present,
        complete=c.complete,
    )


def _coverage_value(m: retrieval_pb2.Coverage) -> a.Coverage:
    return a.Coverage(
        m.planned,
        m.visited,
        m.unreachable,
        tuple(a.RegionCoverage(r.region_id, r.display_name, r.area, r.seen, r.prior) for r in m.regions),
        m.posterior_present,
        m.complete,
    )


def _points_value(points: Iterable[types_pb2.Vector3]) -> t.F64:
    return np.array([[p.x, p.y, p.z] for p in points], dtype=np.float64).reshape(-1, 3)


def _polygon_message(ring: t.F64) -> types_pb2.Polygon:
    return types_pb2.Polygon(xy=np.asarray(ring, np.float64).ravel().tolist())


def _polygon_value(m: types_pb2.Polygon) -> t.F64:
    return np.array(list(m.xy), dtype=np.float64).reshape(-1, 2)


def _parsed(kind: type[_Message], data: bytes) -> _Message:
    try:
        return kind.FromString(data)
    except DecodeError as error:
        raise Corrupt(f"{kind.__name__}: {len(data)} bytes do not parse") from error
