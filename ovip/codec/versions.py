"""A map across its versions and across scenes: deltas, differences, proofs, alignments."""

from __future__ import annotations

import dataclasses

import numpy as np

from ovip.codec.geometry import matrix_numbers, matrix_value
from ovip.codec.objects import object_message, object_value
from ovip.codec.reading import member, parsed
from ovip.scene.types import MapDelta, MapObject, StepKind
from ovip.scene.versions import Alignment, MapDiff, ObjectChange, Verification
from ovip.v1 import mapper_pb2, types_pb2

_STEP_NUMBERS = {
    StepKind.FRAME: mapper_pb2.STEP_KIND_FRAME,
    StepKind.UPKEEP: mapper_pb2.STEP_KIND_UPKEEP,
    StepKind.EDIT: mapper_pb2.STEP_KIND_EDIT,
    StepKind.JOIN: mapper_pb2.STEP_KIND_JOIN,
    StepKind.SETTINGS: mapper_pb2.STEP_KIND_SETTINGS,
}
_STEPS: dict[int, StepKind] = {
    mapper_pb2.STEP_KIND_UNSPECIFIED: StepKind.FRAME,  # deltas from when frames alone made versions
    **{number: kind for kind, number in _STEP_NUMBERS.items()},
}
_NO_FEATURE = np.zeros(0, np.float32)


def delta_message(delta: MapDelta) -> mapper_pb2.MapDelta:
    return mapper_pb2.MapDelta(
        version=delta.version,
        frame_id=delta.frame_id,
        created=delta.created,
        updated=delta.updated,
        removed=delta.removed,
        aliases=delta.aliases,
        kind=_STEP_NUMBERS[delta.kind],
        departed=delta.departed,
        returned=delta.returned,
        moved=delta.moved,
    )


def delta_value(m: mapper_pb2.MapDelta) -> MapDelta:
    return MapDelta(
        version=m.version,
        frame_id=m.frame_id,
        kind=member(_STEPS, m.kind, f"map version {m.version}: step kind"),
        created=tuple(m.created),
        updated=tuple(m.updated),
        removed=tuple(m.removed),
        aliases=dict(m.aliases),
        departed=tuple(m.departed),
        returned=tuple(m.returned),
        moved=tuple(m.moved),
    )


def encode_delta(delta: MapDelta) -> bytes:
    return delta_message(delta).SerializeToString(deterministic=True)


def decode_delta(data: bytes) -> MapDelta:
    return delta_value(parsed(mapper_pb2.MapDelta, data))


def diff_message(diff: MapDiff) -> mapper_pb2.DiffMapResponse:
    """Without the objects' features, which would be most of it: `fields` says where they differ."""
    return mapper_pb2.DiffMapResponse(
        from_version=diff.from_version,
        to_version=diff.to_version,
        changes=[
            mapper_pb2.ObjectChange(
                object_id=change.object_id,
                before=_featureless(change.before),
                after=_featureless(change.after),
                fields=change.fields,
                merged_into=change.merged_into,
            )
            for change in diff.changes
        ],
    )


def diff_value(m: mapper_pb2.DiffMapResponse) -> MapDiff:
    """Its objects have empty features."""
    return MapDiff(
        m.from_version,
        m.to_version,
        tuple(
            ObjectChange(
                object_id=change.object_id,
                before=object_value(change.before) if change.HasField("before") else None,
                after=object_value(change.after) if change.HasField("after") else None,
                fields=tuple(change.fields),
                merged_into=change.merged_into,
            )
            for change in m.changes
        ),
    )


def verification_message(v: Verification) -> mapper_pb2.VerifyMapResponse:
    return mapper_pb2.VerifyMapResponse(
        version=v.version,
        state_hash=v.state_hash,
        rebuilt_hash=v.rebuilt_hash,
        snapshots=v.snapshots,
        differing_versions=v.differing_versions,
        steps=v.steps,
    )


def verification_value(m: mapper_pb2.VerifyMapResponse) -> Verification:
    return Verification(
        version=m.version,
        state_hash=m.state_hash,
        rebuilt_hash=m.rebuilt_hash,
        snapshots=m.snapshots,
        differing_versions=tuple(m.differing_versions),
        steps=m.steps,
    )


def alignment_message(a: Alignment) -> mapper_pb2.AlignMapResponse:
    return mapper_pb2.AlignMapResponse(
        world_from_other=matrix_numbers(a.world_from_other), overlap=a.overlap, rmse=a.rmse
    )


def alignment_value(m: mapper_pb2.AlignMapResponse) -> Alignment:
    return Alignment(matrix_value(m.world_from_other, "world_from_other"), m.overlap, m.rmse)


def _featureless(o: MapObject | None) -> types_pb2.MapObject | None:
    return None if o is None else object_message(dataclasses.replace(o, feature=_NO_FEATURE))
