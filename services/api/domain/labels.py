"""Where the words of a plan stand: region names at the widest place inside, others beside what they name, none over
another and none out of the picture."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ovip.scene.types import F64, I32, I64, Bools
from services.api.domain.lettering import Line, Rect, measure

_PAD = 3.0
"""Pixels between words and the rim of their box."""
_BUSY_COST = 5.0
"""Box widths that a name goes aside rather than stand on things all over."""
_LARGER = (6.0, 4.0, 3.0, 2.2, 1.7, 1.35, 1.15, 1.0)


@dataclass(frozen=True, slots=True)
class Label:
    """Words and the box (x0, y0, x1, y1) they fill, pixels. leader: what they speak of where they stand apart from
    it, pixels."""

    lines: tuple[Line, ...]
    box: Rect
    leader: tuple[float, float] | None = None


class LabelSpace:
    """The room for words on a plan, taken up label by label; what is placed first has the better place."""

    def __init__(
        self, regions: I32, busy: Bools, walls: Bools, cell: float, corner: tuple[float, float]
    ) -> None:
        """regions: `(R, C)`, 0 = none, else a region's number; busy: where names should rather not stand; walls: where
        no word may; row 0 on top. cell: pixels; corner: x, y of the upper left cell's, pixels."""
        self._regions = regions
        self._boxes: tuple[tuple[slice, slice] | None, ...] = tuple(ndimage.find_objects(regions))
        self._busy = busy
        self._walls = walls
        self._wall_sums = _sums(walls)
        self._taken = np.zeros(regions.shape, bool)
        self._rects: list[Rect] = []
        self._cell = cell
        self._corner = corner

    def name(self, number: int, variants: Sequence[tuple[Line, ...]]) -> Label | None:
        """The first variant that fits into region `number`, at its widest place; else the last one beside it, with a
        leader; None for a region without cells, or where all is taken."""
        here = self._boxes[number - 1] if number <= len(self._boxes) else None
        if here is None:
            return None
        free = (self._regions[here] == number) & ~self._taken[here]
        for lines in variants:
            rows, columns = self._cells(lines)
            at = _best_place(free, self._busy[here], rows, columns)
            if at is not None:
                return self._take(lines, here[0].start + at[0], here[1].start + at[1], None)
        return self._apart(number, here, variants[-1])

    def beside(self, lines: tuple[Line, ...], middles: Iterable[tuple[float, float]]) -> Label | None:
        """Words centred on the first of `middles` where they cover no wall and no other words; None where none is."""
        width, height = _size(lines)
        for x, y in middles:
            box = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
            if self._inside(box) and not self._covers(box):
                self._mark(box)
                return Label(lines, box)
        return None

    def reserve(self, box: Rect) -> None:
        """No words come into this box."""
        self._mark(box)

    def _apart(self, number: int, here: tuple[slice, slice], lines: tuple[Line, ...]) -> Label | None:
        """Near the region, rather on paper than on another region's floor, and rather there than on a wall."""
        rows, columns = self._cells(lines)
        target = _widest(self._regions[here] == number) + np.array([here[0].start, here[1].start])
        reach = 3 * columns + 4 * rows
        part = tuple(
            slice(max(0, int(at) - reach), min(size, int(at) + reach))
            for at, size in zip(target, self._regions.shape, strict=True)
        )
        blocked = self._taken[part]
        if blocked.shape[0] < rows or blocked.shape[1] < columns:
            return None
        fits = _window_sums(_sums(blocked), rows, columns) == 0
        if not fits.any():
            return None
        floor, walls = self._regions[part] > 0, self._walls[part]
        covered = _window_sums(_sums(floor) + 3 * _sums(walls), rows, columns) / (rows * columns)
        start = np.array([side.start for side in part])
        away = _distance(fits.shape, target - start, rows, columns) / columns
        best = np.unravel_index(int(np.where(fits, covered + away, np.inf).argmin()), fits.shape)
        leader = tuple(self._corner[axis] + (float(target[1 - axis]) + 0.5) * self._cell for axis in (0, 1))
        return self._take(lines, int(best[0] + start[0]), int(best[1] + start[1]), (leader[0], leader[1]))

    def _take(
        self, lines: tuple[Line, ...], row: int, column: int, leader: tuple[float, float] | None
    ) -> Label:
        """Words centred in the cells from (row, column) on that they fit into."""
        rows, columns = self._cells(lines)
        width, height = _size(lines)
        x = self._corner[0] + (column + columns / 2) * self._cell
        y = self._corner[1] + (row + rows / 2) * self._cell
        box = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
        self._mark(box)
        return Label(lines, box, leader)

    def _mark(self, box: Rect) -> None:
        self._rects.append(box)
        self._taken[self._window(box)] = True

    def _inside(self, box: Rect) -> bool:
        rows, columns = self._regions.shape
        x1, y1 = self._corner[0] + columns * self._cell, self._corner[1] + rows * self._cell
        return box[0] >= self._corner[0] and box[1] >= self._corner[1] and box[2] <= x1 and box[3] <= y1

    def _covers(self, box: Rect) -> bool:
        if any(overlap(box, other) for other in self._rects):
            return True
        rows, columns = self._window(box)
        s = self._wall_sums
        top, bottom, left, right = rows.start, rows.stop, columns.start, columns.stop
        return bool(s[bottom, right] - s[top, right] - s[bottom, left] + s[top, left])

    def _window(self, box: Rect) -> tuple[slice, slice]:
        """The cells that a box touches, inside the plan."""
        rows, columns = self._regions.shape
        x0, y0, x1, y1 = ((edge - self._corner[number % 2]) / self._cell for number, edge in enumerate(box))
        return (
            slice(min(rows, max(0, int(np.floor(y0)))), min(rows, max(0, int(np.ceil(y1))))),
            slice(min(columns, max(0, int(np.floor(x0)))), min(columns, max(0, int(np.ceil(x1))))),
        )

    def _cells(self, lines: tuple[Line, ...]) -> tuple[int, int]:
        """Rows and columns of cells that words need."""
        width, height = _size(lines)
        return max(1, int(np.ceil(height / self._cell))), max(1, int(np.ceil(width / self._cell)))


def overlap(a: Rect, b: Rect) -> bool:
    """Whether two boxes share any area."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _size(lines: tuple[Line, ...]) -> tuple[float, float]:
    width, height = measure(lines)
    return width + 2 * _PAD, height + _PAD


def _best_place(free: Bools, busy: Bools, rows: int, columns: int) -> tuple[int, int] | None:
    """Upper left cell of the box of `rows` x `columns` free cells that is nearest to where the largest box of its shape
    fits, and rather not on what is busy; the first of equals; None where no box fits."""
    if free.shape[0] < rows or free.shape[1] < columns:
        return None
    sums = _sums(free)
    fits = _window_sums(sums, rows, columns) == rows * columns
    if not fits.any():
        return None
    middle = _roomiest(sums, rows, columns)
    away = _distance(fits.shape, middle, rows, columns) / columns
    covered = _window_sums(_sums(busy & free), rows, columns) / (rows * columns)
    cost = np.where(fits, away + _BUSY_COST * covered, np.inf)
    row, column = np.unravel_index(int(cost.argmin()), cost.shape)
    return int(row), int(column)


def _roomiest(sums: I64, rows: int, columns: int) -> F64:
    """(row, column) of the middle of the largest box of a shape that fits: the mean of where it does."""
    for factor in _LARGER:
        height, width = round(factor * rows), round(factor * columns)
        if height < sums.shape[0] and width < sums.shape[1]:
            places = np.argwhere(_window_sums(sums, height, width) == height * width)
            if len(places):
                near = places[np.linalg.norm(places - places.mean(axis=0), axis=1).argmin()]
                middle: F64 = near + np.array([height - 1, width - 1]) / 2
                return middle
    raise AssertionError("a box of factor 1 fits")


def _widest(cells: Bools) -> F64:
    """(row, column) of the cell farthest from the rim."""
    depth = ndimage.distance_transform_edt(np.pad(cells, 1))[1:-1, 1:-1]
    return np.array(np.unravel_index(int(depth.argmax()), cells.shape), dtype=np.float64)


def _distance(shape: tuple[int, ...], middle: F64, rows: int, columns: int) -> F64:
    """Cells from the middle of each box of `rows` x `columns` to a point, by its upper left cell."""
    row = np.arange(shape[0])[:, None] + (rows - 1) / 2 - middle[0]
    column = np.arange(shape[1])[None] + (columns - 1) / 2 - middle[1]
    away: F64 = np.hypot(row, column)
    return away


def _sums(mask: Bools) -> I64:
    """Sums over all cells above and left of each corner: `(R, C)` -> `(R + 1, C + 1)`."""
    return np.pad(mask.cumsum(axis=0, dtype=np.int64).cumsum(axis=1), ((1, 0), (1, 0)))


def _window_sums(sums: I64, rows: int, columns: int) -> I64:
    """The sum in each box of `rows` x `columns` cells, by its upper left cell."""
    total: I64 = (
        sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns] + sums[:-rows, :-columns]
    )
    return total
