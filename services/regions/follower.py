"""The stage that turns detections and map into partitions: one scene at a time, each frame's depth counted
once.

What lies between two checkpoints is in memory only; after a crash it is gathered again from the detections
log, from the log id that the last checkpoint names, into the same counts. Where what was kept is damaged, the
evidence is gathered again from the start of that log, and the floors are cut anew.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ovip.codec import decode_detection_batch
from ovip.errors import Corrupt, InvalidInput, NotFound, OvipError
from ovip.keys import log_order
from ovip.stages import holding, new_owner
from ovip.store import Entry, Lease, Store
from ovip.store.store import START
from ovip.telemetry import get_logger
from services.regions import metrics
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.pace import PaceParams, is_due
from services.regions.grouping import FloorGrouping
from services.regions.map_view import MapView
from services.regions.partitioner import CutParams, Made, Partitioner
from services.regions.ports import Grouper, MapReader
from services.regions.shelf import DETECTIONS, MAP, STAGE, Answered, Checkpoint, Gathered, Shelf

_ENTRIES_AT_ONCE = 16
_IDLE_MS = 300
_RETRY_S = 3.0
log = get_logger("regions")


@dataclass(slots=True)
class _Scene:
    """What the follower knows of its scene. Times are readings of the clock, in seconds.

    unsaved: frames since the last checkpoint. first_change, last_change: of those that no partition has seen, if any.
    """

    lease: Lease
    step: int
    gathered: Gathered
    answered: Answered
    view: MapView
    partitioner: Partitioner
    unsaved: int = 0
    first_change: float | None = None
    last_change: float = 0.0
    partitioned_at: float = -np.inf
    not_before: float = -np.inf

    @property
    def name(self) -> str:
        return self.lease.scene


class RegionsFollower:
    """Follows scenes; `follow` is the work of one of them."""

    def __init__(
        self,
        store: Store,
        mapper: MapReader,
        groupers: Sequence[Grouper],
        pace: PaceParams,
        params: CutParams,
        checkpoint_frames: int,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """groupers: the first that does not raise names the functions; the last must not."""
        self._store = store
        self._shelf = Shelf(store)
        self._mapper = mapper
        self._grouping = FloorGrouping(groupers)
        self._pace = pace
        self._params = params
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
                idle = not await self._read_on(here, _IDLE_MS)
                if wish > here.answered.wish or _is_behind(here):
                    await self._catch_up(here)
                if self._is_due(here, wish):
                    await self._partition(here, wish)
                await self._maybe_checkpoint(here, idle)

    async def _load(self, lease: Lease) -> _Scene:
        gathered = await self._shelf.gathered(lease.scene)
        answered = await self._shelf.answered(lease.scene)
        view = MapView(lease.scene, self._mapper, answered.map_after)
        partitioner = Partitioner(view, self._grouping, self._params)
        step = await self._shelf.step(lease.scene)
        here = _Scene(lease, step, gathered, answered, view, partitioner)
        for what, reason in (("evidence", gathered.lost), ("partition", answered.lost)):
            if reason:
                metrics.LOST.labels(what).inc()
                log.error("kept_state_lost", scene=here.name, what=what, reason=reason)
                self._note_change(here)
        if partitioner.would_cut_otherwise(answered) or gathered.after != answered.detections_after:
            self._note_change(here)
        return here

    async def _read_on(self, here: _Scene, block_ms: int | None) -> bool:
        """Takes in the next entries of both logs, waiting for one where told to; whether there were any."""
        after = {DETECTIONS: here.gathered.after, MAP: here.view.after}
        found = await self._store.read_any(here.name, after, _ENTRIES_AT_ONCE, block_ms)
        if found[DETECTIONS]:
            await self._gather(here, found[DETECTIONS])
        if here.view.look_at(found[MAP]):
            self._note_change(here)
        return any(found.values())

    async def _gather(self, here: _Scene, entries: Sequence[Entry]) -> None:
        """Adds batches to the evidence; late ones bring no depth."""
        frames = [entry for entry in entries if entry.fields.get("kind") != b"late"]
        data = await asyncio.gather(*(self._bytes_of(here.name, entry) for entry in frames))
        batches = {entry.id: one for entry, one in zip(frames, data, strict=True) if one is not None}
        added = await asyncio.to_thread(_add, here.gathered.evidence, batches)
        here.gathered = replace(here.gathered, after=entries[-1].id)
        here.unsaved += added
        if added:
            self._note_change(here)

    async def _bytes_of(self, scene: str, entry: Entry) -> bytes | None:
        """A batch as it was stored; None for one that is not there any more."""
        try:
            return await self._store.blobs.get(entry.fields["batch"].decode())
        except (Corrupt, InvalidInput, NotFound) as error:
            metrics.SKIPPED.inc()
            log.error("batch_skipped", scene=scene, entry=entry.id, reason=str(error))
            return None

    async def _catch_up(self, here: _Scene) -> None:
        """Takes in all that the logs hold by now; what comes meanwhile does not hold it up."""
        newest = [(await self._store.newest(here.name, stream)) for stream in (DETECTIONS, MAP)]
        frames_end, map_end = (log_order(entries[0].id if entries else START) for entries in newest)
        while log_order(here.gathered.after) < frames_end or log_order(here.view.after) < map_end:
            _leave_where_cancelled()
            await self._read_on(here, None)
            await self._maybe_checkpoint(here, idle=False)

    def _note_change(self, here: _Scene) -> None:
        here.last_change = self._clock()
        if here.first_change is None:
            here.first_change = here.last_change

    def _is_due(self, here: _Scene, wish: int) -> bool:
        now = self._clock()
        if now < here.not_before:
            return False
        if wish > here.answered.wish:
            return True
        if here.first_change is None:
            return False
        return is_due(now - here.first_change, now - here.last_change, now - here.partitioned_at, self._pace)

    async def _partition(self, here: _Scene, wish: int) -> None:
        """Partitions and publishes; where the map cannot be read now, tries again a little later."""
        began = self._clock()
        try:
            made = await here.partitioner.partition(here.gathered, here.answered, wish)
        except OvipError as error:
            log.warning("partition_put_off", scene=here.name, reason=str(error))
            here.not_before = self._clock() + _RETRY_S
            return
        is_called_for = made.differs or wish > here.answered.wish or bool(here.answered.lost)
        await (self._publish(here, made) if is_called_for else self._keep(here, made))
        here.first_change, here.partitioned_at = None, self._clock()
        metrics.PARTITION_SECONDS.observe(here.partitioned_at - began)
        metrics.STALE_FLOORS.inc(made.stale)
        metrics.KEPT_FLOORS.inc(made.kept)

    async def _publish(self, here: _Scene, made: Made) -> None:
        here.step += 1
        with metrics.STEP_SECONDS.labels("save").time():
            await self._shelf.save_answered(here.lease, here.step, made.answered)
        here.answered = made.answered
        partition = made.answered.cut.partition
        metrics.PARTITIONS.inc()
        for event in partition.events:
            metrics.EVENTS.labels(event.kind).inc()
        log.info(
            "partitioned",
            scene=here.name,
            revision=partition.revision,
            map_version=partition.map_version,
            floors_cut=made.stale,
            floors_kept=made.kept,
            regions=[region.display_name for region in partition.regions],
            events=len(partition.events),
        )

    async def _keep(self, here: _Scene, made: Made) -> None:
        """Nothing to publish: the partition stays the one that readers have, with what it is now known to stand on."""
        metrics.UNCHANGED.inc()
        if made.answered.memory != here.answered.memory:
            here.step += 1
            await self._shelf.save_memory(here.lease, here.step, made.answered)
        here.answered = replace(made.answered, cut=here.answered.cut)

    async def _maybe_checkpoint(self, here: _Scene, idle: bool) -> None:
        quiet = idle and self._clock() - here.last_change >= self._pace.quiet_s
        if here.unsaved >= self._checkpoint_frames or (here.unsaved and quiet):
            await self._checkpoint(here)

    async def _checkpoint(self, here: _Scene) -> None:
        base = Checkpoint() if here.gathered.checkpoint.is_outgrown else here.gathered.checkpoint
        segment = await asyncio.to_thread(here.gathered.evidence.segment, base.frames)
        here.step += 1
        checkpoint = await self._shelf.save_gathered(here.lease, here.step, here.gathered, segment, base)
        here.gathered = replace(here.gathered, checkpoint=checkpoint)
        here.unsaved = 0
        metrics.CHECKPOINT_BYTES.inc(checkpoint.sizes[-1])


def _is_behind(here: _Scene) -> bool:
    """Whether the last partition saw frames that the evidence does not have: a checkpoint is older than it."""
    return log_order(here.gathered.after) < log_order(here.answered.detections_after)


def _leave_where_cancelled() -> None:
    """`asyncio.wait_for` of Python 3.11, under the store's client, may swallow a cancellation: found again here."""
    task = asyncio.current_task()
    if task is not None and task.cancelling():
        raise asyncio.CancelledError


def _add(evidence: FloorEvidence, batches: Mapping[str, bytes]) -> int:
    """Adds the frames that are new and can be read, given by their entries' ids; how many were."""
    before = evidence.revision
    for entry, data in batches.items():
        try:
            batch = decode_detection_batch(data)
            evidence.add(batch.frame_id, batch.surface, batch.world_from_camera[:3, 3])
        except (Corrupt, InvalidInput) as error:
            metrics.SKIPPED.inc()
            log.error("frame_skipped", entry=entry, reason=str(error))
    metrics.FRAMES.inc(evidence.revision - before)
    return evidence.revision - before
