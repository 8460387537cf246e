"""The one writer of a scene's map: each batch, edit, upkeep and change of settings is a step, committed once."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass

from ovip.errors import Conflict, Corrupt, InvalidInput, NotFound, OvipError, Unavailable
from ovip.stages import holding, new_owner
from ovip.store import Append, Entry, Lease, Store
from ovip.telemetry import get_logger
from services.mapper.counting import ShownCount
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams, params_json
from services.mapper.history import MAP, SNAPSHOTS, STAGE, VERSION, MapAt
from services.mapper.journal import (
    FrameInput,
    SettingsInput,
    Step,
    StepInput,
    UpkeepInput,
    entry_id,
)
from services.mapper.open_maps import OpenMaps, to_its_end
from services.mapper.requests import EDITS, done_at, input_of, refused_for, verdict_name
from services.mapper.snapshots import Snapshot, next_segment
from services.mapper.steps import Doing, prepared

DETECTIONS = "detections"
CURSOR = "cursor"
_CURSORS = {DETECTIONS: CURSOR, EDITS: "edits"}
_INPUTS_A_READ = 8
_BUGS = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
log = get_logger("mapper")


@dataclass(frozen=True, slots=True)
class Pace:
    """snapshot_every: versions between snapshots.

    settle_after_s: idle seconds after which upkeep looks at the rest; 0: never, so that the same frames give the same
    map to the bit however long a robot pauses between them.
    """

    snapshot_every: int = 50
    settle_after_s: float = 0.0


class Writer:
    """Writes scenes' maps while it holds their leases."""

    def __init__(self, store: Store, maps: OpenMaps, params: MapParams, pace: Pace) -> None:
        self._store = store
        self._maps = maps
        self._params = params
        self._pace = pace
        self._owner = new_owner()

    async def follow(self, scene: str) -> None:
        """Writes a scene's map: every input once, for ever."""
        async with holding(self._store, scene, STAGE, self._owner) as lease:
            await _Following(self._store, self._maps, self._params, self._pace, lease).run()


class _Following:
    """One scene, from taking its lease to losing it."""

    def __init__(self, store: Store, maps: OpenMaps, params: MapParams, pace: Pace, lease: Lease) -> None:
        self._store = store
        self._maps = maps
        self._params = params
        self._pace = pace
        self._lease = lease
        self._scene = lease.scene
        self._shown = ShownCount()
        self._has_our_settings = self._upkeep_due = self._unsettled = False
        self._version = self._snapshot_at = 0

    async def run(self) -> None:
        async with self._maps.reading(self._scene) as current:
            self._snapshot_at = (current.base.version if current.base else 0) + self._pace.snapshot_every
            self._look_at(current.objects)
        if self._version:
            await self._keep_settings()
        if self._upkeep_due:  # a writer before this one ended between a frame and its upkeep
            await self._take_step(UpkeepInput())
        await self._take_in_all()

    async def _take_in_all(self) -> None:
        cursors = await self._store.cursors(self._scene, STAGE, list(_CURSORS.values()))
        after = {stream: cursors[name] for stream, name in _CURSORS.items()}
        clock = asyncio.get_running_loop().time
        idle_since = clock()
        while True:
            found = await self._store.read_any(self._scene, after, _INPUTS_A_READ, block_ms=1000)
            for stream in (EDITS, DETECTIONS):  # an operator waits, a frame does not
                for entry in found[stream]:
                    await self._take_in(stream, entry)
                    after[stream], idle_since = entry.id, clock()
            idle = clock() - idle_since
            if self._unsettled and 0 < self._pace.settle_after_s <= idle:
                await self._take_step(UpkeepInput())

    async def _take_in(self, stream: str, entry: Entry) -> None:
        await self._keep_settings()
        await (self._take_edit(entry) if stream == EDITS else self._take_frame(entry))
        if self._version >= self._snapshot_at:
            await self._take_snapshot()

    async def _take_frame(self, entry: Entry) -> None:
        source = FrameInput(entry.id, entry.fields["batch"].decode())
        step = await self._take_step(source, {CURSOR: entry.id})
        if isinstance(step.input, FrameInput) and step.input.refused:
            log.error("batch_refused", frame_id=step.delta.frame_id, reason=step.input.refused)

    async def _take_edit(self, entry: Entry) -> None:
        """An operator's edit: done or refused, either for good."""
        try:
            do = await prepared(self._store.blobs, input_of(entry))
        except (Corrupt, InvalidInput, NotFound) as reason:
            await self._refuse(entry, reason)
            return
        try:
            await self._do_edit(entry, do)
        except _BUGS as bug:  # in the editing: no reason to stop the frames behind it
            log.exception("edit_failed", scene=self._scene, entry=entry.id)
            await self._refuse(entry, OvipError(f"the mapper failed at this edit: {bug!r}"[:300]))

    async def _do_edit(self, entry: Entry, do: Doing) -> None:
        async with self._maps.changing(self._scene) as current:
            try:
                step = await asyncio.to_thread(do, current.objects)
            except (Conflict, Corrupt, InvalidInput, NotFound) as reason:  # the map is as it was
                await self._refuse(entry, reason)
            else:
                verdict = {_verdict_on(entry): done_at(step.delta.version)}
                await self._commit(current, step, {_CURSORS[EDITS]: entry.id}, verdict)

    async def _refuse(self, entry: Entry, reason: OvipError) -> None:
        log.info("edit_refused", scene=self._scene, entry=entry.id, reason=str(reason))
        verdict = {_verdict_on(entry): refused_for(reason)}
        await self._store.commit(self._lease, {_CURSORS[EDITS]: entry.id}, (), verdict)

    async def _keep_settings(self) -> None:
        """From here on the map has this process' settings, and its log says so."""
        if self._has_our_settings:
            return
        async with self._maps.reading(self._scene) as current:
            differ = current.objects.version == 0 or current.objects.params != self._params
        if differ:
            await self._take_step(SettingsInput(params_json(self._params)))
        self._has_our_settings = True

    async def _take_step(self, source: StepInput, cursors: Mapping[str, str] | None = None) -> Step:
        do = await prepared(self._store.blobs, source)
        async with self._maps.changing(self._scene) as current:
            step = await asyncio.to_thread(do, current.objects)
            await self._commit(current, step, cursors or {}, {})
        return step

    async def _commit(
        self, current: MapAt, step: Step, cursors: Mapping[str, str], puts: Mapping[str, str]
    ) -> None:
        """The step for good; then, where it is due, upkeep, as a step of its own.

        Upkeep is due by the number of batches alone, whatever waits: the same frames make the same map, however fast
        they came and wherever a crash fell. Their own commits, which robots wait for, come before it.
        """
        await self._append(current, step, cursors, puts)
        if current.objects.upkeep_due:
            do = await prepared(self._store.blobs, UpkeepInput())
            await self._append(current, await asyncio.to_thread(do, current.objects), {}, {})

    async def _append(
        self, current: MapAt, step: Step, cursors: Mapping[str, str], puts: Mapping[str, str]
    ) -> None:
        """One version, in one commit: its size is that of what it changed, whatever the map's."""
        objects, at = current.objects, entry_id(step.delta.version)
        done = await self._store.commit(
            self._lease,
            {**cursors, VERSION: at},
            [Append(MAP, step.fields(), at)],
            {
                VERSION: objects.version,
                "frames": objects.frames,
                "detections": objects.detections,
                "objects": self._shown.count(objects, step.delta),
                **puts,
            },
        )
        if not done.applied:
            raise Conflict(f"scene {self._scene}: version {objects.version} was already committed")
        current.applied = cursors.get(CURSOR, current.applied)
        self._look_at(objects)

    def _look_at(self, objects: ObjectMap) -> None:
        self._version = objects.version
        self._upkeep_due, self._unsettled = objects.upkeep_due, objects.changed_since_upkeep

    async def _take_snapshot(self) -> None:
        """What changed since the last snapshot, in a blob; then the log says so. It can fail: the journal is whole."""
        async with self._maps.reading(self._scene) as current:
            segment, since = await to_its_end(next_segment, current.objects, current.base)
            state_hash = await to_its_end(current.objects.state_hash)
            version, applied = current.objects.version, current.applied
        self._snapshot_at = version + self._pace.snapshot_every
        try:
            refs = (*(since.segments if since else ()), await self._store.blobs.put(segment))
            sizes = (*(since.sizes if since else ()), len(segment))
            snapshot = Snapshot(version, refs, sizes, state_hash, applied)
            at = entry_id(version)
            await self._store.commit(
                self._lease, {"snapshot": at}, [Append(SNAPSHOTS, snapshot.fields(), at)]
            )
        except Unavailable as error:
            log.warning("snapshot_not_taken", scene=self._scene, version=version, reason=str(error))
        else:
            current.base = snapshot


def _verdict_on(entry: Entry) -> str:
    return verdict_name(entry.fields.get("edit_id", b"").decode(errors="replace"))
