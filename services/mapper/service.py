"""What the mapper does: keeps each scene's map by its log, shows it now and as it was, lets operators change it."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence

import numpy as np

from ovip.codec import decode_delta
from ovip.errors import InvalidInput, NotConfigured, NotFound
from ovip.keys import check_name
from ovip.scene.answers import SceneSummary
from ovip.scene.edits import EditRequest
from ovip.scene.types import F32, F64, U8, MapDelta, MapObject, SceneMap
from ovip.scene.versions import Alignment, MapDiff, Verification
from ovip.store import Store
from services.mapper.differences import changes_between
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams
from services.mapper.history import MAP, STAGE, VERSION, History, MapAt
from services.mapper.journal import entry_id
from services.mapper.open_maps import OpenMaps, to_its_end
from services.mapper.ports import Aligner
from services.mapper.requests import OperatorRequests, checked_transform
from services.mapper.surfaces import surface_of
from services.mapper.verifying import verified
from services.mapper.writer import Pace, Writer

__all__ = ["STAGE", "Mapper"]
_SIZES = (VERSION, "objects", "frames", "detections")


class Mapper:
    """Every scene's map; one process writes a scene, any process reads and edits it."""

    def __init__(
        self,
        store: Store,
        params: MapParams,
        snapshot_every: int = 50,
        settle_after_s: float = 0.0,
        answer_within_s: float = 20.0,
        aligner: Aligner | None = None,
    ) -> None:
        """answer_within_s: how long an edit waits for whoever writes the scene."""
        self._store = store
        self._history = History(store)
        self._maps = OpenMaps(self._history)
        self._requests = OperatorRequests(store, answer_within_s)
        self._writer = Writer(store, self._maps, params, Pace(snapshot_every, settle_after_s))
        self._aligner = aligner

    async def follow(self, scene: str) -> None:
        """Writes a scene's map, for ever: each batch, each edit, once."""
        await self._writer.follow(scene)

    # Reading

    async def list_scenes(self) -> list[SceneSummary]:
        """All scenes with their sizes; opens no map."""
        return [await self._summary(scene) for scene in await self._store.scenes()]

    async def get_map(
        self,
        scene: str,
        include_unconfirmed: bool = False,
        at_version: int = 0,
        include_departed: bool = False,
    ) -> SceneMap:
        """The map as it stands, or stood at a version; empty, not an error, before the first frame."""
        await self._check_known(scene)
        if at_version:
            past = await self._as_of(scene, at_version)
            return await to_its_end(_shown, scene, past, include_unconfirmed, include_departed)
        async with self._maps.reading(scene) as current:
            return await to_its_end(_shown, scene, current, include_unconfirmed, include_departed)

    async def get_object(self, scene: str, object_id: str) -> tuple[MapObject, int]:
        """One object, by its id or an alias, and the map's version."""
        await self._check_known(scene)
        async with self._maps.reading(scene) as current:
            found, version = current.objects.find(object_id), current.objects.version
            if found is None:
                raise _not_there(scene, object_id, current.objects)
        return found, version

    async def get_points(
        self, scene: str, object_ids: Sequence[str], max_points: int
    ) -> tuple[int, dict[str, tuple[F32, U8]]]:
        """The map's version, and points and colours of objects (none named: all that readers get), evenly thinned."""
        await self._check_known(scene)
        async with self._maps.reading(scene) as current:
            version, clouds = await to_its_end(_clouds, scene, current.objects, object_ids)
        return version, _thinned(clouds, max_points)

    async def watch(self, scene: str, after_version: int) -> AsyncIterator[MapDelta]:
        """Deltas above a version, then live ones, for ever."""
        await self._check_known(scene)
        after = entry_id(after_version)
        while True:
            for entry in await self._store.read(scene, MAP, after, count=200, block_ms=1000):
                after = entry.id
                yield decode_delta(entry.fields["delta"])

    # The past

    async def diff(self, scene: str, from_version: int, to_version: int = 0) -> MapDiff:
        """What readers get otherwise at a later version (0: as it stands) than at an earlier; departed objects, too."""
        await self._check_known(scene)
        last = to_version or await self._history.newest_version(scene)
        if not 0 <= from_version <= last:
            raise InvalidInput(f"from_version: expected 0 to {last}, the later version, got {from_version}")
        before, after = await self._as_of(scene, from_version), await self._as_of(scene, last)
        changes = await to_its_end(
            changes_between,
            before.objects.objects(include_departed=True),
            after.objects.objects(include_departed=True),
            after.objects.resolve,
        )
        return MapDiff(from_version, last, changes)

    async def verify(self, scene: str) -> Verification:
        """The map in use against the one that its whole log makes, from the first entry on."""
        await self._check_known(scene)
        async with self._maps.reading(scene) as current:
            version, in_use = current.objects.version, await to_its_end(current.objects.state_hash)
        return await verified(self._history, scene, version, in_use)

    async def _as_of(self, scene: str, version: int) -> MapAt:
        newest = await self._history.newest_version(scene)
        if not 0 <= version <= newest:
            raise InvalidInput(f"version: expected 0 to {newest}, the newest of scene {scene}, got {version}")
        return await self._history.at(scene, version)

    # Changing

    async def edit(self, scene: str, request: EditRequest) -> MapDelta:
        """An operator's edit, done by whoever writes the scene; the same `edit_id` again changes nothing.

        Conflict, NotFound or InvalidInput where it is refused; Unavailable where nobody decides in time.
        """
        await self._check_known(scene)
        await self._requests.submit_edit(scene, request)
        version = await self._requests.verdict(scene, request.edit_id)
        return (await self._history.step(scene, version)).delta

    async def join(
        self, scene: str, other_scene: str, world_from_other: F64, edit_id: str
    ) -> tuple[MapDelta, dict[str, str]]:
        """Another scene's objects, as they are now, into this one; also says which of its ids became which."""
        await self._check_known(scene)
        await self._check_known(other_scene)
        if scene == other_scene:
            raise InvalidInput(f"other_scene: expected another scene than {scene}")
        transform = checked_transform(world_from_other)
        known = await self._requests.known(scene, edit_id)
        whole = "" if known else await self._whole(other_scene)
        await self._requests.submit_join(scene, edit_id, other_scene, transform, whole)
        step = await self._history.step(scene, await self._requests.verdict(scene, edit_id))
        return step.delta, dict(step.ids)

    async def align(self, scene: str, other_scene: str, guess: F64 | None = None) -> Alignment:
        """How another scene's recording lies on this one's, by the surfaces that both saw."""
        await self._check_known(scene)
        await self._check_known(other_scene)
        if self._aligner is None:
            raise NotConfigured("this mapper has nothing to align scenes with")
        start = None if guess is None else checked_transform(guess)
        here, there = await surface_of(self._store, scene), await surface_of(self._store, other_scene)
        return await to_its_end(self._aligner.align, here, there, start)

    async def _whole(self, scene: str) -> str:
        """A blob with all of a scene's map as it stands."""
        async with self._maps.reading(scene) as current:
            segment = await to_its_end(current.objects.segment, 0)
        return await self._store.blobs.put(segment)

    async def _summary(self, scene: str) -> SceneSummary:
        values = await self._store.values(scene, STAGE, _SIZES)
        version, objects, frames, detections = (int(values.get(name, 0)) for name in _SIZES)
        return SceneSummary(scene, version, objects, frames, detections)

    async def _check_known(self, scene: str) -> None:
        check_name(scene, "scene")
        scenes = await self._store.scenes()
        if scene not in scenes:
            raise NotFound(f"there is no scene {scene!r}; known: {', '.join(scenes) or 'none yet'}")


def _shown(scene: str, current: MapAt, include_unconfirmed: bool, include_departed: bool) -> SceneMap:
    objects = current.objects
    return SceneMap(
        scene=scene,
        version=objects.version,
        objects=objects.objects(include_unconfirmed, include_departed),
        state_hash=objects.state_hash(),
        frames=objects.frames,
        detections=objects.detections,
        applied_log_id=current.applied,
    )


def _clouds(
    scene: str, objects: ObjectMap, object_ids: Sequence[str]
) -> tuple[int, dict[str, tuple[F32, U8]]]:
    clouds: dict[str, tuple[F32, U8]] = {}
    for object_id in object_ids or [o.object_id for o in objects.objects()]:
        cloud = objects.cloud_of(object_id)
        if cloud is None:
            raise _not_there(scene, object_id, objects)
        clouds[object_id] = cloud
    return objects.version, clouds


def _not_there(scene: str, object_id: str, objects: ObjectMap) -> NotFound:
    deleted = objects.deleted_at(object_id)
    if deleted:
        return NotFound(
            f"object {object_id[:80]!r} of scene {scene} was deleted by an operator at version {deleted}"
        )
    return NotFound(f"object {object_id[:80]!r} is not in scene {scene} at version {objects.version}")


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
