"""A map as of any version: from the newest snapshot at or below it, and the journal's steps since (DESIGN 3)."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field

from ovip.errors import Conflict, Corrupt, InvalidInput, NotFound, OvipError
from ovip.store import Store
from ovip.telemetry import get_logger
from services.mapper.domain.object_map import ObjectMap
from services.mapper.journal import FrameInput, Step, entry_id, step_of
from services.mapper.snapshots import Snapshot, snapshot_of
from services.mapper.steps import Doing, prepared

STAGE = "mapper"
MAP, SNAPSHOTS = "map", "snapshots"
VERSION = "version"
_STEPS_AT_ONCE = 16
log = get_logger("mapper")


@dataclass(slots=True)
class MapAt:
    """A map with what is known of where it stands. applied: last detections entry in it; base: newest snapshot."""

    objects: ObjectMap = field(default_factory=ObjectMap)
    applied: str = "0-0"
    base: Snapshot | None = None


class History:
    """Every version of every scene's map, read-only."""

    def __init__(self, store: Store) -> None:
        self._store = store

    async def newest_version(self, scene: str) -> int:
        """The version that the last commit made; 0 before the first."""
        return int((await self._store.values(scene, STAGE, [VERSION])).get(VERSION, 0))

    async def at(self, scene: str, version: int) -> MapAt:
        """The map as it stood at a version, one that was made."""
        made = await self._from_snapshot(scene, version)
        await self.advance(scene, made, version)
        return made

    async def advance(self, scene: str, current: MapAt, version: int) -> list[int]:
        """Does the steps that lead a map to a later version; those whose outcome is not what the journal says.

        Interrupted, it leaves the map anywhere on its way: it is of no use then.
        """
        differing: list[int] = []
        async for steps in self._steps(scene, current.objects.version, version):
            doings = await asyncio.gather(*(self._prepared(scene, step) for step in steps))
            differing += await asyncio.to_thread(_do_again, scene, current.objects, steps, doings)
            frames = [step.input.log_id for step in steps if isinstance(step.input, FrameInput)]
            current.applied = frames[-1] if frames else current.applied
        if current.objects.version != version:
            raise Corrupt(
                f"scene {scene}: the map log ends at version {current.objects.version}, "
                f"expected it to go on to {version}"
            )
        if differing:
            log.error("steps_differ_from_the_map_log", scene=scene, versions=differing[:10])
        return differing

    async def step(self, scene: str, version: int) -> Step:
        """The step that made a version."""
        entry = await self._store.read_entry(scene, MAP, entry_id(version))
        if entry is None:
            raise Corrupt(f"scene {scene}: the map log has no version {version}")
        return step_of(entry)

    async def snapshots(self, scene: str, version: int) -> list[Snapshot]:
        """All snapshots up to a version, oldest first."""
        found: list[Snapshot] = []
        after = entry_id(0)
        while entries := await self._store.between(scene, SNAPSHOTS, after, entry_id(version), 1000):
            found += [snapshot_of(entry) for entry in entries]
            after = entries[-1].id
        return found

    async def opened(self, snapshot: Snapshot) -> MapAt:
        """The map that a snapshot holds. NotFound, Corrupt or InvalidInput where it cannot be read."""
        segments = await asyncio.gather(*(self._store.blobs.get(ref) for ref in snapshot.segments))
        objects = await asyncio.to_thread(ObjectMap.restore, segments)
        if objects.version != snapshot.version:
            raise Corrupt(f"snapshot of version {snapshot.version}: its bytes are of {objects.version}")
        return MapAt(objects, snapshot.applied, snapshot)

    async def _from_snapshot(self, scene: str, version: int) -> MapAt:
        """The newest snapshot at or below a version that can be read; an empty map where none can."""
        while entry := await self._store.at_or_before(scene, SNAPSHOTS, entry_id(version)):
            try:
                return await self.opened(snapshot_of(entry))
            except (NotFound, Corrupt, InvalidInput) as error:
                log.error("snapshot_passed_over", scene=scene, snapshot=entry.id, reason=str(error))
                version = int(entry.id.partition("-")[0]) - 1
        return MapAt()

    async def _prepared(self, scene: str, step: Step) -> Doing:
        try:
            return await prepared(self._store.blobs, step.input)
        except (NotFound, Corrupt) as error:
            raise _unrepeatable(scene, step, error) from error

    async def _steps(self, scene: str, after: int, version: int) -> AsyncIterator[list[Step]]:
        at, last = entry_id(after), entry_id(version)
        while entries := await self._store.between(scene, MAP, at, last, _STEPS_AT_ONCE):
            yield [step_of(entry) for entry in entries]
            at = entries[-1].id
        if at == entry_id(0) and version:
            await self._refuse_old_log(scene)

    async def _refuse_old_log(self, scene: str) -> None:
        """Raises where the log's entries are those of an older mapper, whose ids were no versions."""
        for entry in await self._store.newest(scene, MAP):
            step_of(entry)


def _do_again(scene: str, objects: ObjectMap, steps: Sequence[Step], doings: Sequence[Doing]) -> list[int]:
    differing = []
    for step, do in zip(steps, doings, strict=True):
        expected = objects.version + 1
        if step.delta.version != expected:
            raise Corrupt(f"scene {scene}: the map log goes from {objects.version} to {step.delta.version}")
        try:
            done = do(objects)
        except (Conflict, Corrupt, InvalidInput, NotFound) as error:
            raise _unrepeatable(scene, step, error) from error
        if done != step:
            differing.append(expected)
    return differing


def _unrepeatable(scene: str, step: Step, error: OvipError) -> Corrupt:
    return Corrupt(
        f"scene {scene}: version {step.delta.version} of the map log, made by {step.delta.kind}, "
        f"cannot be made again: {error}"
    )
