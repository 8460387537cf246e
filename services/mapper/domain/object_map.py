"""The object map: one state, each verb one version. The same steps in the same order give the same map to the bit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.edits import EditRequest
from ovip.scene.types import (
    F32,
    F64,
    U8,
    Detection,
    DetectionBatch,
    MapDelta,
    MapObject,
    Presence,
    StepKind,
)
from services.mapper.domain.association import NEW, Instances, associate, needs_all
from services.mapper.domain.cloud import clouds_of
from services.mapper.domain.duplicates import merge_duplicates
from services.mapper.domain.edits import apply_edit, own_part
from services.mapper.domain.fusion import fusion_weight
from services.mapper.domain.joining import join_maps
from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.params import MapParams
from services.mapper.domain.records import Changes, Extent, ObjectRecord, added, remembered
from services.mapper.domain.snapshot import Head, read_segments, record_digest, write_head, write_segment
from services.mapper.domain.spatial import Spatial
from services.mapper.domain.surroundings import recognise_moves, relate, watch
from services.mapper.domain.upkeep import denoised

_CLEAN = 0.05, 0.01  # a share of its cloud's voxels, and metres of its box: what changed less is clean still,
_RELATED = 0.1, 0.02  # and stands to others as it did


class ObjectMap:
    """The objects of one scene.

    Objects seen in fewer than `confirm_frames` frames are kept but not shown; ids are given in order of birth and
    never reused; an id merged away stays as an alias of its survivor.
    """

    def __init__(self, params: MapParams | None = None) -> None:
        self.params = params or MapParams()
        self.version = 0
        self.frames = 0
        self.detections = 0
        self.batches = 0
        self.upkept_batches = 0
        self.table = ObjectTable()

    # Verbs: each makes one version

    def integrate(self, batch: DetectionBatch) -> MapDelta:
        """Associates and fuses one frame's detections, and looks what the frame saw through.

        InvalidInput, and nothing changed, where a detection cannot be the map's.
        """
        self._check(batch)
        changes = self._begin()
        self.batches += 1
        self.frames += not batch.late
        self.detections += len(batch.detections)
        seen = self._fuse(batch, self._associated(batch.detections)) if batch.detections else set()
        watch(self.table, batch, seen, self.params)
        if self.params.upkeep.eager:
            merge_duplicates(self.table, seen & self.table.dirty, self.params.upkeep)
        return changes.delta(StepKind.FRAME, batch.frame_id)

    @property
    def batches_since_upkeep(self) -> int:
        """Batches integrated since the last upkeep."""
        return self.batches - self.upkept_batches

    @property
    def upkeep_due(self) -> bool:
        """Whether `upkeep.every` batches came since the last upkeep."""
        return self.batches_since_upkeep >= self.params.upkeep.every

    @property
    def changed_since_upkeep(self) -> bool:
        """Whether upkeep would find anything to look at."""
        return bool(self.table.dirty)

    def upkeep(self) -> MapDelta:
        """Denoises what changed since the last upkeep, merges duplicates, drops noise, relates (SPEC 2.6, 2.8, 2.9)."""
        changes, table = self._begin(), self.table
        self.upkept_batches = self.batches
        self._denoise([r for r in self._changed() if self._outgrew(r, r.settled, *_CLEAN)])
        merge_duplicates(table, table.dirty, self.params.upkeep)
        self._forget_noise()
        recognise_moves(table, self.params)
        self._relate([r for r in self._changed() if self._outgrew(r, r.related, *_RELATED)])
        table.dirty.clear()
        return changes.delta(StepKind.UPKEEP)

    def edit(self, request: EditRequest) -> MapDelta:
        """An operator's edit. Conflict, NotFound or InvalidInput, and nothing changed, where it cannot be."""
        changes = self._begin()
        try:
            apply_edit(self.table, request, self.params)
        except BaseException:
            self.version -= 1
            raise
        return changes.delta(StepKind.EDIT)

    def join(self, other: ObjectMap, world_from_other: F64) -> tuple[MapDelta, dict[str, str]]:
        """All objects of another map, moved by a rigid `(4, 4)`; also says which of its ids became which (SPEC 2.7).

        InvalidInput, and nothing changed, where the two cannot be one map.
        """
        changes = self._begin()
        try:
            ids = join_maps(self.table, other.table, world_from_other, self.params, self.batches)
        except BaseException:
            self.version -= 1
            raise
        self.frames += other.frames
        self.detections += other.detections
        self.batches += other.batches
        return changes.delta(StepKind.JOIN), ids

    def adopt(self, params: MapParams) -> MapDelta:
        """From this version on other settings hold."""
        changes = self._begin()
        self.params = params
        self.table.reconsider()
        return changes.delta(StepKind.SETTINGS)

    # Reading

    def objects(
        self, include_unconfirmed: bool = False, include_departed: bool = False
    ) -> tuple[MapObject, ...]:
        """The objects in order of birth, as readers see them."""
        return tuple(
            self._as_read(r) for r in self.table if self._is_shown(r, include_unconfirmed, include_departed)
        )

    def shows(self, object_id: str) -> bool:
        """Whether the object of this very id is among `objects()`."""
        record = self.table.get(object_id)
        return record is not None and self._is_shown(record)

    def find(self, object_id: str) -> MapObject | None:
        """One object by its id or by an id merged into it."""
        record = self._record(object_id)
        return self._as_read(record) if record else None

    def deleted_at(self, object_id: str) -> int:
        """The version at which an operator deleted the object of this id or alias; 0 where none did."""
        record = self.table.get(self.table.resolve(object_id))
        return record.deleted if record else 0

    def resolve(self, object_id: str) -> str:
        """The id that an alias stands for now; an id itself where it is none."""
        return self.table.resolve(object_id)

    def cloud_of(self, object_id: str) -> tuple[F32, U8] | None:
        """Points `(V, 3)` and colours `(V, 3)` of an object."""
        record = self._record(object_id)
        return (record.cloud.points, record.cloud.colors) if record else None

    @property
    def aliases(self) -> dict[str, str]:
        """Ids merged away -> what they were merged into."""
        return self.table.aliases

    @property
    def nbytes(self) -> int:
        """Bytes of the objects' arrays."""
        row = 8 * (self.table.dimension or 0) + 48
        return sum(r.cloud.nbytes + r.second_sum.nbytes + row for r in self.table)

    def state_hash(self) -> str:
        """SHA-256 over the whole state: equal hashes, equal maps. Costs what changed since it was last asked."""
        digest = hashlib.sha256(write_head(self._head(since=0)))
        for record in self.table:
            record.digest = record.digest or record_digest(self.table, record)
            digest.update(record.digest)
        return digest.hexdigest()

    def segment(self, since: int = 0) -> bytes:
        """What changed above version `since`, as bytes, the same for the same state; from 0, everything.

        Segments come in order: what went at or below `since` is not told again.
        """
        self.table.gone = [(version, name) for version, name in self.table.gone if version > since]
        records = [r for r in self.table if r.touched > since or not since]
        return write_segment(self.table, self._head(since), records)

    @classmethod
    def restore(cls, segments: Sequence[bytes], params: MapParams | None = None) -> ObjectMap:
        """The map that segments, in order, wrote down; its own settings unless others are given.

        InvalidInput for another format, Corrupt where bytes are missing.
        """
        head, table = read_segments(segments)
        restored = cls(params or head.params)
        restored.version, restored.frames, restored.detections = head.version, head.frames, head.detections
        restored.batches, restored.upkept_batches = head.batches, head.upkept_batches
        restored.table = table
        return restored

    def _begin(self) -> Changes:
        self.version += 1
        self.table.changes = Changes(self.version)
        return self.table.changes

    def _head(self, since: int) -> Head:
        table = self.table
        gone = sorted(name for version, name in table.gone if version > since) if since else []
        aliases = {name: table.aliases[name] for name in gone if name in table.aliases}
        return Head(
            since=since,
            version=self.version,
            frames=self.frames,
            detections=self.detections,
            batches=self.batches,
            upkept_batches=self.upkept_batches,
            born=table.born,
            dimension=table.dimension,
            aliases=aliases if since else dict(sorted(table.aliases.items())),
            gone=gone,
            dirty=sorted(table.dirty),
            params=self.params,
        )

    def _check(self, batch: DetectionBatch) -> None:
        dimension = self.table.dimension
        for d in batch.detections:
            dimension = len(d.feature) if dimension is None else dimension
            if len(d.feature) != dimension or dimension == 0:
                raise InvalidInput(
                    f"detection {d.detection_id}: "
                    f"expected a feature of {dimension or 'some'} numbers like the map's, got {len(d.feature)}"
                )
            if not all(np.isfinite(array).all() for array in (d.feature, d.second_feature, d.box, d.points)):
                raise InvalidInput(f"detection {d.detection_id}: expected finite features, box and points")
            if not len(d.points) or len(d.points) != len(d.colors):
                raise InvalidInput(
                    f"detection {d.detection_id}: expected points with a colour each, "
                    f"got {len(d.points)} points and {len(d.colors)} colours"
                )

    def _associated(self, detections: Sequence[Detection]) -> list[ObjectRecord | None]:
        """The object that each detection joins, None where it is a new one's first."""
        params = self.params.association
        seen = Instances(
            np.stack([d.box for d in detections]),
            np.stack([d.feature for d in detections]),
            [d.label for d in detections],
            [d.points for d in detections],
        )
        records = list(self.table) if needs_all(params) else self.table.near_any(seen.boxes)
        if not records:
            return [None] * len(detections)
        objects = self.table.instances(records, clouds=params.spatial is Spatial.OVERLAP)
        return [None if j == NEW else records[j] for j in associate(seen, objects, params).tolist()]

    def _fuse(self, batch: DetectionBatch, joined: Sequence[ObjectRecord | None]) -> set[str]:
        """S_j += w_k f_k; Omega_j += w_k; C_j gains the label; voxel sums add (Eq. 4). Ids of what was seen."""
        table, k, frame = self.table, batch.intrinsics, frame_number(batch.frame_id)
        clouds = clouds_of(
            [d.points for d in batch.detections], [d.colors for d in batch.detections], self.params.voxel
        )
        weights = [fusion_weight(d.box2, k.width, k.height, self.params.fusion) for d in batch.detections]
        seen = []
        for detection, record, cloud, weight in zip(batch.detections, joined, clouds, weights, strict=True):
            weighted = weight * detection.feature.astype(np.float64)
            second = weight * detection.second_feature.astype(np.float64)
            if record is None:
                record = ObjectRecord(
                    object_id=table.new_id(),
                    cloud=cloud,
                    view_weight=weight,
                    label_counts={detection.label: 1},
                    observations=1,
                    frames=1,
                    seen_by=(frame,),
                    first_seen_ns=batch.timestamp_ns,
                    last_seen_ns=batch.timestamp_ns,
                    best_weight=weight,
                    best_frame_id=batch.frame_id,
                    best_box2=detection.box2,
                    last_batch=self.batches,
                    second_sum=second,
                )
                table.add(record, weighted)
            else:
                table.add_feature(record, weighted)
                record.second_sum = added(record.second_sum, second)
                record.view_weight += weight
                record.observations += 1
                record.frames += frame not in record.seen_by
                record.seen_by = remembered((*record.seen_by, frame))
                record.first_seen_ns = min(record.first_seen_ns, batch.timestamp_ns)
                record.last_seen_ns = max(record.last_seen_ns, batch.timestamp_ns)
                record.last_batch = self.batches
                if weight > record.best_weight:
                    record.best_weight, record.best_frame_id = weight, batch.frame_id
                    record.best_box2 = detection.box2
                table.count_label(record, detection.label)
                if (own := own_part(table, record, cloud)) is not None:
                    table.set_cloud(record, record.cloud.merged(own), detection.box)
            seen.append(record.object_id)
        return set(seen)

    def _changed(self) -> list[ObjectRecord]:
        """What changed since the last upkeep, in order of birth."""
        return sorted(filter(None, map(self.table.get, self.table.dirty)), key=lambda r: r.birth)

    def _outgrew(self, record: ObjectRecord, then: Extent | None, share: float, metres: float) -> bool:
        """Whether the cloud's size or box is no more what it was, but for a share of the one, metres of the other."""
        if then is None:
            return True
        voxels, box = then
        grown = abs(len(record.cloud) - voxels) > share * voxels
        return grown or bool((np.abs(self.table.box(record) - box) > metres).any())

    def _denoise(self, records: Sequence[ObjectRecord]) -> None:
        clean = denoised([r.cloud for r in records], self.params.upkeep)
        for record, cloud in zip(records, clean, strict=True):
            if len(cloud) < len(record.cloud):
                self.table.set_cloud(record, cloud)
            record.settled = (len(record.cloud), self.table.box(record))
            self.table.touch(record, seen=False)

    def _relate(self, records: Sequence[ObjectRecord]) -> None:
        relate(self.table, records, self.params)
        for record in records:
            record.related, record.fresh = (len(record.cloud), self.table.box(record)), None
            self.table.touch(record, seen=False)

    def _forget_noise(self) -> None:
        """Unconfirmed objects that were not seen again for a while were noise."""
        for record in self.table.tentative(self._confirmed):
            if self._is_noise(record):
                self.table.drop(record)

    def _is_noise(self, record: ObjectRecord) -> bool:
        return not record.deleted and self.batches - record.last_batch >= self.params.upkeep.forget_after

    def _confirmed(self, record: ObjectRecord) -> bool:
        return record.is_confirmed(self.params.upkeep.confirm_frames)

    def _is_shown(self, record: ObjectRecord, unconfirmed: bool = False, departed: bool = False) -> bool:
        return (
            not record.deleted
            and (unconfirmed or self._confirmed(record))
            and (departed or record.presence is Presence.PRESENT)
        )

    def _record(self, object_id: str) -> ObjectRecord | None:
        record = self.table.get(self.table.resolve(object_id))
        return record if record and not record.deleted else None

    def _as_read(self, record: ObjectRecord) -> MapObject:
        if record.read is None:
            record.read = self.table.read(record)
        return record.read


def map_of(batches: Iterable[DetectionBatch], params: MapParams | None = None) -> ObjectMap:
    """The map of a whole recording: upkeep whenever it is due, and at the end."""
    made = ObjectMap(params)
    for batch in batches:
        made.integrate(batch)
        if made.upkeep_due:
            made.upkeep()
    made.upkeep()
    return made


def frame_number(frame_id: str) -> int:
    """A number for a frame: 63 bits of its id's hash."""
    return int.from_bytes(hashlib.blake2b(frame_id.encode(), digest_size=8).digest(), "little") >> 1
