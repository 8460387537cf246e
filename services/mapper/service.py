"""What the mapper does: keeps each scene's map by its log, and shows it."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import json
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.codec import decode_delta, decode_detection_batch, encode_delta
from ovip.errors import Corrupt, InvalidInput, NotFound
from ovip.keys import check_name, log_order
from ovip.scene.answers import SceneSummary
from ovip.scene.types import F32, U8, MapDelta, MapObject, SceneMap
from ovip.stages import holding, new_owner
from ovip.store import Append, Entry, Lease, Store
from ovip.telemetry import get_logger
from services.mapper.domain.object_map import MapParams, ObjectMap

STAGE = "mapper"
DETECTIONS, MAP = "detections", "map"
_BATCHES_A_READ = 16
log = get_logger("mapper")


@dataclass(slots=True)
class _Open:
    """A scene's map in memory, as of an entry of the detections log."""

    objects: ObjectMap
    cursor: str
    hash: str = ""

    def state_hash(self) -> str:
        """The map's hash, computed once a version."""
        version, _, digest = self.hash.partition(":")
        if version != str(self.objects.version):
            digest = self.objects.state_hash()
            self.hash = f"{self.objects.version}:{digest}"
        return digest


class Mapper:
    """Every scene's map; one process writes a scene, any process can read it."""

    def __init__(self, store: Store, params: MapParams, snapshot_every: int) -> None:
        self._store = store
        self._params = params
        self._snapshot_every = snapshot_every
        self._owner = new_owner()
        self._open: dict[str, _Open] = {}
        self._busy: dict[str, asyncio.Lock] = {}

    async def follow(self, scene: str) -> None:
        """Writes a scene's map: integrates each batch of the detections log once, for ever."""
        async with holding(self._store, scene, STAGE, self._owner) as lease:
            cursor = await self._store.cursor(scene, STAGE)
            while True:
                for entry in await self._store.read(
                    scene, DETECTIONS, cursor, _BATCHES_A_READ, block_ms=1000
                ):
                    async with self._up_to_date(scene) as current:
                        await self._step(lease, current, entry)
                    cursor = entry.id

    async def list_scenes(self) -> list[SceneSummary]:
        """All scenes with their sizes."""
        summaries = []
        for scene in await self._store.scenes():
            async with self._up_to_date(scene) as current:
                o = current.objects
                summaries.append(SceneSummary(scene, o.version, len(o.objects()), o.frames, o.detections))
        return summaries

    async def get_map(self, scene: str, include_unconfirmed: bool) -> SceneMap:
        """The map as it stands; empty, not an error, before the first frame."""
        await self._check_known(scene)
        async with self._up_to_date(scene) as current:
            objects = current.objects
            return SceneMap(
                scene=scene,
                version=objects.version,
                objects=objects.objects(include_unconfirmed),
                state_hash=current.state_hash(),
                frames=objects.frames,
                detections=objects.detections,
                applied_log_id=current.cursor,
            )

    async def get_object(self, scene: str, object_id: str) -> tuple[MapObject, int]:
        """One object, by its id or an alias, and the map's version."""
        await self._check_known(scene)
        async with self._up_to_date(scene) as current:
            found, version = current.objects.find(object_id), current.objects.version
        if found is None:
            raise NotFound(f"object {object_id[:80]!r} is not in scene {scene} at version {version}")
        return found, version

    async def get_points(
        self, scene: str, object_ids: Sequence[str], max_points: int
    ) -> tuple[int, dict[str, tuple[F32, U8]]]:
        """The map's version, and points and colours of objects (none named: all confirmed), evenly thinned."""
        await self._check_known(scene)
        async with self._up_to_date(scene) as current:
            objects = current.objects
            clouds: dict[str, tuple[F32, U8]] = {}
            for object_id in object_ids or [o.object_id for o in objects.objects()]:
                cloud = objects.cloud_of(object_id)
                if cloud is None:
                    raise NotFound(
                        f"object {object_id[:80]!r} is not in scene {scene} at version {objects.version}"
                    )
                clouds[object_id] = cloud
            return objects.version, _thinned(clouds, max_points)

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        """Deltas above a version, then live ones, for ever."""
        await self._check_known(scene)
        after = "0-0"
        while True:
            for entry in await self._store.read(scene, MAP, after, count=200, block_ms=1000):
                after = entry.id
                if int(entry.fields["version"]) > after_version:
                    yield decode_delta(entry.fields["delta"])

    async def _step(self, lease: Lease, current: _Open, entry: Entry) -> None:
        if log_order(entry.id) <= log_order(current.cursor):
            return
        try:
            delta = await self._integrate(current, entry)
            puts: dict[str, bytes | str | int] = {"version": delta.version}
            if delta.version % self._snapshot_every == 0:
                ref = await self._store.blobs.put(await asyncio.to_thread(current.objects.snapshot))
                puts["snapshot"] = json.dumps({"blob": ref, "cursor": entry.id})
            fields: dict[str, bytes | str | int] = {
                "version": delta.version,
                "frame_id": delta.frame_id,
                "delta": encode_delta(delta),
            }
            await self._store.commit(lease, entry.id, [Append(MAP, fields)], puts)
        except BaseException:
            # memory may be ahead of the log now, and the log is the truth
            self._open.pop(lease.scene, None)
            raise

    @contextlib.asynccontextmanager
    async def _up_to_date(self, scene: str) -> AsyncIterator[_Open]:
        """The scene's map as of the last commit, nobody changing it meanwhile.

        From memory, else the last snapshot, and the detections log since: what the writer does, read-only.
        """
        async with self._busy.setdefault(scene, asyncio.Lock()):
            try:
                current = await self._caught_up(scene)
            except BaseException:
                # interrupted (a caller who hung up, say), it may hold a batch that its cursor does not name
                self._open.pop(scene, None)
                raise
            yield current

    async def _caught_up(self, scene: str) -> _Open:
        if scene not in self._open:
            self._open[scene] = await self._from_snapshot(scene)
        current = self._open[scene]
        cursor = await self._store.cursor(scene, STAGE)
        while log_order(current.cursor) < log_order(cursor):
            entries = await self._store.read(scene, DETECTIONS, current.cursor, _BATCHES_A_READ)
            if not entries:
                raise Corrupt(
                    f"scene {scene}: the detections log ends before {cursor}, which the map has seen"
                )
            for entry in entries:
                if log_order(entry.id) <= log_order(cursor):
                    await self._integrate(current, entry)
        return current

    async def _integrate(self, current: _Open, entry: Entry) -> MapDelta:
        """One batch into the map. Detections that cannot be the map's are left out, the same in every replay."""
        batch = decode_detection_batch(await self._store.blobs.get(entry.fields["batch"].decode()))
        try:
            delta = await asyncio.to_thread(current.objects.integrate, batch)
        except InvalidInput as error:
            log.error("batch_refused", frame_id=batch.frame_id, reason=str(error))
            delta = await asyncio.to_thread(
                current.objects.integrate, dataclasses.replace(batch, detections=())
            )
        current.cursor = entry.id
        return delta

    async def _from_snapshot(self, scene: str) -> _Open:
        values = await self._store.values(scene, STAGE, ["snapshot"])
        if "snapshot" not in values:
            return _Open(ObjectMap(self._params), "0-0")
        pointer = json.loads(values["snapshot"])
        data = await self._store.blobs.get(pointer["blob"])
        return _Open(await asyncio.to_thread(ObjectMap.restore, data, self._params), pointer["cursor"])

    async def _check_known(self, scene: str) -> None:
        check_name(scene, "scene")
        scenes = await self._store.scenes()
        if scene not in scenes:
            raise NotFound(f"there is no scene {scene!r}; known: {', '.join(scenes) or 'none yet'}")


def _thinned(clouds: dict[str, tuple[F32, U8]], max_points: int) -> dict[str, tuple[F32, U8]]:
    total = sum(len(points) for points, _ in clouds.values())
    if not max_points or total <= max_points:
        return clouds
    least = int(len(clouds) <= max_points)  # a point for each, where there are enough
    share = (max_points - least * len(clouds)) / total
    thin = {}
    for object_id, (points, colors) in clouds.items():
        pick = np.linspace(0, len(points) - 1, least + int(len(points) * share)).astype(np.int64)
        thin[object_id] = (points[pick], colors[pick])
    return thin
