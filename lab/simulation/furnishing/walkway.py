"""Whether a robot still gets everywhere: free floor as a grid, flooded."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from lab.simulation.furnishing.footprints import Footprint
from lab.simulation.plans.plan import FloorPlan
from lab.simulation.plans.rectilinear import Rect
from lab.simulation.plans.walls import OpeningKind
from ovip.scene.types import F64, U8, Bools

CELL = 0.05  # metres
WALK_RADIUS = 0.35  # a way that two feet wide leaves: half of 0.7 m
ROBOT_RADIUS = 0.2
ROBOT_HEIGHT = 1.5
_CONNECTED = 0.8  # of an area's wide floor that the ways have to lead to
_LANDING = 0.9  # metres of floor at both ends of a flight
_STEP_OVER = 0.02  # what is flatter is walked on, metres


class Walkway:
    """The free floor of one storey, and the places that have to stay reachable.

    Passages (both sides of every doorway, the ends of flights) and most of each area's floor are joined by ways
    0.7 m wide; what furniture is used from is reached by a robot of radius 0.2 m.
    """

    def __init__(self, plan: FloorPlan) -> None:
        rings = np.concatenate([room.polygon for room in plan.rooms])
        self._low = rings.min(axis=0) - 0.5
        self._shape = tuple(int(n) for n in np.ceil((rings.max(axis=0) + 0.5 - self._low) / CELL)[::-1])
        self._free = np.zeros(self._shape, np.uint8)
        for room in plan.rooms:
            self._fill(self._free, room.polygon, 1)
        for wall in plan.walls:
            self._fill(self._free, _ring(wall.rect), 0)
        self._passages: list[F64] = []
        for wall in plan.walls:
            for opening in wall.openings:
                if opening.kind is OpeningKind.DOORWAY:
                    rect = wall.rect_between(opening.low, opening.high, wall.thickness / 2 + CELL)
                    self._fill(self._free, _ring(rect), 1)
                    self._passages += _both_sides(wall.axis, wall.at, (opening.low + opening.high) / 2)
        for rect in (*plan.rails, *([plan.flight.rect] if plan.flight else [])):
            self._fill(self._free, _ring(rect), 0)
        self._areas = np.zeros(self._shape, np.uint8)
        for number, area in enumerate(plan.areas, start=1):
            self._fill(self._areas, area.polygon, number)
        self._passages += [np.array([(x0 + x1) / 2, (y0 + y1) / 2]) for x0, y0, x1, y1 in landings(plan)]
        self._before: list[U8] = []

    def keeps(self, boxes: Sequence[Footprint], used_from: Sequence[F64] = ()) -> bool:
        """Whether all passages and places `(2,)` stay reachable when these things too stand there."""
        free = self._free.copy()
        for box in boxes:
            self._block(free, box)
        clear = cv2.distanceTransform(free, cv2.DIST_L2, 5) * CELL
        wide, narrow = clear > WALK_RADIUS - CELL / 2, clear > ROBOT_RADIUS - CELL / 2
        ways = _joined(wide, [self._cell(p) for p in self._passages], 2)
        if (
            ways is None
            or _joined(narrow, [self._cell(p) for p in (*self._passages[:1], *used_from)], 3) is None
        ):
            return False
        of_area = np.bincount(self._areas[wide], minlength=256)
        on_ways = np.bincount(self._areas[ways], minlength=256)
        return bool((on_ways >= _CONNECTED * of_area)[1:].all())

    def add(self, box: Footprint) -> None:
        """A thing stands there now."""
        self._before.append(self._free.copy())
        self._block(self._free, box)

    def take_back(self) -> None:
        """As if the last thing had never been."""
        self._free = self._before.pop()

    def _block(self, free: U8, box: Footprint) -> None:
        if box.bottom < ROBOT_HEIGHT and box.top - box.bottom > _STEP_OVER:
            self._fill(free, box.corners(), 0)

    def _fill(self, grid: U8, ring: F64, value: int) -> None:
        cells = np.round((ring - self._low) / CELL - 0.5).astype(np.int32)
        cv2.fillPoly(grid, [cells], value)

    def _cell(self, point: F64) -> tuple[int, int]:
        x, y = ((point - self._low) / CELL).astype(int)
        return int(y), int(x)


def landings(plan: FloorPlan) -> list[Rect]:
    """The floor before the flight that starts on a storey, and behind the one that ends there."""
    found = []
    if plan.flight:
        found.append(_beyond(plan.flight.rect, (-plan.flight.up[0], -plan.flight.up[1])))
    if plan.hole and plan.layout.arriving:
        found.append(_beyond(plan.hole, plan.layout.arriving.up))
    return found


def _beyond(rect: Rect, way: tuple[int, int]) -> Rect:
    """The landing at one end of a flight's footprint."""
    x0, y0, x1, y1 = rect
    if way[0]:
        return (x1, y0, x1 + _LANDING, y1) if way[0] > 0 else (x0 - _LANDING, y0, x0, y1)
    return (x0, y1, x1, y1 + _LANDING) if way[1] > 0 else (x0, y0 - _LANDING, x1, y0)


def _joined(open_: Bools, cells: Sequence[tuple[int, int]], reach: int) -> Bools | None:
    """The connected open piece that is within `reach` cells of all of these; None where there is none.

    The widest of several; with no cells to join, all that is open.
    """
    if not cells:
        return open_
    _, pieces = cv2.connectedComponents(open_.astype(np.uint8), connectivity=4)
    common: set[int] | None = None
    for row, column in cells:
        around = pieces[max(0, row - reach) : row + reach + 1, max(0, column - reach) : column + reach + 1]
        near = set(np.unique(around).tolist()) - {0}
        common = near if common is None else common & near
    if not common:
        return None
    sizes = np.bincount(pieces.ravel())
    main: Bools = pieces == max(common, key=lambda piece: (sizes[piece], -piece))
    return main


def _both_sides(axis: int, at: float, middle: float) -> list[F64]:
    sides = (at - 0.5, at + 0.5)
    return [np.array([middle, side] if axis == 0 else [side, middle]) for side in sides]


def _ring(rect: Rect) -> F64:
    x0, y0, x1, y1 = rect
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
