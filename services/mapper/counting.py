"""How many objects readers get, without looking at all of them after every step."""

from __future__ import annotations

from ovip.scene.types import MapDelta, StepKind
from services.mapper.domain.object_map import ObjectMap


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
                if objects.shows(object_id):
                    self._ids.add(object_id)
                else:
                    self._ids.discard(object_id)
        self._version = delta.version
        return len(self._ids)
