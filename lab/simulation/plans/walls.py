"""Walls between the rooms of a storey, and where there is room for openings in them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

import numpy as np

from lab.simulation.plans.layout import OUTSIDE, Layout
from lab.simulation.plans.rectilinear import Rect
from ovip.scene.types import I32

LEAF_THICKNESS = 0.04
LEAF_GAP = 0.005  # between a leaf and what is beside it, metres


class OpeningKind(StrEnum):
    """What is in a wall's opening."""

    DOORWAY = "doorway"
    ENTRANCE = "entrance"
    WINDOW = "window"


@dataclass(frozen=True, slots=True)
class Opening:
    """A gap in a wall. low, high: along it. bottom, top: above the storey's floor. Metres.

    leaf_side: the side of the wall that an open door leaf stands on, -1 lower, +1 higher, 0 none. hinge_low:
    whether the leaf hangs at the gap's low end.
    """

    kind: OpeningKind
    low: float
    high: float
    bottom: float
    top: float
    leaf_side: int = 0
    hinge_low: bool = True


@dataclass(frozen=True, slots=True)
class Wall:
    """A straight wall between two rooms, or a room and the outside.

    axis: 0 along x, 1 along y. at: its centre line's place across. low, high: its ends along the axis. inner:
    between the faces of the walls that it ends at. sides: the rooms on its lower and higher side.
    height: metres above the storey's floor.
    """

    axis: int
    at: float
    low: float
    high: float
    inner: tuple[float, float]
    sides: tuple[int, int]
    thickness: float
    height: float
    openings: tuple[Opening, ...] = ()

    @property
    def rect(self) -> Rect:
        """Its footprint."""
        return self.rect_between(self.low, self.high, self.thickness / 2)

    def rect_between(self, low: float, high: float, reach: float) -> Rect:
        """What lies within `reach` of its centre line, between two places along it."""
        a, b = self.at - reach, self.at + reach
        return (low, a, high, b) if self.axis == 0 else (a, low, b, high)


@dataclass(frozen=True, slots=True)
class _Line:
    """One side of a room, before it is a wall: along `axis` at `at`, low..high, between two rooms."""

    axis: int
    at: float
    low: float
    high: float
    sides: tuple[int, int]


def leaf_box(wall: Wall, opening: Opening) -> Rect:
    """The footprint of an open leaf: square to its wall, just beside the gap."""
    width = opening.high - opening.low
    start = opening.low - LEAF_THICKNESS - LEAF_GAP if opening.hinge_low else opening.high + LEAF_GAP
    face = wall.at + opening.leaf_side * (wall.thickness / 2 + LEAF_GAP)
    low, high = sorted((face, face + opening.leaf_side * width))
    end = start + LEAF_THICKNESS
    return (start, low, end, high) if wall.axis == 0 else (low, start, high, end)


def walls_of(layout: Layout, thickness: float, height: float, parapet: float) -> tuple[Wall, ...]:
    """All walls of a storey, without openings. parapet: how high the outer walls of a balcony are, metres."""
    lines = _lines(layout)
    balconies = {cell.room for cell in layout.cells if cell.function == "balcony"}
    return tuple(_wall(line, lines, thickness, _height(line, balconies, height, parapet)) for line in lines)


def _height(line: _Line, balconies: set[int], height: float, parapet: float) -> float:
    low = OUTSIDE in line.sides and balconies.intersection(line.sides)
    return parapet if low else height


def _lines(layout: Layout) -> list[_Line]:
    edges = np.array([cell.rect for cell in layout.cells])
    xs, ys = np.unique(edges[:, [0, 2]]), np.unique(edges[:, [1, 3]])
    rooms = np.full((len(xs) + 1, len(ys) + 1), OUTSIDE, dtype=np.int32)
    for cell in layout.cells:
        i, j = (
            np.searchsorted(xs, [cell.rect[0], cell.rect[2]]),
            np.searchsorted(ys, [cell.rect[1], cell.rect[3]]),
        )
        rooms[i[0] + 1 : i[1] + 1, j[0] + 1 : j[1] + 1] = cell.room
    along_x = [
        line for j, y in enumerate(ys) for line in _runs(0, float(y), xs, rooms[:, j], rooms[:, j + 1])
    ]
    along_y = [line for i, x in enumerate(xs) for line in _runs(1, float(x), ys, rooms[i], rooms[i + 1])]
    return along_x + along_y


def _runs(axis: int, at: float, places: np.ndarray, lower: I32, higher: I32) -> list[_Line]:
    """Stretches of one grid line with the same two different rooms on its sides."""
    pairs = [(int(a), int(b)) for a, b in zip(lower[1:-1], higher[1:-1], strict=True)]
    found = []
    for sides, run in groupby(range(len(pairs)), key=lambda index: pairs[index]):
        indices = list(run)
        if sides[0] != sides[1]:
            low, high = float(places[indices[0]]), float(places[indices[-1] + 1])
            found.append(_Line(axis, at, low, high, sides))
    return found


def _wall(line: _Line, lines: list[_Line], thickness: float, height: float) -> Wall:
    """Walls along x own the corners; where two of them go on in one line, each ends at the joint."""
    half = thickness / 2

    def continued(end: float) -> bool:
        return any(
            o is not line and o.axis == line.axis and o.at == line.at and end in (o.low, o.high)
            for o in lines
        )

    def met(end: float) -> bool:
        return any(o.axis != line.axis and o.at == end and o.low <= line.at <= o.high for o in lines)

    if line.axis == 0:
        low = line.low - (0.0 if continued(line.low) else half)
        high = line.high + (0.0 if continued(line.high) else half)
    else:
        low = line.low + (half if met(line.low) else 0.0)
        high = line.high - (half if met(line.high) else 0.0)
    inner = (line.low + half, line.high - half)
    return Wall(line.axis, line.at, low, high, inner, line.sides, thickness, height)
