"""Which objects are one thing, looked for among the neighbours of what changed (SPEC 2.6)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.records import ObjectRecord
from services.mapper.domain.upkeep import UpkeepParams, mutual_overlap, nesting, overlap


def merge_duplicates(table: ObjectTable, changed: Iterable[str], params: UpkeepParams) -> None:
    """Changed objects, oldest first, join those that are the same thing; the senior one's id stays."""
    for object_id in sorted(changed, key=lambda name: int(name[1:])):
        record = table.get(object_id)
        while record is not None and (twin := _twin_of(table, record, params)) is not None:
            record, gone = sorted((record, twin), key=_seniority)
            table.merge(record, gone)


def _seniority(record: ObjectRecord) -> tuple[bool, int, int]:
    """Deleted and pinned before others, then what more frames saw, then the older."""
    return (not (record.deleted or record.pinned), -record.frames, record.birth)


def _twin_of(table: ObjectTable, o: ObjectRecord, params: UpkeepParams) -> ObjectRecord | None:
    """The first object that is the same thing: it may be merged, looks alike, and is in the same place."""
    box = table.box(o)
    slack = np.array([-params.reach] * 3 + [params.reach] * 3)
    others = [p for p in table.touching(box + slack) if p is not o and _may_merge(o, p, params)]
    if not others:
        return None
    cosines = np.einsum("nd,d->n", table.features(others), table.features([o])[0])
    inside, ratio = nesting(box, table.boxes(others), o.cloud.size / 2)
    nested = (inside > params.merge_inside) & (ratio > params.merge_ratio)
    for at in np.flatnonzero(cosines > params.merge_similarity):
        if _is_same(o, others[int(at)], bool(nested[at]), params):
            return others[int(at)]
    return None


def _is_same(o: ObjectRecord, p: ObjectRecord, nested: bool, params: UpkeepParams) -> bool:
    """Under one name parts may be joined; under two, only what covers much the same."""
    if o.label == p.label or not params.same_label:
        return nested or overlap(o.cloud, p.cloud, params.reach) > params.merge_overlap
    return mutual_overlap(o.cloud, p.cloud, params.reach) > params.merge_mutual


def _may_merge(o: ObjectRecord, p: ObjectRecord, params: UpkeepParams) -> bool:
    """Not against an operator's word, nor the second encoder's veto."""
    if o.object_id in p.apart or p.object_id in o.apart or (o.pinned and p.pinned):
        return False
    if o.given_label and p.given_label and o.given_label != p.given_label:
        return False
    if (o.deleted and _is_vouched_for(p)) or (p.deleted and _is_vouched_for(o)):
        return False
    if o.presence is not p.presence:
        return False
    return not _vetoed(o, p, params.merge_veto)


def _is_vouched_for(record: ObjectRecord) -> bool:
    """Whether an operator had a say in it, so that no deleted object may swallow it."""
    return bool(record.deleted or record.pinned or record.given_label)


def _vetoed(o: ObjectRecord, p: ObjectRecord, least: float) -> bool:
    a, b = o.second_sum, p.second_sum
    if not len(a) or len(a) != len(b):
        return False
    return float(a @ b) < least * float(np.linalg.norm(a) * np.linalg.norm(b))
