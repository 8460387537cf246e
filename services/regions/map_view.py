"""The objects of a scene's map, read again only where the map's log says that one of them changed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ovip.codec import decode_delta
from ovip.errors import Corrupt
from ovip.scene.types import MapDelta, SceneMap, StepKind
from ovip.store import Entry
from services.regions.domain.assembly import PlacedObjects
from services.regions.ports import MapReader


class MapView:
    """One scene's map as regions needs it. `after`: the last entry of its log that was looked at."""

    def __init__(self, scene: str, mapper: MapReader, after: str) -> None:
        self.after = after
        self._scene = scene
        self._mapper = mapper
        self._version = 0
        self._objects: PlacedObjects | None = None

    def look_at(self, entries: Sequence[Entry]) -> bool:
        """Takes in the next entries of the log; whether an object may have changed by them."""
        touched = False
        for entry in entries:
            delta = _delta(entry)
            touched = touched or delta is None or _touches(delta)
            self._version = max(self._version, delta.version if delta else 0)
            self.after = entry.id
        if touched:
            self._objects = None
        return touched

    async def objects(self) -> tuple[PlacedObjects, int]:
        """The confirmed objects by id, and the version that they are of; an OvipError where the map is away."""
        if self._objects is None:
            scene_map = await self._mapper.get_map(self._scene)
            self._objects = placed(scene_map)
            self._version = max(self._version, scene_map.version)
        return self._objects, self._version


def placed(scene_map: SceneMap) -> PlacedObjects:
    """The map's objects by id, as a partition needs them."""
    objects = sorted(scene_map.objects, key=lambda o: o.object_id)
    return PlacedObjects(
        ids=tuple(o.object_id for o in objects),
        labels=tuple(o.label for o in objects),
        centres=np.array([o.centroid for o in objects], dtype=np.float64).reshape(-1, 3),
    )


def _delta(entry: Entry) -> MapDelta | None:
    """What an entry changed; None where it cannot be read."""
    try:
        return decode_delta(entry.fields["delta"])
    except (Corrupt, KeyError):
        return None


def _touches(delta: MapDelta) -> bool:
    """Whether objects changed. Settings name none, and may show or hide any."""
    named = (delta.created, delta.updated, delta.removed, delta.aliases, delta.departed, delta.returned)
    return any(named) or bool(delta.moved) or delta.kind not in (StepKind.FRAME, StepKind.UPKEEP)
