"""What is true of a place that questions are asked about, however the place was made."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Home, HomeObject, Relation, RelationKind
from lab.simulation.room import SimulatedRoom
from ovip.scene.types import F64

_TOUCH = 0.03  # metres between what lies on something and its top


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """things: what is no structure. relations: between them, by object id. floors: height in metres by storey."""

    things: tuple[HomeObject, ...]
    relations: tuple[Relation, ...]
    floors: dict[int, float]

    def thing(self, object_id: int) -> HomeObject:
        """The thing with this id. KeyError for none."""
        found = {thing.object_id: thing for thing in self.things}
        return found[object_id]

    def centres(self, object_ids: Iterable[int]) -> F64:
        """Centres `(N, 3)` of the things' boxes, in the order of the ids."""
        boxes = np.array([self.thing(i).box for i in object_ids], dtype=np.float64).reshape(-1, 6)
        middle: F64 = (boxes[:, :3] + boxes[:, 3:]) / 2
        return middle


def truth_of_home(home: Home) -> Truth:
    """A home's things and relations."""
    things = {thing.object_id for thing in home.things}
    between = tuple(r for r in home.relations if r.subject in things and r.object in things)
    return Truth(home.things, between, {storey.floor: storey.z for storey in home.storeys})


def truth_of_room(room: SimulatedRoom) -> Truth:
    """The small room's things: their colours are their attributes, and what lies on what is read off their boxes."""
    things = tuple(
        HomeObject(o.object_id, o.label, (o.color,), False, o.box, 0.0, floor=0, area_id=0)
        for o in room.objects
        if not o.structural
    )
    return Truth(things, tuple(_lying_on(things)), {0: 0.0})


def _lying_on(things: Sequence[HomeObject]) -> Iterable[Relation]:
    for upper in things:
        middle = (upper.box[:2] + upper.box[3:5]) / 2
        for lower in things:
            over = bool(((middle >= lower.box[:2]) & (middle <= lower.box[3:5])).all())
            if upper is not lower and over and abs(upper.box[2] - lower.box[5]) <= _TOUCH:
                yield Relation(upper.object_id, RelationKind.ON, lower.object_id)
