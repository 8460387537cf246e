"""A storey as cells: rectangles between wall centre lines, each part of a room, each with a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from lab.simulation.plans.rectilinear import Rect

OUTSIDE = -1


@dataclass(frozen=True, slots=True)
class Cell:
    """room: counted from 0 on this storey; cells of one room have no wall between them."""

    rect: Rect
    room: int
    function: str


@dataclass(frozen=True, slots=True)
class Stair:
    """A straight flight from this storey up. rect: its footprint; up: the way it climbs, a unit vector."""

    rect: Rect
    up: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Layout:
    """One storey. rising: the flight that starts here. arriving: the flight that ends here, through its hole."""

    cells: tuple[Cell, ...]
    rising: Stair | None = None
    arriving: Stair | None = None

    @property
    def size(self) -> tuple[float, float]:
        """Metres along x and y, balconies and all."""
        low_x, low_y, high_x, high_y = zip(*(cell.rect for cell in self.cells), strict=True)
        return max(high_x) - min(low_x), max(high_y) - min(low_y)


def mirrored(layout: Layout, axis: int) -> Layout:
    """Turned over along x (0) or y (1)."""
    if axis == 0:
        return _mapped(layout, lambda x, y: (-x, y))
    return _mapped(layout, lambda x, y: (x, -y))


def transposed(layout: Layout) -> Layout:
    """With x and y exchanged."""
    return _mapped(layout, lambda x, y: (y, x))


def shifted(layout: Layout, by: tuple[float, float]) -> Layout:
    """Moved along x and y."""
    return _mapped(layout, lambda x, y: (x + by[0], y + by[1]))


Point = Callable[[float, float], tuple[float, float]]


def _mapped(layout: Layout, point: Point) -> Layout:
    cells = tuple(Cell(_mapped_rect(cell.rect, point), cell.room, cell.function) for cell in layout.cells)
    return Layout(cells, _mapped_stair(layout.rising, point), _mapped_stair(layout.arriving, point))


def _mapped_rect(rect: Rect, point: Point) -> Rect:
    (xa, ya), (xb, yb) = point(rect[0], rect[1]), point(rect[2], rect[3])
    x0, y0, x1, y1 = (round(value, 6) for value in (min(xa, xb), min(ya, yb), max(xa, xb), max(ya, yb)))
    return (x0, y0, x1, y1)


def _mapped_stair(stair: Stair | None, point: Point) -> Stair | None:
    if stair is None:
        return None
    (x0, y0), (x1, y1) = point(0.0, 0.0), point(*stair.up)
    return Stair(_mapped_rect(stair.rect, point), (round(x1 - x0), round(y1 - y0)))
