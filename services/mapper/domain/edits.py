"""Operators' edits of the objects (SPEC 2.6): checked before anything changes, and kept by all that comes later."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.spatial import cKDTree

from ovip.errors import Conflict, InvalidInput, NotFound
from ovip.scene.edits import Delete, EditRequest, Merge, Pin, Rename, Split
from ovip.scene.types import F64, Bools, Presence
from ovip.scene.words import normalize_word
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.params import MapParams
from services.mapper.domain.records import ObjectRecord
from services.mapper.domain.relations import reach

_LONGEST_LABEL = 200


def apply_edit(table: ObjectTable, request: EditRequest, params: MapParams) -> None:
    """Does what the operator asks, on the objects as they are now.

    InvalidInput where it asks for what cannot be, NotFound for an id that the map never gave, Conflict where an object
    concerned became another (born, renamed, merged, split, moved, given up, edited) after `made_on_version`.
    """
    latest = table.changes.version - 1
    if not 0 < request.made_on_version <= latest:
        raise InvalidInput(
            f"made_on_version: expected a version of the map, 1 to {latest}, got {request.made_on_version}"
        )
    edit, made_on = request.edit, request.made_on_version
    match edit:
        case Rename():
            _rename(table, _current(table, edit.object_id, made_on), _label(edit.label))
        case Merge():
            _merge(table, edit, made_on)
        case Split():
            _split(table, _current(table, edit.object_id, made_on), edit)
        case Delete():
            _delete(table, _current(table, edit.object_id, made_on), params)
        case Pin():
            _pin(table, _current(table, edit.object_id, made_on), edit.pinned)


def own_part(table: ObjectTable, record: ObjectRecord, cloud: VoxelCloud) -> VoxelCloud | None:
    """What of a new view's cloud is the object's and not that of a thing an operator parted it from; None: nothing.

    A detector that took two things for one goes on doing so. Each voxel is that one's whose cloud it is nearest to.
    """
    others = [r for name in sorted(record.apart) if (r := table.get(name)) is not None and not r.deleted]
    if record.deleted or not others:
        return cloud
    means = cloud.means
    box = np.concatenate([means.min(axis=0), means.max(axis=0)])
    near = [o for o in others if (table.box(o)[:3] <= box[3:]).all() and (table.box(o)[3:] >= box[:3]).all()]
    if not near:
        return cloud
    to_own = cKDTree(record.cloud.means).query(means)[0]
    to_others = cKDTree(np.concatenate([o.cloud.means for o in near])).query(means)[0]
    mine: Bools = to_own <= to_others
    return cloud.kept(mine) if mine.any() else None


def part_from_neighbours(table: ObjectTable, hidden: ObjectRecord, params: MapParams) -> None:
    """What readers saw beside a deleted object is another thing: it will not be taken for it and hidden, too."""
    for other in table.near(table.box(hidden)):
        seen = other.is_confirmed(params.upkeep.confirm_frames)
        if other is not hidden and not other.deleted and seen:
            table.part(hidden, other)


def _current(table: ObjectTable, object_id: str, made_on: int) -> ObjectRecord:
    """The object that an operator who saw version `made_on` means."""
    known = table.resolve(object_id)
    record, name = table.get(known), object_id[:80]
    if record is None:
        if not _was_given(table, object_id):
            raise NotFound(f"object {name!r} is not in the map")
        raise Conflict(f"object {name} was given up as noise since version {made_on}; read the map again")
    if record.deleted:
        say = f"object {name} was deleted by an operator at version {record.deleted}"
        raise Conflict(f"{say}, after version {made_on}") if record.deleted > made_on else NotFound(say)
    if record.revision > made_on:
        became = f"merged into {known}" if known != object_id else "changed"
        raise Conflict(
            f"object {name} was {became} at version {record.revision} or before, after version {made_on}; "
            "read it again"
        )
    return record


def _was_given(table: ObjectTable, object_id: str) -> bool:
    """Whether the map once gave this id."""
    number = object_id[1:]
    if len(number) > 18 or not (number.isascii() and number.isdigit()):
        return False
    return object_id == f"o{int(number):06d}" and 0 < int(number) <= table.born


def _label(text: str) -> str:
    """As detections are called; empty where the operator leaves it empty."""
    if len(text) > _LONGEST_LABEL:
        raise InvalidInput(f"label: expected at most {_LONGEST_LABEL} characters, got {len(text)}")
    label = normalize_word(text)
    if text.strip() and not label:
        raise InvalidInput(f"label: expected a word, got {text!r}")
    return label


def _rename(table: ObjectTable, record: ObjectRecord, label: str) -> None:
    """C_j goes on underneath: detections associate by mode(C_j) whatever the operator calls it."""
    record.given_label = label
    table.revise(record)


def _merge(table: ObjectTable, edit: Merge, made_on: int) -> None:
    if not edit.merged_ids:
        raise InvalidInput("merged_ids: expected at least one object to merge")
    keep = _current(table, edit.keep_id, made_on)
    named = [_current(table, object_id, made_on) for object_id in edit.merged_ids]
    merged = list({record.object_id: record for record in named}.values())
    for record in merged:
        if record is keep:
            raise InvalidInput(f"object {keep.object_id} cannot be merged with itself")
        if record.pinned:
            raise Conflict(f"object {record.object_id} is pinned: unpin it first, or keep its id")
    for record in merged:
        table.unpart(keep, record)
        table.merge(keep, record)


def _split(table: ObjectTable, record: ObjectRecord, edit: Split) -> None:
    box = np.asarray(edit.part, np.float64)
    if box.shape != (6,) or not np.isfinite(box).all() or not (box[:3] < box[3:]).all():
        raise InvalidInput("part: expected a box of six finite numbers, low corner below high corner")
    label, means = _label(edit.part_label), record.cloud.means
    inside = np.asarray(((means >= box[:3]) & (means <= box[3:])).all(axis=1), np.bool_)
    if not inside.any() or inside.all():
        held = "all" if inside.any() else "none"
        raise InvalidInput(f"part: expected some of object {record.object_id}, the box holds {held} of it")
    part = _parted(table, record, inside, label)
    table.part(record, part)


def _parted(table: ObjectTable, record: ObjectRecord, inside: Bools, label: str) -> ObjectRecord:
    """The voxels `inside` as a new object; the sums shared by voxels, the frames that saw the one saw both."""
    share = float(inside.mean())
    whole = table.feature_sum(record)
    part = dataclasses.replace(
        record,
        object_id=table.new_id(),
        cloud=record.cloud.kept(inside),
        view_weight=record.view_weight * share,
        label_counts={name: _shared(count, share) for name, count in record.label_counts.items()},
        observations=_shared(record.observations, share),
        second_sum=record.second_sum * share,
        given_label=label or record.given_label,
        pinned=False,
        evidence=None,
        moves=(),
        relations=(),
        settled=None,
        related=None,
        watched=0,
        slot=-1,
        read=None,
        digest=b"",
        fresh=None,
        body=None,
    )
    record.view_weight *= 1 - share
    record.label_counts = {name: _shared(n, 1 - share) for name, n in record.label_counts.items()}
    record.observations = _shared(record.observations, 1 - share)
    record.second_sum = record.second_sum * (1 - share)
    record.evidence, record.settled, record.related, record.watched = None, None, None, 0
    record.recount()
    table.set_feature_sum(record, whole * (1 - share))
    table.set_cloud(record, record.cloud.kept(~inside))
    table.revise(record)
    for name in sorted(record.apart):
        if (other := table.get(name)) is not None:
            other.apart |= {part.object_id}
            table.touch(other, seen=False)
    table.add(part, whole * share)
    return part


def _shared(count: int, share: float) -> int:
    return max(1, round(count * share))


def _delete(table: ObjectTable, record: ObjectRecord, params: MapParams) -> None:
    """It stays in the table, unseen, so that what is detected there again joins it and not a new object."""
    record.deleted = table.changes.version
    record.presence, record.evidence, record.relations = Presence.PRESENT, None, ()
    record.pinned = False
    part_from_neighbours(table, record, params)
    table.revise(record)
    table.changes.removed.add(record.object_id)
    _forget_relations(table, record, reach(params.relations))


def _forget_relations(table: ObjectTable, gone: ObjectRecord, within: float) -> None:
    around: F64 = table.box(gone) + np.array([-within] * 3 + [within] * 3)
    for other in table.near(around):
        kept = tuple(r for r in other.relations if r.other_id != gone.object_id)
        if kept != other.relations:
            other.relations = kept
            table.touch(other)


def _pin(table: ObjectTable, record: ObjectRecord, pinned: bool) -> None:
    """Who pins what was given up says that it is there."""
    record.pinned = pinned
    if pinned and record.presence is not Presence.PRESENT:
        record.presence, record.evidence = Presence.PRESENT, None
        table.changes.returned.add(record.object_id)
    table.revise(record)
