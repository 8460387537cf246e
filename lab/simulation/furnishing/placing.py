"""Things in their places on one storey: what is where, what carries it, and what may still be put where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from lab.simulation.furnishing.footprints import Footprint, meeting
from lab.simulation.furnishing.walkway import Walkway, landings
from lab.simulation.furnishing.wares import Ware
from lab.simulation.home import RelationKind
from lab.simulation.plans.openings import DOOR_TOP
from lab.simulation.plans.plan import FloorPlan
from lab.simulation.plans.walls import OpeningKind, Wall, leaf_box
from ovip.scene.types import F64


class Carrier(Enum):
    """What structure carries a thing that no other thing carries."""

    FLOOR = "floor"
    WALL = "wall"
    CEILING = "ceiling"


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """A ware in its place. x, y: its middle; z: its foot above the storey's floor; metres, yaw in radians.

    kind: how `by` carries it: another placed thing, or structure; wall: which of the storey's walls it hangs on.
    """

    ware: Ware
    x: float
    y: float
    z: float
    yaw: float
    kind: RelationKind
    by: Placed | Carrier
    wall: int = -1

    @property
    def footprint(self) -> Footprint:
        """Its box."""
        w = self.ware
        return Footprint(self.x, self.y, w.width, w.depth, self.yaw, self.z, self.z + w.height)

    def world(self, own: F64) -> F64:
        """Points `(..., 2)` of its own frame, in the home's."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        points: F64 = own @ np.array([[c, s], [-s, c]]) + [self.x, self.y]
        return points


@dataclass(slots=True)
class Stead:
    """One storey being furnished."""

    plan: FloorPlan
    placed: list[Placed] = field(default_factory=list)
    walkway: Walkway = field(init=False)
    _boxes: list[F64] = field(init=False)  # of structure, then of what was placed
    _structure: int = field(init=False)
    _kept_free: list[tuple[Placed | None, F64]] = field(init=False)

    def __post_init__(self) -> None:
        self.walkway = Walkway(self.plan)
        self._boxes, self._kept_free = [], []
        for wall in self.plan.walls:
            self._boxes.append(_rect_box(wall.rect, 0.0, wall.height).row())
            self._keep_openings(wall)
        for rect in self.plan.rails:
            self._boxes.append(_rect_box(rect, 0.0, self.plan.parapet).row())
        for flight in (self.plan.flight.rect if self.plan.flight else None, self.plan.hole):
            if flight:
                self._boxes.append(_rect_box(flight, 0.0, 9.0).row())
        self._kept_free += [(None, _rect_box(rect, 0.0, DOOR_TOP).row()) for rect in landings(self.plan)]
        self._structure = len(self._boxes)

    def fits(self, box: Footprint, carried_by: Placed | Carrier) -> bool:
        """Whether a thing can be there: it meets nothing, and what stands on the floor keeps ways free."""
        meets = meeting(box, np.array(self._boxes))
        if isinstance(carried_by, Placed):
            meets[self._structure + self.placed.index(carried_by)] = False
        if meets.any():
            return False
        flat = box.top - box.bottom < 0.03
        if carried_by is not Carrier.FLOOR or flat or not self._kept_free:
            return True
        return not meeting(box, np.array([zone for _, zone in self._kept_free])).any()

    def keeps_ways(self, box: Footprint, zones: Sequence[Footprint]) -> bool:
        """Whether every place stays reachable when a thing stands there, its own zones too."""
        used = [zone[:2] for owner, zone in self._kept_free if owner is not None]
        return self.walkway.keeps([box], [*used, *(np.array([zone.x, zone.y]) for zone in zones)])

    def free_of_things(self, box: Footprint) -> bool:
        """Whether no wall and no thing is in a box."""
        return not meeting(box, np.array(self._boxes)).any()

    def add(self, thing: Placed, keep_free: Sequence[Footprint] = ()) -> Placed:
        """The thing is there now; keep_free: floor in front of it that it is used from."""
        self.placed.append(thing)
        self._boxes.append(thing.footprint.row())
        if thing.by is Carrier.FLOOR:
            self.walkway.add(thing.footprint)
        self._kept_free += [(thing, zone.row()) for zone in keep_free]
        return thing

    def take_back(self, things: Sequence[Placed]) -> None:
        """As if the last things put there had never been."""
        for thing in reversed(things):
            self.placed.pop()
            self._boxes.pop()
            self.walkway.take_back()
            self.release(thing)

    def release(self, thing: Placed) -> None:
        """The floor before a thing may be stood on now."""
        self._kept_free = [(owner, zone) for owner, zone in self._kept_free if owner is not thing]

    def _keep_openings(self, wall: Wall) -> None:
        """Before and behind doorways nothing stands; open leaves are in the way."""
        for opening in wall.openings:
            if opening.kind is OpeningKind.WINDOW:
                continue
            reach = wall.thickness / 2 + 0.85
            zone = _rect_box(wall.rect_between(opening.low, opening.high, reach), 0.0, DOOR_TOP)
            self._kept_free.append((None, zone.row()))
            if opening.leaf_side:
                leaf = _rect_box(leaf_box(wall, opening), 0.0, DOOR_TOP)
                self._boxes.append(leaf.row())
                self.walkway.add(leaf)


def _rect_box(rect: tuple[float, float, float, float], bottom: float, top: float) -> Footprint:
    x0, y0, x1, y1 = rect
    return Footprint((x0 + x1) / 2, (y0 + y1) / 2, x1 - x0, y1 - y0, 0.0, bottom, top)
