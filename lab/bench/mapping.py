"""What a frame costs the mapper over maps of growing size at one density, beside the dense map (DESIGN 7)."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from lab.bench.lifting import measure_lifting
from lab.bench.mapping_dense import DenseObject, Stacked, associate_all_pairs
from lab.bench.mapping_walk import Walk
from lab.bench.mapping_world import CAMERA, CrowdedFloor
from lab.bench.rows import Row
from ovip.codec import encode_detection_batch
from ovip.config import KernelSettings
from ovip.scene.features import normalize
from ovip.scene.types import F32, Detection, DetectionBatch, MapDelta
from ovip.store import Append, Lease, Store
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.domain.records import ObjectRecord
from services.mapper.domain.upkeep import UpkeepParams
from services.mapper.history import MAP, STAGE, VERSION
from services.mapper.journal import FrameInput, Step, entry_id
from services.mapper.steps import prepared

OBJECTS = (100, 1_000, 10_000, 50_000)
DETECTIONS = (20, 40)
DIMENSIONS = (512, 1024)
FRAMES = 50  # as many as lie between two snapshots
_WARM_UP = 10
_BORN_AT_ONCE = 400
_DENSE_FRAMES, _DENSE_TRIES = 12, 3
_COLUMNS = (
    *("objects", "detections", "dim", "lift_ms", "denoise_ms", "associate_ms", "fuse_ms", "upkeep_ms", "commit_ms"),
    *("frame_ms", "frame_p99_ms", "dense_ms", "bytes_per_frame"),
    *("watch_ms", "snapshot_ms", "ratio", "dense_fuse_ms", "dense_bytes_per_frame", "bytes_map", "load"),
)  # fmt: skip


async def measure_mapper(
    objects: Sequence[int] = OBJECTS,
    detections: Sequence[int] = DETECTIONS,
    dimensions: Sequence[int] = DIMENSIONS,
    frames: int = FRAMES,
) -> list[Row]:
    """A row for each size of map, detections a frame and features' dimension; medians over `frames` frames.

    frame_ms: reading, decoding, integrating and committing a frame as the service does; watch_ms: what integrating
    takes beside association and fusion (checks, what the frame saw through, duplicates it made). bytes_per_frame: in
    the journal, and in the snapshot of the row's frames. ratio: dense_ms to associate_ms.
    One map of the widest features grows from size to size; narrower ones are the same map and frames with features
    cut. What is measured looks at things that are in the map; the first frames of a row do not count; the store is a
    real one in a folder of its own.
    """
    lifting = {count: _lifting(count) for count in detections}
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        store = await Store.connect(KernelSettings(data_dir=Path(folder), redis_url=None))
        try:
            growing = GrowingMap(CrowdedFloor(max(dimensions)))
            for size in sorted(objects):
                growing.grow(size)
                for dimension in dimensions:
                    made = growing.narrowed(dimension)
                    for count in detections:
                        row = await _Measurement(store, made, count).row(frames)
                        rows.append({**row, **lifting[count]})
        finally:
            await store.close()
    ordered: list[Row] = [{name: row[name] for name in _COLUMNS} for row in rows]
    return sorted(ordered, key=lambda row: tuple(float(row[name]) for name in _COLUMNS[:3]))


class TimedMap(ObjectMap):
    """The mapper's own map; notes how long the parts of the last frame took."""

    associate_ms = fuse_ms = integrate_ms = 0.0

    def integrate(self, batch: DetectionBatch) -> MapDelta:
        """Associates and fuses one frame."""
        began = time.perf_counter()
        delta = super().integrate(batch)
        self.integrate_ms = _ms_since(began)
        return delta

    def _associated(self, detections: Sequence[Detection]) -> list[ObjectRecord | None]:
        began = time.perf_counter()
        joined = super()._associated(detections)
        self.associate_ms = _ms_since(began)
        return joined

    def _fuse(self, batch: DetectionBatch, joined: Sequence[ObjectRecord | None]) -> set[str]:
        began = time.perf_counter()
        seen = super()._fuse(batch, joined)
        self.fuse_ms = _ms_since(began)
        return seen


class GrowingMap:
    """A map of the floor's first things. Seen once is enough to be believed, so that one view each builds it."""

    def __init__(self, floor: CrowdedFloor) -> None:
        self.floor = floor
        self.things = 0
        self.dimension = floor.dimension
        self.map = TimedMap(MapParams(upkeep=UpkeepParams(confirm_frames=1)))
        self._next_frame = 1

    def grow(self, things: int) -> None:
        """Maps things up to `things`, many a frame, as if upkeep had looked at them when they came."""
        while self.things < things:
            last = min(self.things + _BORN_AT_ONCE, things)
            seen = self.floor.things(self.things, last)
            self.map.integrate(self.floor.batch(seen, self._next_frame))
            self.things, self._next_frame = last, self._next_frame + 1
        self.map.table.dirty.clear()

    def narrowed(self, dimension: int) -> GrowingMap:
        """The same map with features cut to their first `dimension` numbers; this one where they are no more."""
        if dimension >= self.dimension:
            return self
        narrow = GrowingMap(self.floor)
        narrow.things, narrow.dimension, narrow._next_frame = self.things, dimension, self._next_frame
        narrow.map.version = self.map.version
        narrow.map.table.born = self.map.table.born
        for record in self.map.table:
            copied = replace(record, label_counts=dict(record.label_counts), slot=-1, read=None, digest=b"")
            narrow.map.table.restore(copied, self.map.table.feature_sum(record)[:dimension])
        return narrow

    def frames(self, count: int, detections: int) -> list[DetectionBatch]:
        """The next frames of a walk over what is mapped."""
        first = self._next_frame
        self._next_frame += count
        frames = Walk(self.floor, self.things, detections, first).frames(count)
        return [_cut(frame, self.dimension) for frame in frames]


def _cut(batch: DetectionBatch, dimension: int) -> DetectionBatch:
    cut = (replace(d, feature=normalize(d.feature[:dimension])) for d in batch.detections)
    return replace(batch, detections=tuple(cut))


class _Measurement:
    """One row: frames through the steps that the mapper's service takes, each part timed."""

    def __init__(self, store: Store, growing: GrowingMap, detections: int) -> None:
        self._store = store
        self._growing = growing
        self._map = growing.map
        self._detections = detections
        self._scene = f"d{growing.dimension}-n{growing.things}-k{detections}"
        self._ms: dict[str, list[float]] = {
            name: [] for name in ("associate", "fuse", "watch", "upkeep", "commit", "frame")
        }
        self._journal_bytes = 0

    async def row(self, frames: int) -> Row:
        """Medians over `frames` frames after the warm-up."""
        batches = self._growing.frames(_WARM_UP + frames, self._detections)
        lease = await self._store.acquire_lease(self._scene, STAGE, "bench", 600.0)
        assert lease is not None
        for batch in batches[:_WARM_UP]:
            await self._frame(lease, batch)
        self._map.upkeep()
        for samples in self._ms.values():
            samples.clear()
        self._journal_bytes, since = 0, self._map.version
        for batch in batches[_WARM_UP:]:
            await self._frame(lease, batch)
            if self._map.upkeep_due:
                self._upkeep()
        if not self._ms["upkeep"]:
            self._upkeep()
        snapshot_ms, snapshot_bytes = await self._snapshot(since)
        dense = _dense(self._map, batches[-_DENSE_FRAMES:])
        associate = float(np.median(self._ms["associate"]))
        return {
            "objects": self._growing.things,
            "detections": self._detections,
            "dim": self._growing.dimension,
            **{f"{name}_ms": _median(samples) for name, samples in self._ms.items()},
            "frame_p99_ms": round(float(np.percentile(self._ms["frame"], 99)), 3),
            **dense,
            "ratio": round(float(dense["dense_ms"]) / associate, 2),
            "bytes_per_frame": round((self._journal_bytes + snapshot_bytes) / frames),
            "dense_bytes_per_frame": self._detections * CAMERA.width * CAMERA.height,
            "snapshot_ms": snapshot_ms,
            "bytes_map": self._map.nbytes,
            "load": round(os.getloadavg()[0], 1),
        }

    async def _frame(self, lease: Lease, batch: DetectionBatch) -> None:
        """As the service takes a frame: read the batch, decode, integrate, commit the step."""
        ref = await self._store.blobs.put(encode_detection_batch(batch))
        log_id = f"{self._map.version + 1}-0"
        began = time.perf_counter()
        do = await prepared(self._store.blobs, FrameInput(log_id, ref))
        step = do(self._map)
        done = time.perf_counter()
        await self._commit(lease, log_id, step)
        self._ms["frame"].append(_ms_since(began))
        self._ms["commit"].append(_ms_since(done))
        self._ms["associate"].append(self._map.associate_ms)
        self._ms["fuse"].append(self._map.fuse_ms)
        rest = self._map.integrate_ms - self._map.associate_ms - self._map.fuse_ms
        self._ms["watch"].append(rest)

    async def _commit(self, lease: Lease, log_id: str, step: Step) -> None:
        version, fields = step.delta.version, step.fields()
        append = Append(MAP, fields, entry_id(version))
        await self._store.commit(lease, log_id, [append], {VERSION: version})
        self._journal_bytes += sum(_bytes_of(word) for pair in fields.items() for word in pair)

    def _upkeep(self) -> None:
        began = time.perf_counter()
        self._map.upkeep()
        self._ms["upkeep"].append(_ms_since(began))

    async def _snapshot(self, since: int) -> tuple[float, int]:
        """Milliseconds and bytes of writing down what changed above a version."""
        began = time.perf_counter()
        segment = self._map.segment(since)
        await self._store.blobs.put(segment)
        return round(_ms_since(began), 3), len(segment)


def _dense(made: ObjectMap, batches: Sequence[DetectionBatch]) -> Row:
    """The dense map's association and fusion of the same frames, over the same objects.

    In each frame the best of three tries counts.
    """
    records = list(made.table)
    numbers = {label: number for number, label in enumerate(sorted({r.label for r in records}))}
    objects = Stacked(
        made.table.boxes(records),
        made.table.features(records).astype(np.float32),
        np.array([numbers[r.label] for r in records], np.int64),
    )
    associate, fuse = [], []
    for batch in batches:
        seen = Stacked.of(batch.detections, numbers)
        tries = []
        for _ in range(_DENSE_TRIES):
            began = time.perf_counter()
            joined = associate_all_pairs(seen, objects)
            tries.append(_ms_since(began))
        associate.append(min(tries))
        pairs = [
            (_dense_object(records[j], objects.features[j]), detection)
            for j, detection in zip(joined.tolist(), batch.detections, strict=True)
            if j >= 0
        ]
        mask = np.zeros((CAMERA.height, CAMERA.width), np.bool_)
        began = time.perf_counter()
        for dense, detection in pairs:
            dense.fuse(detection, mask, made.params.voxel)
        fuse.append(_ms_since(began))
    return {"dense_ms": _median(associate), "dense_fuse_ms": _median(fuse)}


def _dense_object(record: ObjectRecord, feature: F32) -> DenseObject:
    return DenseObject(record.cloud.points, record.cloud.colors, feature, record.observations, [])


def _lifting(masks: int) -> Row:
    """What perception pays before, for a frame of 1200 x 680 pixels; denoising is not counted in the rest."""
    row = measure_lifting(masks)
    denoise = float(row["denoise_ms"])
    return {"lift_ms": round(float(row["lift_ms"]) - denoise, 2), "denoise_ms": denoise}


def _bytes_of(word: bytes | str | int) -> int:
    return len(word if isinstance(word, bytes) else str(word).encode())


def _median(samples_ms: Sequence[float]) -> float:
    return round(float(np.median(samples_ms)), 3)


def _ms_since(began: float) -> float:
    return (time.perf_counter() - began) * 1e3
