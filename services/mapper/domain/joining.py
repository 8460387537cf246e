"""Joining two maps of one place, built apart, by a known transform: the accumulators add (SPEC 2.7)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.boxes import pairwise_touching
from ovip.scene.types import F64, Move
from ovip.scene.voxels import pack_cells
from services.mapper.domain.association import Instances, association_scores, needs_all
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.edits import part_from_neighbours
from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.params import MapParams
from services.mapper.domain.records import ObjectRecord
from services.mapper.domain.spatial import Spatial

MOST_TILT = math.radians(3)
"""Radians by which two verticals may differ: both worlds have z up, and boxes are upright."""

_RIGID = 1e-4
_STEPS = 256  # as a cloud's tally counts places in a voxel


def join_maps(
    table: ObjectTable, other: ObjectTable, world_from_other: F64, params: MapParams, batches: int
) -> dict[str, str]:
    """Takes all objects of `other` into `table`, as if seen after its own; the id here of each id and alias there.

    The other's objects are associated as detections are, by the same score, but one to one, best pairs first; the rest
    get new ids. batches: this map's own so far. InvalidInput, and nothing changed, where the two cannot be one map.
    """
    pose = upright(world_from_other, "world_from_other")
    if other is table:
        raise InvalidInput("other: a map cannot be joined with itself")
    if None not in (table.dimension, other.dimension) and table.dimension != other.dimension:
        raise InvalidInput(
            f"other: expected features of {table.dimension} numbers like this map's, got {other.dimension}"
        )
    arriving = [_arrival(record, pose, params.voxel, batches, table.changes.version) for record in other]
    sums = [other.feature_sum(record) for record in other]
    partners = _partners(table, other, arriving, params)
    ids = {}
    for record, feature_sum, partner in zip(arriving, sums, partners, strict=True):
        there = record.object_id
        if partner is None:
            record.object_id = table.new_id()
            table.add(record, feature_sum)
        else:
            moves = sorted((*partner.moves, *record.moves), key=lambda move: move.timestamp_ns)
            table.absorb(partner, record, feature_sum, partner.cloud.merged(record.cloud))
            partner.moves = tuple(moves)
        ids[there] = (partner or record).object_id
    _keep_apart(table, other, ids, params)
    return ids | {name: ids[there] for name in other.aliases if (there := other.resolve(name)) in ids}


def upright(pose: F64, name: str) -> F64:
    """A rigid `(4, 4)` that keeps z up; InvalidInput, which calls it `name`, where it is none."""
    pose = np.asarray(pose, np.float64)
    if pose.shape != (4, 4) or not np.isfinite(pose).all():
        raise InvalidInput(f"{name}: expected a 4x4 transform of finite numbers")
    turn = pose[:3, :3]
    rigid = np.allclose(turn @ turn.T, np.eye(3), atol=_RIGID) and np.linalg.det(turn) > 0
    if not rigid or not np.allclose(pose[3], [0, 0, 0, 1], atol=_RIGID):
        raise InvalidInput(f"{name}: expected a rigid transform, a rotation and a shift")
    if (tilt := tilt_of(pose)) > MOST_TILT:
        raise InvalidInput(f"{name}: expected z to stay up, it tilts by {math.degrees(tilt):.1f} degrees")
    return pose


def tilt_of(pose: F64) -> float:
    """Radians between z and where a rigid `(4, 4)` takes it."""
    return math.atan2(math.hypot(pose[0, 2], pose[1, 2]), pose[2, 2])


def moved_cloud(cloud: VoxelCloud, pose: F64, size: float) -> VoxelCloud:
    """The cloud moved by a rigid `(4, 4)`: each voxel's mean point, with its count, binned anew.

    Where nothing moves and the voxels are the same, the same cloud to the bit.
    """
    if cloud.size == size and np.array_equal(pose, np.eye(4)):
        return cloud
    level = cloud.level if cloud.size == size else 0
    edge = size * (1 << level)
    scaled = (cloud.means @ pose[:3, :3].T + pose[:3, 3]) / edge
    cells = np.floor(scaled).astype(np.int64)
    keys = pack_cells(cells)
    tally = cloud.tally.astype(np.int64)
    # a place counts in steps cut off, on average half a step too low
    tally[:, 1:4] = np.rint(((scaled - cells) * (_STEPS << level) - 0.5) * tally[:, :1]).clip(0)
    order = np.argsort(keys, kind="stable")
    starts = np.flatnonzero(np.concatenate([[True], np.diff(keys[order]) != 0]))
    summed = np.add.reduceat(tally[order], starts, axis=0).astype(np.int32)
    return VoxelCloud(keys[order][starts], summed, size, level).bounded()


def _arrival(record: ObjectRecord, pose: F64, size: float, batches: int, version: int) -> ObjectRecord:
    """The object as this map would hold it, still under its id there."""
    moves = tuple(Move(move.timestamp_ns, pose[:3, :3] @ move.origin + pose[:3, 3]) for move in record.moves)
    return dataclasses.replace(
        record,
        cloud=moved_cloud(record.cloud, pose, size),
        label_counts=dict(record.label_counts),
        last_batch=batches + record.last_batch,
        deleted=version if record.deleted else 0,
        second_sum=record.second_sum.copy(),
        apart=frozenset(),
        evidence=None,
        moves=moves,
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


def _partners(
    table: ObjectTable, other: ObjectTable, arriving: list[ObjectRecord], params: MapParams
) -> list[ObjectRecord | None]:
    """The object here that each arriving one is: pairs that score above tau, best first, nobody twice.

    Ties go to the older here, then there.
    """
    partners: list[ObjectRecord | None] = [None] * len(arriving)
    if not arriving or not len(table):
        return partners
    clouds = params.association.spatial is Spatial.OVERLAP
    boxes = np.stack([record.cloud.box for record in arriving])
    here = list(table) if needs_all(params.association) else table.near_any(boxes)
    if not here:
        return partners
    seen = Instances(
        boxes,
        other.features(list(other)),
        [record.mode for record in arriving],
        [record.cloud.points for record in arriving] if clouds else (),
    )
    scores = association_scores(seen, table.instances(here, clouds), params.association)
    allowed = np.array([[_may_be_one(a, h) for h in here] for a in arriving])
    if not needs_all(params.association):
        allowed &= pairwise_touching(boxes, table.boxes(here))
    i, j = np.nonzero(allowed & (scores > params.association.tau))
    taken: set[int] = set()
    for at in np.lexsort((i, j, -scores[i, j])):
        a, h = int(i[at]), int(j[at])
        if partners[a] is None and h not in taken:
            partners[a] = here[h]
            taken.add(h)
    return partners


def _may_be_one(arriving: ObjectRecord, here: ObjectRecord) -> bool:
    """What an operator deleted here swallows what arrives; what one deleted there swallows nothing here."""
    if arriving.deleted:
        return bool(here.deleted)
    if here.deleted:
        return not (arriving.pinned or arriving.given_label)
    return arriving.presence is here.presence


def _keep_apart(table: ObjectTable, other: ObjectTable, ids: dict[str, str], params: MapParams) -> None:
    """What operators said of the other's objects holds for what they are here."""
    for record in other:
        mine = table.get(ids[record.object_id])
        assert mine is not None
        for name in sorted(record.apart):
            if name in ids and (partner := table.get(ids[name])) is not None:
                table.part(mine, partner)
        if mine.deleted and mine.object_id in table.changes.created:
            table.changes.created.discard(mine.object_id)
            part_from_neighbours(table, mine, params)
