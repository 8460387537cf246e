"""The objects' state: what association compares as arrays, the rest as records, and what a step changed of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ovip.scene.boxes import hull, pair_touching
from ovip.scene.types import (
    F64,
    MapObject,
    Presence,
)
from services.mapper.domain.association import Instances
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.index import BoxIndex
from services.mapper.domain.records import Changes, ObjectRecord, added, remembered


class ObjectTable:
    """All objects of a map, in order of birth; ids are counted and never reused, one merged away is an alias.

    Every change goes through here, so that the arrays, the index and `changes` agree with the records.
    """

    def __init__(self) -> None:
        self.dimension: int | None = None
        self.born = 0
        self.aliases: dict[str, str] = {}
        self.changes = Changes(0)
        self.dirty: set[str] = set()
        self.gone: list[tuple[int, str]] = []
        self._records: dict[str, ObjectRecord] = {}
        self._tentative: dict[str, ObjectRecord] = {}
        self._by_slot: list[ObjectRecord | None] = []
        self._free: list[int] = []
        self._boxes = np.zeros((0, 6))
        self._sums = np.zeros((0, 0))
        self._index = BoxIndex()

    def __len__(self) -> int:
        return len(self._records)

    def __iter__(self) -> Iterator[ObjectRecord]:
        return iter(self._records.values())

    def get(self, object_id: str) -> ObjectRecord | None:
        """An object by its own id, not an alias."""
        return self._records.get(object_id)

    def resolve(self, object_id: str) -> str:
        """The id that an alias stands for now; an id itself where it is none."""
        while object_id in self.aliases:
            object_id = self.aliases[object_id]
        return object_id

    def box(self, record: ObjectRecord) -> F64:
        """B_j `(6,)`."""
        return np.array(self._boxes[record.slot])

    def feature_sum(self, record: ObjectRecord) -> F64:
        """S_j `(D,)`."""
        return np.array(self._sums[record.slot])

    def features(self, records: Sequence[ObjectRecord]) -> F64:
        """g_j = S_j / |S_j| `(N, D)` (Eq. 4)."""
        sums: F64 = self._sums[[r.slot for r in records]]
        norms: F64 = np.sqrt(np.einsum("nd,nd->n", sums, sums))
        return sums / np.maximum(norms, 1e-12)[:, None]

    def boxes(self, records: Sequence[ObjectRecord]) -> F64:
        """B_j of several `(N, 6)`."""
        return np.array(self._boxes[[r.slot for r in records]])

    def instances(self, records: Sequence[ObjectRecord], clouds: bool = False) -> Instances:
        """Objects as association compares them."""
        return Instances(
            self.boxes(records),
            self.features(records),
            [r.mode for r in records],
            [r.cloud.points for r in records] if clouds else (),
        )

    def read(self, record: ObjectRecord) -> MapObject:
        """The object as readers see it."""
        mean = record.cloud.mean
        return MapObject(
            object_id=record.object_id,
            label=record.label,
            label_counts=dict(record.label_counts),
            centroid=mean[:3],
            box=self.box(record),
            feature=self.features([record])[0].astype(np.float32),
            view_weight=record.view_weight,
            observations=record.observations,
            frames=record.frames,
            first_seen_ns=record.first_seen_ns,
            last_seen_ns=record.last_seen_ns,
            voxels=len(record.cloud),
            mean_color=mean[3:],
            best_frame_id=record.best_frame_id,
            best_box2=record.best_box2,
            version=record.version,
            revision=record.revision,
            presence=record.presence,
            pinned=record.pinned,
            label_given=bool(record.given_label),
            relations=record.relations,
            moves=record.moves,
        )

    def near(self, box: F64) -> list[ObjectRecord]:
        """Objects whose box shares a volume with `box` `(6,)`, and some others, in order of birth."""
        return self.near_any(box[None])

    def touching(self, box: F64) -> list[ObjectRecord]:
        """Objects whose box shares a volume with `box` `(6,)`, in order of birth."""
        near = self.near(box)
        if not near:
            return []
        together = pair_touching(box, self.boxes(near))
        return [r for r, touches in zip(near, together.tolist(), strict=True) if touches]

    def near_any(self, boxes: F64) -> list[ObjectRecord]:
        """Objects near any of `(N, 6)` boxes, in order of birth."""
        slots: set[int] = set()
        for box in boxes:
            slots |= self._index.near(box)
        records = [r for slot in slots if (r := self._by_slot[slot]) is not None]
        return sorted(records, key=lambda r: r.birth)

    def tentative(self, confirmed: Callable[[ObjectRecord], bool]) -> list[ObjectRecord]:
        """Objects that are not `confirmed` yet; what once was is not asked again."""
        there = {name: r for name, r in self._tentative.items() if self._records.get(name) is r}
        self._tentative = {name: r for name, r in there.items() if not confirmed(r)}
        return list(self._tentative.values())

    def reconsider(self) -> None:
        """Other settings: every object may be tentative again."""
        self._tentative = dict(self._records)

    def new_id(self) -> str:
        """The next object's id; ids sort in order of birth."""
        self.born += 1
        return f"o{self.born:06d}"

    def add(self, record: ObjectRecord, feature_sum: F64) -> None:
        """A new object, born in this step."""
        self._place(record, feature_sum)
        self.changes.created.add(record.object_id)
        self.dirty.add(record.object_id)
        self._note_fresh(record, self.box(record))
        record.revision = self.changes.version
        self.touch(record)

    def restore(self, record: ObjectRecord, feature_sum: F64) -> None:
        """An object that was written down; in order of birth."""
        self._place(record, feature_sum)

    def _place(self, record: ObjectRecord, feature_sum: F64) -> None:
        if self.dimension is None:
            self.dimension = len(feature_sum)
        record.slot = self._free.pop() if self._free else len(self._by_slot)
        if record.slot == len(self._by_slot):
            self._by_slot.append(None)
            self._grow()
        self._by_slot[record.slot] = record
        self._records[record.object_id] = record
        self._tentative[record.object_id] = record
        self._sums[record.slot] = feature_sum
        self._set_box(record)

    def touch(self, record: ObjectRecord, seen: bool = True) -> None:
        """Something of the object changed in this step; `seen`: something that readers see."""
        record.touched = self.changes.version
        record.digest = b""
        if seen:
            record.version = self.changes.version
            record.read = None
            if not record.deleted:
                self.changes.updated.add(record.object_id)

    def revise(self, record: ObjectRecord) -> None:
        """What the object is changed in this step."""
        record.revision = self.changes.version
        self._tentative[record.object_id] = record
        self.touch(record)

    def unsettle(self, record: ObjectRecord) -> None:
        """Upkeep is to look at the object, and at what is around it, whatever it knew."""
        record.settled = record.related = None
        self._note_fresh(record, self.box(record))
        self.dirty.add(record.object_id)
        self.touch(record, seen=False)

    def drop(self, record: ObjectRecord) -> None:
        """Gone for good."""
        self._forget(record)
        self.changes.removed.add(record.object_id)

    def set_cloud(self, record: ObjectRecord, cloud: VoxelCloud, part: F64 | None = None) -> None:
        """The object's geometry is `cloud` now; what is new of it lies in the box `part` `(6,)`, None: anywhere."""
        record.cloud, record.body = cloud, None
        self._set_box(record)
        self._note_fresh(record, self.box(record) if part is None else part)
        self.dirty.add(record.object_id)
        self.touch(record)

    def add_feature(self, record: ObjectRecord, weighted: F64) -> None:
        """S_j += w_k f_k: `(D,)` added to the object's sum."""
        self._sums[record.slot] += weighted
        self.touch(record)

    def set_feature_sum(self, record: ObjectRecord, feature_sum: F64) -> None:
        """S_j `(D,)` is this now."""
        self._sums[record.slot] = feature_sum
        self.touch(record)

    def count_label(self, record: ObjectRecord, label: str, times: int = 1) -> None:
        """C_j gains a label."""
        before = record.label
        record.label_counts[label] = record.label_counts.get(label, 0) + times
        record.recount()
        if record.label != before:
            self.unsettle(record)
            self.revise(record)

    def merge(self, keep: ObjectRecord, gone: ObjectRecord, cloud: VoxelCloud | None = None) -> None:
        """`keep` absorbs `gone`, which becomes an alias of it. cloud: the survivor's, where that is not both's."""
        feature_sum = self.feature_sum(gone)
        self._forget(gone)
        if gone.object_id in self.changes.created and gone.object_id not in self.changes.aliases.values():
            # born in this step: nobody will have known of it
            self.changes.created.remove(gone.object_id)
            self.changes.updated.discard(gone.object_id)
        else:
            self.aliases[gone.object_id] = keep.object_id
            self.changes.aliases[gone.object_id] = keep.object_id
        self.absorb(keep, gone, feature_sum, cloud or keep.cloud.merged(gone.cloud))
        for name in sorted(gone.apart):
            if (other := self.get(name)) is not None:
                self.unpart(other, gone)
                self.part(keep, other)

    def absorb(self, keep: ObjectRecord, gone: ObjectRecord, feature_sum: F64, cloud: VoxelCloud) -> None:
        """The accumulators of both added (counts, S, Omega); the cloud of both is `cloud`. `gone` need not be here."""
        self._sums[keep.slot] += feature_sum
        keep.second_sum = added(keep.second_sum, gone.second_sum)
        keep.view_weight += gone.view_weight
        keep.observations += gone.observations
        keep.frames += gone.frames - len(set(keep.seen_by) & set(gone.seen_by))
        keep.seen_by = remembered((*gone.seen_by, *keep.seen_by))
        keep.first_seen_ns = min(keep.first_seen_ns, gone.first_seen_ns)
        keep.last_seen_ns = max(keep.last_seen_ns, gone.last_seen_ns)
        keep.last_batch = max(keep.last_batch, gone.last_batch)
        keep.given_label = keep.given_label or gone.given_label
        keep.pinned |= gone.pinned
        if gone.best_weight > keep.best_weight:
            keep.best_weight, keep.best_frame_id = gone.best_weight, gone.best_frame_id
            keep.best_box2 = gone.best_box2
        for label, count in gone.label_counts.items():
            self.count_label(keep, label, count)
        self.set_cloud(keep, cloud, gone.cloud.box)
        keep.evidence = keep.settled = keep.related = None
        if gone.presence is Presence.PRESENT:
            keep.presence = Presence.PRESENT
        self.revise(keep)

    def part(self, a: ObjectRecord, b: ObjectRecord) -> None:
        """The two are different things for ever after, whatever they are merged with."""
        if a is not b:
            a.apart, b.apart = a.apart | {b.object_id}, b.apart | {a.object_id}
            self.touch(a, seen=False)
            self.touch(b, seen=False)

    def unpart(self, a: ObjectRecord, b: ObjectRecord) -> None:
        """The two may be one thing again."""
        a.apart, b.apart = a.apart - {b.object_id}, b.apart - {a.object_id}
        self.touch(a, seen=False)
        self.touch(b, seen=False)

    def _forget(self, record: ObjectRecord) -> None:
        del self._records[record.object_id]
        self._by_slot[record.slot] = None
        self._free.append(record.slot)
        self._index.remove(record.slot)
        self.dirty.discard(record.object_id)
        self.gone.append((self.changes.version, record.object_id))

    def _note_fresh(self, record: ObjectRecord, part: F64) -> None:
        record.fresh = part if record.fresh is None else hull(record.fresh, part)

    def _set_box(self, record: ObjectRecord) -> None:
        box = record.cloud.box
        self._boxes[record.slot] = box
        self._index.put(record.slot, box)

    def _grow(self) -> None:
        if len(self._by_slot) > len(self._boxes) or self._sums.shape[1] != self.dimension:
            room = max(64, 2 * len(self._boxes))
            boxes, sums = np.zeros((room, 6)), np.zeros((room, self.dimension or 0))
            boxes[: len(self._boxes)] = self._boxes
            if self._sums.shape[1] == sums.shape[1]:
                sums[: len(self._sums)] = self._sums
            self._boxes, self._sums = boxes, sums
