"""Mapped objects, and whole maps in parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ovip.codec.arrays import floats, floats_value
from ovip.codec.geometry import (
    box2_message,
    box2_value,
    box_message,
    box_value,
    vector_message,
    vector_value,
)
from ovip.codec.reading import member
from ovip.errors import Corrupt
from ovip.scene.types import MapObject, Move, Presence, Relation, RelationKind, SceneMap
from ovip.v1 import mapper_pb2, types_pb2

PART_BYTES = 1_000_000
"""About how much of a map travels in one message."""

_PRESENCE_NUMBERS = {
    Presence.PRESENT: types_pb2.PRESENCE_PRESENT,
    Presence.MOVED_OR_REMOVED: types_pb2.PRESENCE_MOVED_OR_REMOVED,
}
_PRESENCES: dict[int, Presence] = {
    types_pb2.PRESENCE_UNSPECIFIED: Presence.PRESENT,  # messages from before there was a presence
    **{number: presence for presence, number in _PRESENCE_NUMBERS.items()},
}
_RELATION_NUMBERS = {
    RelationKind.ON: types_pb2.Relation.KIND_ON,
    RelationKind.IN: types_pb2.Relation.KIND_IN,
    RelationKind.NEXT_TO: types_pb2.Relation.KIND_NEXT_TO,
    RelationKind.ATTACHED_TO: types_pb2.Relation.KIND_ATTACHED_TO,
}
_RELATIONS: dict[int, RelationKind] = {number: kind for kind, number in _RELATION_NUMBERS.items()}


def object_message(o: MapObject) -> types_pb2.MapObject:
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
        revision=o.revision,
        presence=_PRESENCE_NUMBERS[o.presence],
        pinned=o.pinned,
        label_given=o.label_given,
        relations=[_relation_message(r) for r in o.relations],
        moves=[
            types_pb2.Move(timestamp_ns=move.timestamp_ns, origin=vector_message(move.origin))
            for move in o.moves
        ],
    )


def object_value(m: types_pb2.MapObject) -> MapObject:
    return MapObject(
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
        revision=m.revision,
        presence=member(_PRESENCES, m.presence, f"object {m.object_id}: presence"),
        pinned=m.pinned,
        label_given=m.label_given,
        relations=tuple(_relation_value(r, m.object_id) for r in m.relations),
        moves=tuple(Move(move.timestamp_ns, vector_value(move.origin)) for move in m.moves),
    )


def map_parts(scene_map: SceneMap, part_bytes: int = PART_BYTES) -> Iterator[mapper_pb2.GetMapResponse]:
    """The map as messages of about `part_bytes` at most, each with the header; one at least, each with one object."""
    part, room = _header(scene_map), part_bytes
    for o in scene_map.objects:
        message = object_message(o)
        size = message.ByteSize()
        if part.objects and size > room:
            yield part
            part, room = _header(scene_map), part_bytes
        part.objects.append(message)
        room -= size
    yield part


def map_value(parts: Iterable[mapper_pb2.GetMapResponse]) -> SceneMap:
    """The map that the parts make; Corrupt where there is none, or where they are parts of different maps."""
    parts = list(parts)
    if not parts:
        raise Corrupt("map: the stream ended before its first part")
    heads = {(p.scene, p.version, p.state_hash) for p in parts}
    if len(heads) > 1:
        versions = ", ".join(str(version) for version in sorted({p.version for p in parts}))
        raise Corrupt(
            f"map: expected parts of one version, got parts of {len(heads)} maps (version {versions})"
        )
    head = parts[0]
    return SceneMap(
        scene=head.scene,
        version=head.version,
        objects=tuple(object_value(o) for part in parts for o in part.objects),
        state_hash=head.state_hash,
        frames=head.frames,
        detections=head.detections,
        applied_log_id=head.applied_log_id,
    )


def _header(scene_map: SceneMap) -> mapper_pb2.GetMapResponse:
    return mapper_pb2.GetMapResponse(
        scene=scene_map.scene,
        version=scene_map.version,
        state_hash=scene_map.state_hash,
        frames=scene_map.frames,
        detections=scene_map.detections,
        applied_log_id=scene_map.applied_log_id,
    )


def _relation_message(r: Relation) -> types_pb2.Relation:
    return types_pb2.Relation(kind=_RELATION_NUMBERS[r.kind], other_id=r.other_id, evidence=r.evidence)


def _relation_value(m: types_pb2.Relation, object_id: str) -> Relation:
    kind = member(_RELATIONS, m.kind, f"object {object_id}: relation")
    return Relation(kind, m.other_id, dict(m.evidence))
