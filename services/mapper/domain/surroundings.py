"""Objects among what surrounds them: what later views say of their presence, and how they stand to their neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.scene.types import F64, DetectionBatch, Move, Presence, Relation
from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.params import MapParams
from services.mapper.domain.presence import (
    Evidence,
    Looks,
    View,
    frustum_box,
    matching_departed,
    sight,
)
from services.mapper.domain.records import ObjectRecord
from services.mapper.domain.relations import Body, reach, relations_of

_WATCHED_GROWTH = 1.25  # of a cloud, after which other places of it are watched


def watch(table: ObjectTable, batch: DetectionBatch, seen: set[str], params: MapParams) -> None:
    """What the frame says of objects it might have seen and did not detect; what it detected is there (SPEC 2.8)."""
    if batch.late:
        return  # an earlier moment's: it says nothing of now
    for object_id in seen:
        _is_there(table, object_id)
    view = View(batch.nearest, batch.intrinsics, batch.world_from_camera)
    if not batch.nearest.size or (box := frustum_box(view, params.presence)) is None:
        return
    unseen = [r for r in table.near(box) if r.object_id not in seen and _is_watched(r, params)]
    if not unseen:
        return
    evidence = [_evidence_of(table, record) for record in unseen]
    sizes = [len(e.points) for e in evidence]
    owners = np.repeat(np.arange(len(evidence)), sizes)
    said = sight(np.concatenate([e.points for e in evidence]), owners, view, params.presence)
    ends = np.cumsum(sizes)[:-1]
    for record, before, part in zip(unseen, evidence, np.split(said, ends), strict=True):
        after = before.seen(part)
        if after is not before:
            record.evidence = after
            table.touch(record, seen=False)
            if record.evidence.departed(params.presence):
                record.presence = Presence.MOVED_OR_REMOVED
                table.changes.departed.add(record.object_id)
                table.unsettle(record)
                table.revise(record)


def recognise_moves(table: ObjectTable, params: MapParams) -> None:
    """A thing given up that turned up elsewhere goes on there under its own id."""
    departed = [r for r in table if r.presence is not Presence.PRESENT and not r.deleted]
    if not departed:
        return
    labels, since = {r.mode for r in departed}, min(r.last_seen_ns for r in departed)
    present = [r for r in table if r.presence is Presence.PRESENT and r.mode in labels and not r.deleted]
    for candidate in [r for r in present if r.first_seen_ns > since and _may_have_moved(r, params)]:
        others = [r for r in present if r is not candidate and r.last_seen_ns > since]
        found = matching_departed(
            _looks(table, [candidate]), _looks(table, departed), _looks(table, others), params.presence
        )
        if found is None or departed[found].object_id in candidate.apart:
            continue
        record = departed.pop(found)
        table.unsettle(record)  # where it was, too
        move = Move(candidate.first_seen_ns, record.cloud.mean[:3])
        table.merge(record, candidate, candidate.cloud)
        record.moves = (*record.moves, move)
        record.presence = Presence.PRESENT
        table.changes.moved.add(record.object_id)
        present[present.index(candidate)] = record
        if not departed:
            return


def relate(table: ObjectTable, changed: Sequence[ObjectRecord], params: MapParams) -> None:
    """Relations of changed objects, and of those around what is new of them, measured anew (SPEC 2.9)."""
    stale = {r.object_id: r for r in changed}
    for record in changed:
        fresh = table.box(record) if record.fresh is None else record.fresh
        stale |= {r.object_id: r for r in _around(table, record, fresh, params)}
    for record in sorted(stale.values(), key=lambda r: r.birth):
        relations: tuple[Relation, ...] = ()
        if _is_related(record, params):
            others = [_body(table, r) for r in _around(table, record, table.box(record), params)]
            relations = relations_of(_body(table, record), others, params.relations)
        if relations != record.relations:
            record.relations = relations
            table.touch(record)


def _body(table: ObjectTable, record: ObjectRecord) -> Body:
    if record.body is None:
        record.body = Body(record.object_id, record.label, table.box(record), record.cloud.points)
    return record.body


def _around(table: ObjectTable, record: ObjectRecord, box: F64, params: MapParams) -> list[ObjectRecord]:
    """What may stand in a relation to what of it lies in a box `(6,)`."""
    far = reach(params.relations)
    near = table.touching(box + np.array([-far] * 3 + [far] * 3))
    return [r for r in near if r is not record and _is_related(r, params)]


def _is_there(table: ObjectTable, object_id: str) -> None:
    record = table.get(object_id)
    if record is None:
        return
    if record.evidence is not None:
        record.evidence = record.evidence.cleared()
    if record.presence is not Presence.PRESENT:
        record.presence = Presence.PRESENT
        table.changes.returned.add(object_id)
        table.unsettle(record)
        table.revise(record)


def _is_watched(record: ObjectRecord, params: MapParams) -> bool:
    if record.pinned or record.deleted or record.presence is not Presence.PRESENT:
        return False
    return record.is_confirmed(params.upkeep.confirm_frames)


def _may_have_moved(record: ObjectRecord, params: MapParams) -> bool:
    """A pinned object keeps its own id."""
    return record.is_confirmed(params.upkeep.confirm_frames) and not record.pinned


def _is_related(record: ObjectRecord, params: MapParams) -> bool:
    if record.deleted or record.presence is not Presence.PRESENT:
        return False
    return record.is_confirmed(params.upkeep.confirm_frames)


def _evidence_of(table: ObjectTable, record: ObjectRecord) -> Evidence:
    """What is watched of the object: chosen anew when it has grown much."""
    known, voxels = record.evidence, len(record.cloud)
    if known and record.watched / _WATCHED_GROWTH <= voxels <= record.watched * _WATCHED_GROWTH:
        return known
    points = record.cloud.points
    made = known.renewed(points) if known else Evidence.of(points)
    record.evidence, record.watched = made, voxels
    table.touch(record, seen=False)
    return made


def _looks(table: ObjectTable, records: Sequence[ObjectRecord]) -> Looks:
    return Looks(
        features=table.features(records).astype(np.float32),
        labels=[r.mode for r in records],
        first_seen_ns=np.array([r.first_seen_ns for r in records], np.int64),
        last_seen_ns=np.array([r.last_seen_ns for r in records], np.int64),
    )
