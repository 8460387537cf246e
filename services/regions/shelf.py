"""What regions keeps in the store: floor evidence with the log id it reaches, and the newest partition with
its grids.

The stage's cursor counts its commits ("7-0" is the seventh): evidence and partitions move at different times,
and each commit carries what it changes whole, so that a reader and a restart see evidence and its log id
together or not at all.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Any

from ovip.codec import decode_floor_grid, decode_partition, encode_floor_grid, encode_partition
from ovip.errors import Corrupt, NotFound
from ovip.scene.grid import FloorGrid
from ovip.scene.types import Partition
from ovip.store import Append, Lease, Store
from ovip.store.store import START
from services.regions.domain.assembly import Cut
from services.regions.domain.evidence import FloorEvidence

STAGE = "regions"
REGIONS, DETECTIONS, MAP = "regions", "detections", "map"
_WISHES = ("regions", "wish")


@dataclass(frozen=True, slots=True)
class Gathered:
    """Evidence of all detections up to the log id `after`."""

    evidence: FloorEvidence
    after: str


@dataclass(frozen=True, slots=True)
class Answered:
    """A partition, the map entry it has seen, and the last wish for one that it answers."""

    cut: Cut
    map_after: str
    wish: int


class Shelf:
    """Reads and writes the stage's state of any scene."""

    def __init__(self, store: Store) -> None:
        self._store = store

    async def gathered(self, scene: str) -> Gathered:
        """The last checkpoint of the evidence; empty before the first."""
        values = await self._store.values(scene, STAGE, ["evidence", "evidence_after"])
        if "evidence" not in values:
            return Gathered(FloorEvidence(), START)
        data = await self._store.blobs.get(values["evidence"].decode())
        return Gathered(FloorEvidence.from_bytes(data), values["evidence_after"].decode())

    async def save_gathered(self, lease: Lease, step: int, gathered: Gathered, data: bytes) -> None:
        """Checkpoints evidence, given also as bytes, as the stage's commit number `step`."""
        ref = await self._store.blobs.put(data)
        puts = {"evidence": ref, "evidence_after": gathered.after}
        await self._store.commit(lease, f"{step}-0", [], puts)

    async def answered(self, scene: str) -> Answered:
        """The newest partition with everything the next one needs; an empty one before the first."""
        index = await self._index(scene)
        if index is None:
            return Answered(Cut.none(), START, 0)
        grids = [await self._grid(ref) for ref in index["grids"]]
        cut = Cut(await self._partition(index["partition"]), tuple(grids), int(index["next_number"]))
        return Answered(cut, str(index["map_after"]), int(index["wish"]))

    async def save_answered(self, lease: Lease, step: int, answered: Answered) -> None:
        """Publishes a partition as the stage's commit number `step`: blobs, log entry and index."""
        cut = answered.cut
        partition = await self._store.blobs.put(encode_partition(cut.partition))
        grids = [await self._store.blobs.put(zlib.compress(encode_floor_grid(grid), 6)) for grid in cut.grids]
        index = {
            "revision": cut.partition.revision,
            "partition": partition,
            "grids": grids,
            "next_number": cut.next_number,
            "map_after": answered.map_after,
            "wish": answered.wish,
        }
        entry: dict[str, bytes | str | int] = {
            "revision": cut.partition.revision,
            "map_version": cut.partition.map_version,
            "partition": partition,
            "grids": json.dumps(grids),
        }
        await self._store.commit(lease, f"{step}-0", [Append(REGIONS, entry)], {"index": json.dumps(index)})

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

    async def _partition(self, ref: str) -> Partition:
        return decode_partition(await self._store.blobs.get(ref))

    async def _grid(self, ref: str) -> FloorGrid:
        data = await self._store.blobs.get(ref)
        try:
            return decode_floor_grid(zlib.decompress(data))
        except zlib.error as error:
            raise Corrupt(f"floor grid {ref}: {error}") from error
