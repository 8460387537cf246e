"""The object map: one state, one verb. The same batches in the same order give the same map, bit for bit."""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ovip.errors import Corrupt, InvalidInput
from ovip.scene.boxes import pairwise_iou, touching
from ovip.scene.types import F32, F64, I64, U8, Box2, Detection, DetectionBatch, MapDelta, MapObject
from services.mapper.domain.association import NEW, AssociationParams, Instances, associate
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.fusion import FusionParams, fusion_weight
from services.mapper.domain.spatial import Spatial
from services.mapper.domain.upkeep import UpkeepParams, denoised, inside, overlap

SNAPSHOT_FORMAT = 1


@dataclass(frozen=True, slots=True)
class MapParams:
    """Everything that decides how detections become objects. voxel: metres (paper: 0.02)."""

    association: AssociationParams = AssociationParams()
    fusion: FusionParams = FusionParams()
    upkeep: UpkeepParams = UpkeepParams()
    voxel: float = 0.02


@dataclass(slots=True)
class _Object:
    """One object's state: o_j of the paper with its accumulators S_j, Omega_j, C_j."""

    object_id: str
    cloud: VoxelCloud
    box: F64
    feature_sum: F64
    view_weight: float
    label_counts: dict[str, int]
    observations: int
    frames: int
    last_frame_id: str
    first_seen_ns: int
    last_seen_ns: int
    best_weight: float
    best_frame_id: str
    best_box2: Box2
    last_batch: int
    version: int
    label: str = field(init=False)
    feature: F32 = field(init=False)

    def __post_init__(self) -> None:
        self.refresh()

    def refresh(self) -> None:
        """mode(C_j), ties to the label seen first; g_j = S_j / |S_j| (Eq. 4)."""
        self.label = max(self.label_counts, key=lambda label: self.label_counts[label])
        self.feature = (self.feature_sum / max(float(np.linalg.norm(self.feature_sum)), 1e-12)).astype(
            np.float32
        )


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
        self.aliases: dict[str, str] = {}
        self._batches = 0
        self._born = 0
        self._dimension: int | None = None
        self._objects: dict[str, _Object] = {}
        self._dirty: set[str] = set()

    def integrate(self, batch: DetectionBatch) -> MapDelta:
        """Associates and fuses one frame's detections, merges what became one; every `upkeep.every` batches, upkeep.

        One version a batch."""
        self._check(batch)
        self.version += 1
        self._batches += 1
        self.frames += not batch.late
        self.detections += len(batch.detections)
        created, updated = self._fuse_batch(batch)
        aliases = self._merge_duplicates(created | updated) if self.params.upkeep.eager else {}
        removed: list[str] = []
        if self._batches % self.params.upkeep.every == 0:
            updated, aliases, removed = self._keep_up(updated, aliases)
        return self._delta(batch.frame_id, created, updated, aliases, removed)

    def settle(self) -> MapDelta:
        """Upkeep of what changed since the last one, as after the last frame of a recording (SPEC 2.6). One version."""
        self.version += 1
        updated, aliases, removed = self._keep_up(set(), {})
        return self._delta("", set(), updated, aliases, removed)

    def _keep_up(
        self, updated: set[str], aliases: dict[str, str]
    ) -> tuple[set[str], dict[str, str], list[str]]:
        updated = updated | self._denoise()
        aliases = aliases | self._merge_duplicates(self._dirty)
        removed = self._forget()
        self._dirty.clear()
        return updated, aliases, removed

    def _delta(
        self,
        frame_id: str,
        created: set[str],
        updated: set[str],
        aliases: dict[str, str],
        removed: list[str],
    ) -> MapDelta:
        """What changed, and the new version written on it."""
        updated = updated | {self.resolve(survivor) for survivor in aliases.values()}
        for object_id in created | updated:
            if object_id in self._objects:
                self._objects[object_id].version = self.version
        gone = set(removed) | set(aliases)
        return MapDelta(
            version=self.version,
            frame_id=frame_id,
            created=tuple(sorted(created - gone)),
            updated=tuple(sorted(updated - created - gone)),
            removed=tuple(sorted(removed)),
            aliases=dict(sorted(aliases.items())),
        )

    def objects(self, include_unconfirmed: bool = False) -> tuple[MapObject, ...]:
        """The objects in order of birth, as readers see them."""
        return tuple(_as_read(o) for o in self._shown(include_unconfirmed))

    def find(self, object_id: str) -> MapObject | None:
        """One object by its id or by an id merged into it."""
        found = self._objects.get(self.resolve(object_id))
        return _as_read(found) if found else None

    def resolve(self, object_id: str) -> str:
        """The id that an alias stands for now; an id itself where it is none."""
        while object_id in self.aliases:
            object_id = self.aliases[object_id]
        return object_id

    def cloud_of(self, object_id: str) -> tuple[F32, U8] | None:
        """Points `(V, 3)` and colours `(V, 3)` of an object."""
        found = self._objects.get(self.resolve(object_id))
        return (found.cloud.points, found.cloud.colors) if found else None

    def state_hash(self) -> str:
        """SHA-256 over the whole state: equal hashes, equal maps."""
        return hashlib.sha256(self.snapshot()).hexdigest()

    def snapshot(self) -> bytes:
        """The whole state as bytes, the same for the same state."""
        objects = list(self._objects.values())
        head = {
            "format": SNAPSHOT_FORMAT,
            "version": self.version,
            "frames": self.frames,
            "detections": self.detections,
            "batches": self._batches,
            "born": self._born,
            "dimension": self._dimension,
            "aliases": self.aliases,
            "dirty": sorted(self._dirty),
            "objects": [_plain(o) for o in objects],
        }
        out = io.BytesIO()
        text = json.dumps(head, separators=(",", ":")).encode()
        out.write(len(text).to_bytes(8, "little") + text)
        for o in objects:
            for array in (o.box, o.feature_sum, o.cloud.keys, o.cloud.counts, o.cloud.sums):
                out.write(np.ascontiguousarray(array).tobytes())
        return out.getvalue()

    @classmethod
    def restore(cls, data: bytes, params: MapParams | None = None) -> ObjectMap:
        """The map that `snapshot` wrote; InvalidInput for another format, Corrupt where bytes are missing."""
        size = int.from_bytes(data[:8], "little")
        try:
            head = json.loads(data[8 : 8 + size])
        except ValueError as error:
            raise Corrupt("map snapshot: its head does not parse") from error
        if head["format"] != SNAPSHOT_FORMAT:
            raise InvalidInput(
                f"map snapshot of format {head['format']}: this version reads format {SNAPSHOT_FORMAT}"
            )
        restored = cls(params)
        restored.version, restored.frames, restored.detections = (
            head["version"],
            head["frames"],
            head["detections"],
        )
        restored._batches, restored._born, restored._dimension = (
            head["batches"],
            head["born"],
            head["dimension"],
        )
        restored.aliases, restored._dirty = head["aliases"], set(head["dirty"])
        arrays = _arrays(data, 8 + size, head["objects"], head["dimension"] or 0)
        for plain, (box, feature_sum, cloud) in zip(head["objects"], arrays, strict=True):
            best_box2 = Box2(*plain.pop("best_box2"))
            plain.pop("voxels")
            restored._objects[plain["object_id"]] = _Object(
                cloud=cloud, box=box, feature_sum=feature_sum, best_box2=best_box2, **plain
            )
        return restored

    def _check(self, batch: DetectionBatch) -> None:
        dimension = self._dimension
        for d in batch.detections:
            dimension = len(d.feature) if dimension is None else dimension
            if len(d.feature) != dimension or dimension == 0:
                raise InvalidInput(
                    f"detection {d.detection_id}: "
                    f"expected a feature of {dimension or 'some'} numbers like the map's, got {len(d.feature)}"
                )
            if not all(np.isfinite(array).all() for array in (d.feature, d.box, d.points)):
                raise InvalidInput(f"detection {d.detection_id}: expected finite features, box and points")
            if not len(d.points) or len(d.points) != len(d.colors):
                raise InvalidInput(
                    f"detection {d.detection_id}: expected points with a colour each, "
                    f"got {len(d.points)} points and {len(d.colors)} colours"
                )
        self._dimension = dimension

    def _fuse_batch(self, batch: DetectionBatch) -> tuple[set[str], set[str]]:
        objects = list(self._objects.values())
        detections = batch.detections
        if not detections:
            return set(), set()
        assigned = associate(
            Instances(
                np.stack([d.box for d in detections]),
                np.stack([d.feature for d in detections]),
                [d.label for d in detections],
                [d.points for d in detections],
            ),
            Instances(
                np.array([o.box for o in objects]).reshape(-1, 6),
                np.array([o.feature for o in objects], np.float32).reshape(-1, self._dimension or 0),
                [o.label for o in objects],
                [o.cloud.points for o in objects] if self._compares_clouds else (),
            ),
            self.params.association,
        )
        created, updated = set(), set()
        for detection, j in zip(detections, assigned, strict=True):
            if j == NEW:
                created.add(self._create(detection, batch))
            else:
                updated.add(self._merge_detection(objects[j], detection, batch))
        self._dirty |= created | updated
        return created, updated

    @property
    def _compares_clouds(self) -> bool:
        return self.params.association.spatial is Spatial.OVERLAP

    def _create(self, detection: Detection, batch: DetectionBatch) -> str:
        weight = fusion_weight(
            detection.box2, batch.intrinsics.width, batch.intrinsics.height, self.params.fusion
        )
        cloud = VoxelCloud.of(detection.points, detection.colors, self.params.voxel)
        self._born += 1
        object_id = f"o{self._born:06d}"
        self._objects[object_id] = _Object(
            object_id=object_id,
            cloud=cloud,
            box=cloud.box,
            feature_sum=weight * detection.feature.astype(np.float64),
            view_weight=weight,
            label_counts={detection.label: 1},
            observations=1,
            frames=1,
            last_frame_id=batch.frame_id,
            first_seen_ns=batch.timestamp_ns,
            last_seen_ns=batch.timestamp_ns,
            best_weight=weight,
            best_frame_id=batch.frame_id,
            best_box2=detection.box2,
            last_batch=self._batches,
            version=self.version,
        )
        return object_id

    def _merge_detection(self, o: _Object, detection: Detection, batch: DetectionBatch) -> str:
        """S_j += w_k f_k; Omega_j += w_k; C_j gains the label; voxel sums add (Eq. 4, SPEC 2.4)."""
        weight = fusion_weight(
            detection.box2, batch.intrinsics.width, batch.intrinsics.height, self.params.fusion
        )
        o.feature_sum = o.feature_sum + weight * detection.feature.astype(np.float64)
        o.view_weight += weight
        o.label_counts[detection.label] = o.label_counts.get(detection.label, 0) + 1
        o.cloud = o.cloud.merged(VoxelCloud.of(detection.points, detection.colors, self.params.voxel))
        o.box = o.cloud.box
        o.observations += 1
        o.frames += batch.frame_id != o.last_frame_id
        o.last_frame_id = batch.frame_id
        o.first_seen_ns = min(o.first_seen_ns, batch.timestamp_ns)
        o.last_seen_ns = max(o.last_seen_ns, batch.timestamp_ns)
        o.last_batch = self._batches
        if weight > o.best_weight:
            o.best_weight, o.best_frame_id, o.best_box2 = weight, batch.frame_id, detection.box2
        o.refresh()
        return o.object_id

    def _denoise(self) -> set[str]:
        """Clears clutter off changed objects; returns the ids of those that lost voxels."""
        thinner = set()
        for object_id in sorted(self._dirty & self._objects.keys()):
            o = self._objects[object_id]
            cloud = denoised(o.cloud, self.params.upkeep)
            if len(cloud) < len(o.cloud):
                thinner.add(object_id)
                o.cloud, o.box = cloud, cloud.box
        return thinner

    def _merge_duplicates(self, changed: set[str]) -> dict[str, str]:
        """Changed objects, oldest first, join those that are the same thing; the one seen in more frames stays."""
        aliases: dict[str, str] = {}
        for object_id in sorted(changed):
            while object_id in self._objects:
                twin = self._twin_of(self._objects[object_id])
                if twin is None:
                    break
                keep, gone = sorted((object_id, twin), key=self._seniority)
                self._absorb(self._objects[keep], self._objects.pop(gone))
                aliases[gone] = keep
                self._dirty.add(keep)
                object_id = keep
        self.aliases.update(aliases)
        return aliases

    def _seniority(self, object_id: str) -> tuple[int, str]:
        return (-self._objects[object_id].frames, object_id)

    def _twin_of(self, o: _Object) -> str | None:
        """The first object that is the same thing: alike, and in the same place."""
        upkeep = self.params.upkeep
        others = [p for p in self._objects.values() if p is not o]
        if not others:
            return None
        slack = np.array([-upkeep.reach] * 3 + [upkeep.reach] * 3)
        near = touching(o.box + slack, np.stack([p.box for p in others]))
        for p in (p for p, close in zip(others, near, strict=True) if close):
            alike = float(o.feature @ p.feature) > upkeep.merge_similarity
            if alike and self._same_place(o, p):
                return p.object_id
        return None

    def _same_place(self, o: _Object, p: _Object) -> bool:
        """Where labels differ and count, only a box that is much the same will do."""
        upkeep = self.params.upkeep
        if pairwise_iou(o.box[None], p.box[None])[0, 0] > upkeep.merge_iou:
            return True
        if o.label != p.label and upkeep.same_label:
            return False
        if inside(o.box, p.box, self.params.voxel / 2) > upkeep.merge_inside:
            return True
        return overlap(o.cloud, p.cloud, upkeep.reach) > upkeep.merge_overlap

    def _absorb(self, keep: _Object, gone: _Object) -> None:
        """The accumulators of both objects added: counts, S, Omega, voxel sums."""
        keep.feature_sum = keep.feature_sum + gone.feature_sum
        keep.view_weight += gone.view_weight
        for label, count in gone.label_counts.items():
            keep.label_counts[label] = keep.label_counts.get(label, 0) + count
        keep.cloud = keep.cloud.merged(gone.cloud)
        keep.box = keep.cloud.box
        keep.observations += gone.observations
        keep.frames += gone.frames
        keep.first_seen_ns = min(keep.first_seen_ns, gone.first_seen_ns)
        keep.last_seen_ns = max(keep.last_seen_ns, gone.last_seen_ns)
        keep.last_batch = max(keep.last_batch, gone.last_batch)
        if gone.best_weight > keep.best_weight:
            keep.best_weight, keep.best_frame_id, keep.best_box2 = (
                gone.best_weight,
                gone.best_frame_id,
                gone.best_box2,
            )
        keep.refresh()

    def _forget(self) -> list[str]:
        """Unconfirmed objects that were not seen again for a while were noise."""
        upkeep = self.params.upkeep
        noise = [
            o.object_id
            for o in self._objects.values()
            if o.frames < upkeep.confirm_frames and self._batches - o.last_batch >= upkeep.forget_after
        ]
        for object_id in noise:
            del self._objects[object_id]
        return noise

    def _shown(self, include_unconfirmed: bool) -> Iterator[_Object]:
        for o in self._objects.values():
            if include_unconfirmed or o.frames >= self.params.upkeep.confirm_frames:
                yield o


def _as_read(o: _Object) -> MapObject:
    mean = o.cloud.mean
    return MapObject(
        object_id=o.object_id,
        label=o.label,
        label_counts=dict(o.label_counts),
        centroid=mean[:3],
        box=o.box,
        feature=o.feature,
        view_weight=o.view_weight,
        observations=o.observations,
        frames=o.frames,
        first_seen_ns=o.first_seen_ns,
        last_seen_ns=o.last_seen_ns,
        voxels=len(o.cloud),
        mean_color=mean[3:],
        best_frame_id=o.best_frame_id,
        best_box2=o.best_box2,
        version=o.version,
    )


_ARRAYS = ("cloud", "box", "feature_sum", "label", "feature")


def _plain(o: _Object) -> dict[str, object]:
    plain = {f.name: getattr(o, f.name) for f in dataclasses.fields(o) if f.name not in _ARRAYS}
    return {
        **plain,
        "best_box2": [o.best_box2.x0, o.best_box2.y0, o.best_box2.x1, o.best_box2.y1],
        "voxels": len(o.cloud),
    }


def _arrays(
    data: bytes, at: int, objects: list[dict[str, int]], dimension: int
) -> Iterator[tuple[F64, F64, VoxelCloud]]:
    def take(count: int) -> memoryview:
        nonlocal at
        if at + 8 * count > len(data):
            raise Corrupt(f"map snapshot: expected at least {at + 8 * count} bytes, got {len(data)}")
        at += 8 * count
        return memoryview(data)[at - 8 * count : at]

    def floats(count: int) -> F64:
        return np.frombuffer(take(count), np.float64).copy()

    def integers(count: int) -> I64:
        return np.frombuffer(take(count), np.int64).copy()

    for plain in objects:
        v = plain["voxels"]
        box, feature_sum = floats(6), floats(dimension)
        yield box, feature_sum, VoxelCloud(integers(v), integers(v), floats(6 * v).reshape(v, 6))
