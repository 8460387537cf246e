"""The stage that turns detections and map into partitions: one scene at a time, each frame's depth counted
once.

What lies between two checkpoints is in memory only; after a crash it is gathered again from the detections
log, from the log id that the last checkpoint names, into the same counts.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ovip.codec import decode_detection_batch
from ovip.errors import Corrupt, InvalidInput, LeaseLost, NotConfigured, NotFound, OvipError
from ovip.scene.types import DetectionBatch, SceneMap
from ovip.stages import holding, new_owner
from ovip.store import Entry, Lease, Store
from ovip.telemetry import get_logger
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.pace import PaceParams, is_due
from services.regions.domain.partition import PartitionParams
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects, survey
from services.regions.metrics import FALLBACKS, FRAMES, PARTITION_SECONDS, PARTITIONS, SKIPPED
from services.regions.ports import Grouper, Grouping, MapReader
from services.regions.shelf import DETECTIONS, MAP, STAGE, Answered, Gathered, Shelf

_BATCHES_AT_ONCE = 16
_DELTAS_AT_ONCE = 1000
_IDLE_MS = 300
_RETRY_S = 3.0
log = get_logger("regions")


@dataclass(slots=True)
class _Scene:
    """What the follower knows of its scene. Times are readings of the clock, in seconds."""

    lease: Lease
    step: int
    gathered: Gathered
    answered: Answered
    map_after: str
    unsaved: int = 0
    changes: int = 0
    changed_at: float = 0.0
    partitioned_at: float = -np.inf
    not_before: float = -np.inf
    functions: dict[int, tuple[tuple[object, ...], Grouping]] = field(default_factory=dict)


class RegionsFollower:
    """Follows scenes; `follow` is the work of one of them."""

    def __init__(
        self,
        store: Store,
        mapper: MapReader,
        groupers: Sequence[Grouper],
        pace: PaceParams,
        partition: PartitionParams,
        checkpoint_frames: int,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """groupers: the first that does not raise names the functions; the last must not."""
        self._store = store
        self._shelf = Shelf(store)
        self._mapper = mapper
        self._groupers = groupers
        self._pace = pace
        self._partition_params = partition
        self._checkpoint_frames = checkpoint_frames
        self._clock = clock
        self._owner = new_owner()

    async def follow(self, scene: str) -> None:
        """Gathers evidence as it comes and partitions when enough has changed, for ever."""
        async with holding(self._store, scene, STAGE, self._owner) as lease:
            here = await self._load(lease)
            while True:
                _leave_where_cancelled()
                wish = await self._shelf.wish(scene)
                idle = not await self._gather(here)
                await self._look_at_map(here, _IDLE_MS if idle else None)
                if wish > here.answered.wish:
                    await self._catch_up(here)
                if self._is_due(here, wish):
                    await self._partition(here, wish)
                await self._maybe_checkpoint(here, idle)

    async def _load(self, lease: Lease) -> _Scene:
        gathered = await self._shelf.gathered(lease.scene)
        answered = await self._shelf.answered(lease.scene)
        return _Scene(lease, await self._shelf.step(lease.scene), gathered, answered, answered.map_after)

    async def _gather(self, here: _Scene) -> int:
        """Adds the next batches of the detections log to the evidence; how many there were."""
        scene = here.lease.scene
        entries = await self._store.read(scene, DETECTIONS, here.gathered.after, count=_BATCHES_AT_ONCE)
        batches = [batch for entry in entries if (batch := await self._batch(scene, entry)) is not None]
        if batches:
            added = await asyncio.to_thread(_add, here.gathered.evidence, batches)
            here.unsaved += added
            self._note_changes(here, added)
        if entries:
            here.gathered = replace(here.gathered, after=entries[-1].id)
        return len(entries)

    async def _batch(self, scene: str, entry: Entry) -> DetectionBatch | None:
        """A frame's own batch; None for late ones, which bring no depth, and for one that cannot be read."""
        if entry.fields.get("kind") == b"late":
            return None
        try:
            return decode_detection_batch(await self._store.blobs.get(entry.fields["batch"].decode()))
        except (Corrupt, InvalidInput, NotFound) as error:
            SKIPPED.inc()
            log.error("batch_skipped", scene=scene, entry=entry.id, reason=str(error))
            return None

    async def _look_at_map(self, here: _Scene, block_ms: int | None) -> None:
        deltas = await self._store.read(here.lease.scene, MAP, here.map_after, _DELTAS_AT_ONCE, block_ms)
        if deltas:
            here.map_after = deltas[-1].id
            self._note_changes(here, len(deltas))

    async def _catch_up(self, here: _Scene) -> None:
        while await self._gather(here):
            pass
        await self._look_at_map(here, None)

    def _note_changes(self, here: _Scene, count: int) -> None:
        here.changes += count
        here.changed_at = self._clock()

    def _is_due(self, here: _Scene, wish: int) -> bool:
        now = self._clock()
        if now < here.not_before:
            return False
        return wish > here.answered.wish or is_due(
            here.changes, now - here.changed_at, now - here.partitioned_at, self._pace
        )

    async def _partition(self, here: _Scene, wish: int) -> None:
        """Partitions and publishes; where the map cannot be read now, tries again a little later."""
        began = self._clock()
        if wish > here.answered.wish:
            here.functions.clear()
        try:
            cut = await self._cut(here)
        except LeaseLost:
            raise
        except OvipError as error:
            log.warning("partition_put_off", scene=here.lease.scene, reason=str(error))
            here.not_before = self._clock() + _RETRY_S
            return
        here.answered = Answered(cut, here.map_after, wish)
        here.step += 1
        await self._shelf.save_answered(here.lease, here.step, here.answered)
        here.changes, here.partitioned_at = 0, self._clock()
        PARTITIONS.inc()
        PARTITION_SECONDS.observe(self._clock() - began)
        log.info(
            "partitioned",
            scene=here.lease.scene,
            revision=cut.partition.revision,
            map_version=cut.partition.map_version,
            regions=[region.display_name for region in cut.partition.regions],
        )

    async def _cut(self, here: _Scene) -> Cut:
        scene_map = await self._mapper.get_map(here.lease.scene)
        objects = placed(scene_map)
        evidence = here.gathered.evidence
        surveyed = await asyncio.to_thread(survey, evidence)
        grouping = await self._group(here, surveyed, objects)
        cut = await asyncio.to_thread(
            assemble,
            surveyed,
            objects,
            grouping.functions,
            evidence.cameras,
            here.answered.cut,
            self._partition_params,
        )
        partition = replace(cut.partition, map_version=scene_map.version, fallbacks=grouping.fallbacks)
        return replace(cut, partition=partition)

    async def _group(
        self, here: _Scene, surveyed: tuple[SurveyedStorey, ...], objects: PlacedObjects
    ) -> Grouping:
        """All objects' functions: one question a floor, asked again only where its objects changed."""
        functions = [""] * len(objects.ids)
        fallbacks: list[str] = []
        storeys = storeys_of_objects(surveyed, objects.centres)
        for storey in sorted(set(storeys.tolist())):
            members = np.flatnonzero(storeys == storey)
            floor = objects.only(members)
            likeness = (floor.ids, floor.labels, tuple(np.round(floor.centres * 2).ravel().tolist()))
            if here.functions.get(storey, ((), None))[0] != likeness:
                here.functions[storey] = (likeness, await self._ask(floor))
            grouping = here.functions[storey][1]
            for member, function in zip(members.tolist(), grouping.functions, strict=True):
                functions[member] = function
            fallbacks += [text for text in grouping.fallbacks if text not in fallbacks]
        return Grouping(tuple(functions), tuple(fallbacks))

    async def _ask(self, floor: PlacedObjects) -> Grouping:
        *better, last = self._groupers
        reasons: list[str] = []
        for grouper in better:
            try:
                grouping = await grouper.group(floor)
                return replace(grouping, fallbacks=(*reasons, *grouping.fallbacks))
            except OvipError as error:
                FALLBACKS.inc()
                log.info("grouping_fell_back", slug=error.slug, reason=str(error))
                reasons.append(f"grouping: function table, {_why(error)}")
        grouping = await last.group(floor)
        return replace(grouping, fallbacks=(*reasons, *grouping.fallbacks))

    async def _maybe_checkpoint(self, here: _Scene, idle: bool) -> None:
        quiet = idle and self._clock() - here.changed_at >= self._pace.quiet_s
        if here.unsaved >= self._checkpoint_frames or (here.unsaved and quiet):
            data = await asyncio.to_thread(here.gathered.evidence.to_bytes)
            here.step += 1
            await self._shelf.save_gathered(here.lease, here.step, here.gathered, data)
            here.unsaved = 0


def placed(scene_map: SceneMap) -> PlacedObjects:
    """The map's objects by id, as a partition needs them."""
    objects = sorted(scene_map.objects, key=lambda o: o.object_id)
    return PlacedObjects(
        ids=tuple(o.object_id for o in objects),
        labels=tuple(o.label for o in objects),
        centres=np.array([o.centroid for o in objects], dtype=np.float64).reshape(-1, 3),
    )


def _why(error: OvipError) -> str:
    return "no VLM configured" if isinstance(error, NotConfigured) else f"VLM {error.slug}"


def _leave_where_cancelled() -> None:
    """`asyncio.wait_for` of Python 3.11, under the store's client, may swallow a cancellation: found again here."""
    task = asyncio.current_task()
    if task is not None and task.cancelling():
        raise asyncio.CancelledError


def _add(evidence: FloorEvidence, batches: list[DetectionBatch]) -> int:
    """Adds the frames that are new; how many were."""
    before = len(evidence.cameras)
    for batch in batches:
        try:
            evidence.add(batch.frame_id, batch.surface, batch.world_from_camera[:3, 3])
        except InvalidInput as error:
            SKIPPED.inc()
            log.error("frame_skipped", frame_id=batch.frame_id, reason=str(error))
    FRAMES.inc(len(evidence.cameras) - before)
    return len(evidence.cameras) - before
