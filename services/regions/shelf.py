"""What regions keeps in the store: floor evidence with the log id it reaches, and the newest partition with
everything that the next one needs.

The stage's cursor counts its commits ("7-0" is the seventh): evidence and partitions move at different times,
and each commit carries what it changes whole. Blobs are written before the commit that names them, so a process
that dies between any two lines leaves blobs that nobody names, never a name without its blob. Evidence is kept
as segments, each with what came since the one before it, and written whole again where they outgrow it.
"""

from __future__ import annotations

import asyncio
import json
import zlib
from collections.abc import AsyncIterator
from dataclasses import asdict, dataclass, field
from typing import Any

from ovip.codec import decode_floor_grid, decode_partition, encode_floor_grid, encode_partition
from ovip.errors import Corrupt, InvalidInput, NotFound
from ovip.scene.grid import FloorGrid
from ovip.scene.types import Partition
from ovip.store import Append, Lease, Store
from ovip.store.store import START
from services.regions.domain.assembly import Cut
from services.regions.domain.evidence import FloorEvidence
from services.regions.domain.staleness import Basis
from services.regions.grouping import GroupingMemory

STAGE = "regions"
REGIONS, DETECTIONS, MAP = "regions", "detections", "map"
_WISHES = ("regions", "wish")
_MOST_SEGMENTS = 64
_DAMAGE = (Corrupt, InvalidInput, NotFound)


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Where evidence is kept: blobs of a whole segment and of those that go on from it, the bytes of each, and the
    frames in all."""

    refs: tuple[str, ...] = ()
    sizes: tuple[int, ...] = ()
    frames: int = 0

    @property
    def is_outgrown(self) -> bool:
        """Whether a whole segment is to be written: the first, or where all together hold over twice the whole."""
        return not self.refs or sum(self.sizes[1:]) > self.sizes[0] or len(self.refs) >= _MOST_SEGMENTS


@dataclass(frozen=True, slots=True)
class Gathered:
    """Evidence of all detections up to the log id `after`. lost: why what was kept cannot be read, else ""."""

    evidence: FloorEvidence
    after: str
    checkpoint: Checkpoint = field(default_factory=Checkpoint)
    lost: str = ""


@dataclass(frozen=True, slots=True)
class Answered:
    """A partition, the map entry it has seen, and the last wish for one that it answers.

    detections_after: the last detections entry in its evidence. bases: what each of its floors was cut from.
    settings: the numbers it was cut with, in words. memory: what was answered on the functions of its objects.
    lost: why the partition that was kept cannot be read, else "".
    """

    cut: Cut
    map_after: str
    wish: int
    detections_after: str = START
    bases: tuple[Basis, ...] = ()
    settings: str = ""
    memory: GroupingMemory = field(default_factory=GroupingMemory)
    lost: str = ""


class Shelf:
    """Reads and writes the stage's state of any scene."""

    def __init__(self, store: Store) -> None:
        self._store = store

    async def gathered(self, scene: str) -> Gathered:
        """The last checkpoint of the evidence; empty before the first, and where it is damaged."""
        values = await self._store.values(scene, STAGE, ["evidence"])
        if "evidence" not in values:
            return Gathered(FloorEvidence(), START)
        try:
            kept = json.loads(values["evidence"])
            checkpoint = Checkpoint(tuple(kept["refs"]), tuple(kept["sizes"]), int(kept["frames"]))
            segments = await asyncio.gather(*(self._store.blobs.get(ref) for ref in checkpoint.refs))
            evidence = await asyncio.to_thread(FloorEvidence.restore, segments)
        except (*_DAMAGE, KeyError, TypeError, ValueError) as error:
            return Gathered(FloorEvidence(), START, lost=str(error))
        return Gathered(evidence, str(kept["after"]), checkpoint)

    async def save_gathered(
        self, lease: Lease, step: int, gathered: Gathered, segment: bytes, base: Checkpoint | None = None
    ) -> Checkpoint:
        """Checkpoints evidence as the stage's commit number `step`. segment: what it has beyond `base`, all of it
        where there is none."""
        base = base or Checkpoint()
        ref = await self._store.blobs.put(segment)
        frames = gathered.evidence.revision
        made = Checkpoint((*base.refs, ref), (*base.sizes, len(segment)), frames)
        kept = {**asdict(made), "after": gathered.after}
        await self._store.commit(lease, f"{step}-0", [], {"evidence": json.dumps(kept)})
        return made

    async def answered(self, scene: str) -> Answered:
        """The newest partition with everything the next one needs; an empty one before the first, and one without
        floors where it is damaged."""
        values = await self._store.values(scene, STAGE, ["index", "grouping"])
        memory = _memory(values.get("grouping"))
        if "index" not in values:
            return Answered(Cut.none(), START, 0, memory=memory)
        index = json.loads(values["index"])
        lost = ""
        try:
            cut = await self._cut(index)
        except _DAMAGE as error:
            lost = str(error)
            cut = Cut(Partition(0, int(index["revision"])), (), int(index["next_number"]))
        return Answered(
            cut=cut,
            map_after=str(index["map_after"]),
            wish=int(index["wish"]),
            detections_after=str(index.get("detections_after", START)),
            bases=() if lost else await self._bases(index),
            settings=str(index.get("settings", "")),
            memory=memory,
            lost=lost,
        )

    async def save_answered(self, lease: Lease, step: int, answered: Answered) -> None:
        """Publishes a partition as the stage's commit number `step`: blobs, log entry and index."""
        cut = answered.cut
        put = self._store.blobs.put
        partition = await put(await asyncio.to_thread(encode_partition, cut.partition))
        grids = [await put(await asyncio.to_thread(_packed, grid)) for grid in cut.grids]
        bases = [await put(await asyncio.to_thread(basis.to_bytes)) for basis in answered.bases]
        index = {
            "revision": cut.partition.revision,
            "partition": partition,
            "grids": grids,
            "bases": bases,
            "next_number": cut.next_number,
            "map_after": answered.map_after,
            "detections_after": answered.detections_after,
            "wish": answered.wish,
            "settings": answered.settings,
        }
        entry: dict[str, bytes | str | int] = {
            "revision": cut.partition.revision,
            "map_version": cut.partition.map_version,
            "partition": partition,
            "grids": json.dumps(grids),
            "events": json.dumps([asdict(event) for event in cut.partition.events]),
        }
        puts = {"index": json.dumps(index), **_remembered(answered)}
        await self._store.commit(lease, f"{step}-0", [Append(REGIONS, entry)], puts)

    async def save_memory(self, lease: Lease, step: int, answered: Answered) -> None:
        """Keeps what was answered on functions, where no partition came of it, as commit number `step`."""
        await self._store.commit(lease, f"{step}-0", [], _remembered(answered))

    async def step(self, scene: str) -> int:
        """Number of commits of the stage so far."""
        return int((await self._store.cursor(scene, STAGE)).split("-")[0])

    async def partition(self, scene: str) -> Partition:
        """The newest partition; revision 0 and nothing in it before the first."""
        index = await self._index(scene)
        return await self._partition(index["partition"]) if index else Cut.none().partition

    async def newest_entry(self, scene: str) -> str:
        """Id of the newest entry of the regions log; the start of the log before the first."""
        newest = await self._store.newest(scene, REGIONS)
        return newest[0].id if newest else START

    async def partitions(self, scene: str, after: str) -> AsyncIterator[Partition]:
        """Partitions of the regions log after an entry, then each new one, for ever."""
        while True:
            for entry in await self._store.read(scene, REGIONS, after, block_ms=1000):
                after = entry.id
                yield await self._partition(entry.fields["partition"].decode())

    async def grid(self, scene: str, floor: int) -> FloorGrid:
        """The newest grid of a floor. Raises NotFound where there is none."""
        index = await self._index(scene)
        refs = index["grids"] if index else []
        if not 0 <= floor < len(refs):
            known = f"floors 0 to {len(refs) - 1}" if refs else "no floors yet"
            raise NotFound(f"scene {scene} has {known}, not floor {floor}")
        return await self._grid(refs[floor])

    async def make_wish(self, scene: str) -> int:
        """Asks whoever follows the scene for a partition; the number that its `Answered.wish` will reach."""
        wished = await self.wish(scene)
        return await self._store.save_document(scene, *_WISHES, b"", wished)

    async def wish(self, scene: str) -> int:
        """The number of the last wish; 0 before the first."""
        document = await self._store.load_document(scene, *_WISHES)
        return document.revision if document else 0

    async def answered_wish(self, scene: str) -> int:
        """The last wish that the newest partition answers."""
        index = await self._index(scene)
        return int(index["wish"]) if index else 0

    async def _index(self, scene: str) -> dict[str, Any] | None:
        values = await self._store.values(scene, STAGE, ["index"])
        index: dict[str, Any] | None = json.loads(values["index"]) if "index" in values else None
        return index

    async def _cut(self, index: dict[str, Any]) -> Cut:
        partition = await self._partition(index["partition"])
        grids = [await self._grid(ref) for ref in index["grids"]]
        return Cut(partition, tuple(grids), int(index["next_number"]))

    async def _bases(self, index: dict[str, Any]) -> tuple[Basis, ...]:
        """One a floor; none, so that all floors are cut again, where one is damaged or an older version wrote none."""
        try:
            data = [await self._store.blobs.get(ref) for ref in index.get("bases", ())]
            bases = tuple(Basis.from_bytes(one) for one in data)
        except _DAMAGE:
            return ()
        return bases if len(bases) == len(index["grids"]) else ()

    async def _partition(self, ref: str) -> Partition:
        return decode_partition(await self._store.blobs.get(ref))

    async def _grid(self, ref: str) -> FloorGrid:
        data = await self._store.blobs.get(ref)
        try:
            return decode_floor_grid(await asyncio.to_thread(zlib.decompress, data))
        except zlib.error as error:
            raise Corrupt(f"floor grid {ref}: {error}") from error


def _packed(grid: FloorGrid) -> bytes:
    return zlib.compress(encode_floor_grid(grid), 6)


def _remembered(answered: Answered) -> dict[str, bytes | str | int]:
    return {"grouping": zlib.compress(answered.memory.to_json().encode())}


def _memory(kept: bytes | None) -> GroupingMemory:
    return GroupingMemory.from_json(zlib.decompress(kept).decode()) if kept else GroupingMemory()
