"""How many objects readers get, without looking at all of them after every step."""

from __future__ import annotations

from ovip.scene.types import MapDelta, MapObject, Presence, StepKind
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import MapParams


class ShownCount:
    """Kept by what each version changed; counted anew where one was missed."""

    def __init__(self) -> None:
        self._version = -1
        self._ids: set[str] = set()

    def count(self, objects: ObjectMap, delta: MapDelta) -> int:
        """The number at the delta's version."""
        if self._version != delta.version - 1 or delta.kind is StepKind.SETTINGS:
            self._ids = {o.object_id for o in objects.objects()}
        else:
            self._ids -= {*delta.removed, *delta.aliases}
            for object_id in (*delta.created, *delta.updated):
                found = objects.find(object_id)
                if found is not None and _is_shown(found, objects.params):
                    self._ids.add(object_id)
                else:
                    self._ids.discard(object_id)
        self._version = delta.version
        return len(self._ids)


def _is_shown(o: MapObject, params: MapParams) -> bool:
    confirmed = o.frames >= params.upkeep.confirm_frames or o.pinned or o.label_given
    return confirmed and o.presence is Presence.PRESENT
