"""Which boxes may touch a box, in time that does not grow with their number: a grid over the world."""

from __future__ import annotations

from itertools import product

import numpy as np

from ovip.scene.types import F64

_MOST_CELLS = 512  # a box over more cells (a floor, a wall) is looked at always

Cell = tuple[int, int, int]
_Range = tuple[Cell, Cell]


class BoxIndex:
    """Numbered boxes by the grid cells they lie in. edge: metres of a cell."""

    def __init__(self, edge: float = 1.0) -> None:
        self._edge = edge
        self._cells: dict[Cell, set[int]] = {}
        self._ranges: dict[int, _Range] = {}
        self._wide: set[int] = set()

    def put(self, number: int, box: F64) -> None:
        """Number `number` now has `box` `(6,)`."""
        covered = self._range(box)
        if self._ranges.get(number) == covered:
            return
        self.remove(number)
        self._ranges[number] = covered
        if _count(covered) > _MOST_CELLS:
            self._wide.add(number)
            return
        for cell in _cells_of(covered):
            self._cells.setdefault(cell, set()).add(number)

    def remove(self, number: int) -> None:
        """Forgets a number; one that is not there is forgotten already."""
        covered = self._ranges.pop(number, None)
        if covered is None:
            return
        if number in self._wide:
            self._wide.remove(number)
            return
        for cell in _cells_of(covered):
            there = self._cells[cell]
            there.remove(number)
            if not there:
                del self._cells[cell]

    def near(self, box: F64) -> set[int]:
        """Numbers of all boxes that share a volume with `box` `(6,)`, and of some that do not."""
        covered = self._range(box)
        if _count(covered) > max(_MOST_CELLS, len(self._cells)):
            return set(self._ranges)
        found = set(self._wide)
        for cell in _cells_of(covered):
            found |= self._cells.get(cell, set())
        return found

    def _range(self, box: F64) -> _Range:
        cells = np.floor(box / self._edge).astype(np.int64).tolist()
        return (cells[0], cells[1], cells[2]), (cells[3], cells[4], cells[5])


def _count(covered: _Range) -> int:
    low, high = covered
    return (high[0] - low[0] + 1) * (high[1] - low[1] + 1) * (high[2] - low[2] + 1)


def _cells_of(covered: _Range) -> product[Cell]:
    low, high = covered
    return product(*(range(a, b + 1) for a, b in zip(low, high, strict=True)))  # type: ignore[return-value]
