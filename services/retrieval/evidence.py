"""What a question is answered from: one look at the scene, each part fetched once and only when a tier asks
for it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ovip.errors import NotFound, Unavailable
from ovip.scene.answers import FrameRecord
from ovip.scene.building import Building
from ovip.scene.grid import FloorGrid
from ovip.scene.types import F32, F64, MapObject, Partition, Region, SceneMap
from services.retrieval.domain.names import TextFeatures
from services.retrieval.ports import Frames, Grounder, Maps, Regions

NO_PARTITION = Partition(map_version=0, revision=0)
_MOST_WORDS = 20_000
_MOST_SCENES = 16
_WORDS_A_CALL = 128
_TAGS_A_CALL = 32  # as many as perception grounds at once


@dataclass(frozen=True, slots=True)
class Sources:
    """The services that a question is answered from."""

    maps: Maps
    frames: Frames
    grounder: Grounder
    regions: Regions


class TextSpace:
    """Text features of words, kept by text space because every question asks for the same ones again."""

    def __init__(self, grounder: Grounder) -> None:
        self._grounder = grounder
        self._known: dict[str, dict[str, F32]] = {}

    async def features(self, space: str, words: Iterable[str]) -> TextFeatures:
        """Features of the words; all of those kept, in one text space."""
        if len(self._known.get(space, {})) > _MOST_WORDS:
            self._known.pop(space)
        known = self._known.setdefault(space, {})
        missing = sorted(set(words) - known.keys() - {""})
        for at in range(0, len(missing), _WORDS_A_CALL):
            batch = missing[at : at + _WORDS_A_CALL]
            known.update(zip(batch, await self._grounder.embed_text(batch), strict=True))
        return TextFeatures(space, known)


class FrameHistory:
    """Frames of scenes as read so far: the next question reads only what is new, or was not processed yet."""

    def __init__(self, frames: Frames) -> None:
        self._frames = frames
        self._known: dict[str, tuple[list[FrameRecord], dict[str, F32]]] = {}

    async def read(self, scene: str) -> tuple[list[FrameRecord], Mapping[str, F32]]:
        """All frames in order of arrival, and the text features of their tags."""
        records, features = self._known.pop(scene, ([], {}))
        settled = next((k for k, record in enumerate(records) if not record.processed), len(records))
        fresh, words = await _frames_after(
            self._frames, scene, records[settled - 1].log_id if settled else ""
        )
        read = ([*records[:settled], *fresh], {**features, **words})
        while len(self._known) >= _MOST_SCENES:
            self._known.pop(next(iter(self._known)))
        self._known[scene] = read
        return read


@dataclass
class Evidence:
    """One scene as it stands when the question is asked. notes: what could not be had, in words, for the
    answer.
    """

    scene: str
    scene_map: SceneMap
    partition: Partition
    space: str
    sources: Sources
    text_space: TextSpace
    history: FrameHistory
    notes: list[str] = field(default_factory=list)
    _frames: tuple[list[FrameRecord], Mapping[str, F32]] | None = None
    _grids: dict[int, FloorGrid | None] = field(default_factory=dict)
    _buildings: dict[float, Building] = field(default_factory=dict)

    async def texts(self, words: Iterable[str]) -> TextFeatures | None:
        """Text features that hold the words; None where perception cannot give any."""
        if not self.space:
            return None
        try:
            return await self.text_space.features(self.space, words)
        except Unavailable:
            self.note("text likeness: perception cannot be reached, words matched by name only")
            return None

    async def frames(self) -> tuple[list[FrameRecord], Mapping[str, F32]]:
        """All frames of the history in order of arrival, and the text features of their tags."""
        if self._frames is None:
            self._frames = await self.history.read(self.scene)
        return self._frames

    async def can_see(self, words: Sequence[str]) -> bool:
        """False only where no grounder at hand can see any of the words.

        A robot that detects on board may see words that perception's own grounder cannot. Tags beyond that
        grounder show that such eyes are about, and then nothing is ruled out.
        """
        _, blind = await self.sources.grounder.ground(self.scene, [], words)
        if not set(words) <= set(blind):
            return True
        records, _ = await self.frames()
        tags = sorted({tag for record in records for tag in record.tags})
        for at in range(0, len(tags), _TAGS_A_CALL):
            _, beyond = await self.sources.grounder.ground(self.scene, [], tags[at : at + _TAGS_A_CALL])
            if beyond:
                return True
        return False

    async def grid(self, floor: int) -> FloorGrid | None:
        """A storey's grid; None where there is none (yet)."""
        if floor not in self._grids:
            try:
                self._grids[floor] = await self.sources.regions.get_floor_grid(self.scene, floor)
            except (NotFound, Unavailable):
                self._grids[floor] = None
        return self._grids[floor]

    async def grids(self) -> dict[int, FloorGrid]:
        """Every storey's grid, those there are."""
        found = {floor.floor: await self.grid(floor.floor) for floor in self.partition.floors}
        return {floor: grid for floor, grid in found.items() if grid is not None and grid.occupancy.size}

    async def building(self, radius: float) -> Building:
        """Every storey with what joins them, for a robot of `radius` metres."""
        if radius not in self._buildings:
            grids = await self.grids()
            self._buildings[radius] = await asyncio.to_thread(Building, self.partition, grids, radius)
        return self._buildings[radius]

    async def with_newest_regions(self) -> Evidence:
        """The same look with the regions as they stand by now; this one where they are the same or out of reach."""
        try:
            partition = await self.sources.regions.get_partition(self.scene)
        except (NotFound, Unavailable):
            return self
        if partition.revision == self.partition.revision:
            return self
        return replace(self, partition=partition, _grids={}, _buildings={})

    async def start(self, robot_pose: F64 | None) -> F64 | None:
        """Where the robot is `(3,)`: the query's pose, else the newest frame's camera; None where neither is
        known.
        """
        if robot_pose is not None:
            return robot_pose[:3, 3]
        try:
            records, _ = await self.frames()
        except (NotFound, Unavailable):
            return None
        return records[-1].world_from_camera[:3, 3] if records else None

    def regions_of(self, chosen: Sequence[Region]) -> tuple[MapObject, ...]:
        """Objects that lie in the chosen regions; all objects where none is chosen."""
        if not chosen:
            return self.scene_map.objects
        ids = {object_id for region in chosen for object_id in region.object_ids}
        return tuple(item for item in self.scene_map.objects if item.object_id in ids)

    def note(self, text: str) -> None:
        """Adds a note once."""
        if text not in self.notes:
            self.notes.append(text)


async def look_at(scene: str, sources: Sources, text_space: TextSpace, history: FrameHistory) -> Evidence:
    """Reads map, partition and text space; only the map must be there to be read, empty or not."""
    notes: list[str] = []
    try:
        scene_map = await sources.maps.get_map(scene)
    except NotFound:  # the scene is known, nothing has been mapped yet
        scene_map = SceneMap(scene, 0, (), "", 0, 0, "")
    try:
        partition = await sources.regions.get_partition(scene)
    except NotFound:
        partition = NO_PARTITION
    except Unavailable:
        partition = NO_PARTITION
        notes.append("regions: the service cannot be reached, so no regions, no paths")
    try:
        space = (await sources.frames.status(scene)).feature_space
    except (NotFound, Unavailable):
        space = ""
        notes.append("text likeness: perception cannot be reached, words matched by name only")
    return Evidence(scene, scene_map, partition, space, sources, text_space, history, notes)


async def _frames_after(frames: Frames, scene: str, after: str) -> tuple[list[FrameRecord], dict[str, F32]]:
    records: list[FrameRecord] = []
    features: dict[str, F32] = {}
    while True:
        more, words = await frames.list_frames(scene, after)
        features.update(words)
        records.extend(more)
        if not more or not more[-1].log_id or more[-1].log_id == after:
            return records, features
        after = more[-1].log_id
