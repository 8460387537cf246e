"""The walls around a functional area as stretches that furniture can stand against and things can hang on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Area, inside_polygon
from lab.simulation.plans.plan import FloorPlan
from lab.simulation.plans.walls import Opening, OpeningKind, Wall

_YAWS = {(0, -1): 0.0, (0, 1): np.pi, (1, 1): np.pi / 2, (1, -1): -np.pi / 2}


@dataclass(frozen=True, slots=True)
class Side:
    """A stretch of wall, seen from the area. axis: 0 along x, 1 along y. face: where its surface is across.

    inward: +1 where the area lies on its higher side, else -1. low, high: along the axis. wall: its number on
    the storey. yaw: of a thing that has its back to it.
    """

    axis: int
    face: float
    inward: int
    low: float
    high: float
    wall: int
    yaw: float
    height: float
    openings: tuple[Opening, ...]

    @property
    def length(self) -> float:
        """Metres."""
        return self.high - self.low

    def point(self, along: float, off: float) -> tuple[float, float]:
        """The place that far along the axis and that far off the wall."""
        across = self.face + self.inward * off
        return (along, across) if self.axis == 0 else (across, along)

    def meets_opening(self, low: float, high: float, bottom: float, top: float) -> bool:
        """Whether a door or window lies behind a thing on the wall."""
        return any(o.low < high and low < o.high and o.bottom < top and bottom < o.top for o in self.openings)


def sides_of(area: Area, plan: FloorPlan) -> tuple[Side, ...]:
    """All stretches of wall around an area that are at least 0.3 m long, parapets too."""
    number = next(i for i, room in enumerate(plan.rooms) if room.room_id == area.room_id)
    found: list[Side] = []
    for index, wall in enumerate(plan.walls):
        for place, inward in enumerate((-1, 1)):
            if wall.sides[place] == number:
                found += _stretches(area, wall, index, inward)
    return tuple(side for side in found if side.length > 0.3)


def _stretches(area: Area, wall: Wall, index: int, inward: int) -> Iterator[Side]:
    face = wall.at + inward * wall.thickness / 2
    marks = np.unique(np.clip(area.polygon[:, wall.axis], wall.low, wall.high))
    middles = (marks[:-1] + marks[1:]) / 2
    off = np.full_like(middles, face + inward * 0.02)
    points = np.stack([middles, off] if wall.axis == 0 else [off, middles], axis=1)
    within = inside_polygon(area.polygon, points) if len(points) else np.zeros(0, dtype=bool)
    for i in np.flatnonzero(within):
        yield Side(
            wall.axis,
            face,
            inward,
            float(marks[i]),
            float(marks[i + 1]),
            index,
            float(_YAWS[wall.axis, inward]),
            wall.height,
            wall.openings,
        )


def doorways(side: Side) -> tuple[Opening, ...]:
    """The ways through a stretch of wall."""
    return tuple(
        o
        for o in side.openings
        if o.kind is not OpeningKind.WINDOW and side.low < (o.low + o.high) / 2 < side.high
    )
