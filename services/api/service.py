"""The questions that the api answers, each by asking the service that owns the matter."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, AsyncIterator, Mapping, Sequence
from contextlib import aclosing
from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

from ovip.answer_json import WORLD, OutputFrame
from ovip.errors import NotFound, Unavailable
from ovip.scene.answers import (
    Answer,
    FrameRecord,
    GatewayStatus,
    PerceptionStatus,
    Query,
    SceneSummary,
    SearchEvent,
)
from ovip.scene.grid import FloorGrid
from ovip.scene.navigation import Route
from ovip.scene.route_graph import RouteGraph
from ovip.scene.types import F32, F64, U8, MapDelta, MapObject, Partition, RegionEvent, SceneMap
from ovip.scene.words import normalize_word
from services.api.domain.floorplan import PlanParams, draw_floorplans
from services.api.domain.plan_sheet import fits, plan_sheets
from services.api.domain.ply import PlyObject
from services.api.domain.point_cloud import pack_points
from services.api.ports import Backends

T = TypeVar("T")

_POINTS_A_CALL = 400_000
_QUEUED_EVENTS = 256
_LOOKS = 3


class FrameName(StrEnum):
    """The frame of reference that a caller speaks in."""

    WORLD = "world"
    SOURCE = "source"


@dataclass(frozen=True, slots=True)
class SceneDetail:
    """A scene at a glance."""

    summary: SceneSummary
    perception: PerceptionStatus
    partition: Partition


@dataclass(frozen=True, slots=True)
class SystemStatus:
    """Which services can be reached, and the VLM gateway's own account (None where it cannot)."""

    reachable: Mapping[str, bool]
    gateway: GatewayStatus | None


@dataclass(frozen=True, slots=True)
class Page(Generic[T]):
    """Part of a listing. end: where it ends; more: whether anything lay behind it when it was read."""

    items: tuple[T, ...]
    end: str
    more: bool


@dataclass(frozen=True, slots=True, eq=False)
class CutFloors:
    """A partition with grids of its floors that fit to it."""

    partition: Partition
    grids: tuple[FloorGrid, ...]


@dataclass(frozen=True, slots=True)
class RegionsChanged:
    """The partition of a scene has this revision now. events: what changed since the revision before."""

    revision: int
    map_version: int
    events: tuple[RegionEvent, ...] = ()


SceneEvent = MapDelta | RegionsChanged


class SceneService:
    """Reads scenes, asks questions, follows changes. Keeps nothing between two calls."""

    def __init__(self, backends: Backends) -> None:
        self._ask = backends
        self._drawing = asyncio.Semaphore(1)

    async def scenes(self) -> list[SceneSummary]:
        return sorted(await self._ask.objects.list_scenes(), key=lambda summary: summary.scene)

    async def summary(self, scene: str) -> SceneSummary:
        """One scene's line; NotFound names the scenes there are."""
        known = await self.scenes()
        for summary in known:
            if summary.scene == scene:
                return summary
        names = ", ".join(summary.scene for summary in known[:20]) or "none yet"
        raise NotFound(f"scene {scene!r}: no such scene; there are: {names}")

    async def detail(self, scene: str) -> SceneDetail:
        summary = await self.summary(scene)
        perception, partition = await asyncio.gather(self._ask.frames.status(scene), self.partition(scene))
        return SceneDetail(summary, perception, partition)

    async def output_frame(self, scene: str, name: FrameName) -> OutputFrame:
        """What turns positions into the caller's frame."""
        if name is FrameName.WORLD:
            return WORLD
        return OutputFrame((await self._ask.frames.status(scene)).world_from_source)

    async def scene_map(self, scene: str) -> SceneMap:
        return await self._ask.objects.get_map(scene)

    def objects(
        self, scene_map: SceneMap, label: str, region_objects: frozenset[str] | None, after: str, limit: int
    ) -> Page[MapObject]:
        """Objects above `after` in the order of their ids; filtered by normalised label and by region."""
        word = normalize_word(label) if label else ""
        matching = sorted(
            (
                obj
                for obj in scene_map.objects
                if obj.object_id > after
                and (not word or normalize_word(obj.label) == word)
                and (region_objects is None or obj.object_id in region_objects)
            ),
            key=lambda obj: obj.object_id,
        )
        items = tuple(matching[:limit])
        return Page(items, items[-1].object_id if items else after, len(matching) > limit)

    async def object(self, scene: str, object_id: str) -> MapObject:
        return await self._ask.objects.get_object(scene, object_id)

    async def partition(self, scene: str) -> Partition:
        return await self._ask.regions.get_partition(scene)

    async def objects_of_region(self, scene: str, region_id: str) -> frozenset[str]:
        """Ids of a region's objects; NotFound names the regions there are."""
        partition = await self.partition(scene)
        for region in partition.regions:
            if region.region_id == region_id:
                return frozenset(region.object_ids)
        names = ", ".join(region.region_id for region in partition.regions[:20]) or "none yet"
        raise NotFound(f"region {region_id!r}: no such region; there are: {names}")

    async def frames(self, scene: str, after: str, limit: int) -> Page[FrameRecord]:
        """Frames in order of arrival. One more than asked for is read, to know whether there is more."""
        records, _ = await self._ask.frames.list_frames(scene, after, limit + 1)
        items = tuple(records[:limit])
        return Page(items, items[-1].log_id if items else after, len(records) > limit)

    async def regions_of_frames(self, scene: str) -> dict[str, str]:
        """Frame id -> id of the region that it was taken in; frames since the last partition are not in it."""
        partition = await self.partition(scene)
        return {frame_id: region.region_id for region in partition.regions for frame_id in region.frame_ids}

    async def frame_image(self, scene: str, frame_id: str) -> bytes:
        return await self._ask.frames.get_rgb(scene, frame_id)

    async def floor_grid(self, scene: str, floor: int) -> FloorGrid:
        """The grid of one floor; NotFound as for `cut_floors`."""
        return (await self.cut_floors(scene, floor)).grids[0]

    async def cut_floors(self, scene: str, floor: int | None = None) -> CutFloors:
        """The partition with the grids of one floor or, without a number, of all.

        NotFound before the first partition, and for a floor that there is not. Partition and grids are read
        one after the other: where a new partition came between, they are read again.
        """
        for _ in range(_LOOKS):
            partition = await self.partition(scene)
            wanted = _wanted_floors(scene, partition, floor)
            grids = await asyncio.gather(
                *(self._ask.regions.get_floor_grid(scene, number) for number in wanted)
            )
            if all(fits(grid, partition) for grid in grids):
                break
        return CutFloors(partition, tuple(grids))

    async def route(self, scene: str, start: F64, goal: F64, robot_radius: float) -> Route:
        return await self._ask.regions.plan_route(scene, start, goal, robot_radius)

    async def route_graph(self, scene: str, robot_radius: float) -> RouteGraph:
        return await self._ask.regions.get_route_graph(scene, robot_radius)

    async def floorplan(self, scene: str, floor: int | None, params: PlanParams) -> bytes:
        """One floor, or all side by side, as a PNG. One is drawn at a time: a large one takes seconds and memory."""
        cut, scene_map = await asyncio.gather(self.cut_floors(scene, floor), self.scene_map(scene))
        sheets = plan_sheets(scene_map, cut.partition, cut.grids)
        async with self._drawing:
            return await asyncio.to_thread(draw_floorplans, sheets, params)

    async def packed_points(
        self, summary: SceneSummary, object_ids: Sequence[str], max_points: int, frame: OutputFrame
    ) -> bytes:
        """Points for drawing; the version they name was read before them, so they are at least that new."""
        clouds = await self._ask.objects.get_points(summary.scene, object_ids, max_points)
        return await asyncio.to_thread(pack_points, clouds, summary.map_version, frame)

    async def ply_objects(self, scene_map: SceneMap, frame: OutputFrame) -> list[PlyObject]:
        """Every point of every object, fetched in pieces that fit into one message."""
        clouds: dict[str, tuple[F32, U8]] = {}
        for ids in _in_pieces(scene_map.objects, _POINTS_A_CALL):
            clouds |= await self._ask.objects.get_points(scene_map.scene, ids)
        return [
            PlyObject(
                obj.object_id, obj.label, frame.points(clouds[obj.object_id][0]), clouds[obj.object_id][1]
            )
            for obj in scene_map.objects
            if obj.object_id in clouds
        ]

    async def find(self, query: Query) -> AsyncGenerator[tuple[str, SearchEvent]]:
        """The events of a search as they happen, the answer last."""
        async for search_id, event in self._ask.searches.find(query):
            yield search_id, event
            if isinstance(event, Answer):
                return
        raise Unavailable("retrieval ended the search without an answer; ask again")

    async def answer(self, query: Query) -> tuple[str, Answer]:
        """The answer alone, with the search's id."""
        async with aclosing(self.find(query)) as events:
            async for search_id, event in events:
                if isinstance(event, Answer):
                    return search_id, event
        raise AssertionError("find ends in an answer or an error")

    async def search(self, scene: str, search_id: str) -> tuple[str, bool, Answer | None]:
        """A stored search: its text, whether it is done, its answer if so."""
        return await self._ask.searches.get_search(scene, search_id)

    async def reachable(self) -> Mapping[str, bool]:
        return await self._ask.readiness.reachable()

    async def system_status(self) -> SystemStatus:
        reachable = await self.reachable()
        gateway = await self._ask.gateway.status() if reachable.get("vlm_gateway", False) else None
        return SystemStatus(reachable, gateway)

    def events(self, scene: str, after_version: int) -> AsyncGenerator[SceneEvent]:
        """Map deltas above a version and regions revisions, from now on; ends only with an error."""
        return _merged([self._ask.map_log.watch(scene, after_version), self._revisions(scene)])

    async def _revisions(self, scene: str) -> AsyncIterator[RegionsChanged]:
        """The regions revision now, and each new one."""
        newest = await self.partition(scene)
        yield RegionsChanged(newest.revision, newest.map_version, newest.events)
        async for partition in self._ask.regions.watch(scene, newest.revision):
            yield RegionsChanged(partition.revision, partition.map_version, partition.events)


def _wanted_floors(scene: str, partition: Partition, floor: int | None) -> list[int]:
    there = [known.floor for known in partition.floors]
    if not there:
        raise NotFound(f"scene {scene!r} has no regions yet: its floors are cut once enough of them was seen")
    if floor is not None and floor not in there:
        names = ", ".join(str(number) for number in there)
        raise NotFound(f"floor {floor}: no such floor in scene {scene!r}; there are: {names}")
    return there if floor is None else [floor]


async def _merged(sources: Sequence[AsyncIterator[T]]) -> AsyncGenerator[T]:
    """Items of all sources as they come; the first source that ends or fails ends the whole with an error."""
    queue: asyncio.Queue[T] = asyncio.Queue(_QUEUED_EVENTS)
    pumps = [asyncio.create_task(_pump(source, queue)) for source in sources]
    following: asyncio.Task[T] = asyncio.create_task(queue.get())
    try:
        while True:
            await asyncio.wait([following, *pumps], return_when=asyncio.FIRST_COMPLETED)
            while following.done():
                yield following.result()
                following = asyncio.create_task(queue.get())
                await asyncio.sleep(0)
            for pump in pumps:
                if pump.done():
                    pump.result()
                    raise Unavailable("a service ended its stream of changes; connect again")
    finally:
        for task in (following, *pumps):
            task.cancel()
        await asyncio.gather(following, *pumps, return_exceptions=True)


async def _pump(source: AsyncIterator[T], queue: asyncio.Queue[T]) -> None:
    async for item in source:
        await queue.put(item)


def _in_pieces(objects: Sequence[MapObject], most: int) -> list[list[str]]:
    """Object ids in runs whose voxels add up to at most `most` (an object larger than that stands alone)."""
    pieces: list[list[str]] = []
    room = 0
    for obj in objects:
        if not pieces or obj.voxels > room:
            pieces.append([])
            room = most
        pieces[-1].append(obj.object_id)
        room -= obj.voxels
    return pieces
