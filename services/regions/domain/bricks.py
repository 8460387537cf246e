"""Counts of a lattice's boxes, dense in bricks of 8 x 8 x 8 that exist where something was counted.

A surface fills few boxes of a storey and rays nearly all: small dense bricks hold either at about a byte a box.
Adding costs what is added, however large the whole is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ovip.scene.types import I32, I64, U16, Bools
from services.regions.domain.counts import pack_voxel, unpack_voxel

SIDE = 8
"""Boxes to a side of a brick, and bricks to a side of a tile."""
BOXES = SIDE**3
"""Boxes of a brick, in the order z, y, x."""

Unsigned = npt.NDArray[np.unsignedinteger]

_Array = TypeVar("_Array", I32, I64)
_Scalar = TypeVar("_Scalar", bound=np.generic)
_Width = TypeVar("_Width", np.int32, np.uint16)

_PAGE = 1 << 14  # bricks that are stored together
_AT_ONCE = 1 << 12  # bricks that are read together
_WIDTHS = (np.uint8, np.uint16, np.uint32, np.uint64)


@dataclass(frozen=True, slots=True)
class Window:
    """A rectangle of columns, in boxes: x and y from `low` to below `high`."""

    low: tuple[int, int]
    high: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns): rows with y, columns with x."""
        return self.high[1] - self.low[1], self.high[0] - self.low[0]

    @property
    def bricks(self) -> tuple[int, int]:
        """(rows, columns) of the bricks of a window of whole ones."""
        return self.shape[0] // SIDE, self.shape[1] // SIDE

    def of_bricks(self) -> Window:
        """The least window of whole bricks that holds it."""
        (x0, y0), (x1, y1) = self.low, self.high
        return Window((x0 // SIDE * SIDE, y0 // SIDE * SIDE), (-(-x1 // SIDE) * SIDE, -(-y1 // SIDE) * SIDE))

    def inside(self, other: Window) -> tuple[slice, slice]:
        """Its rows and columns in a window that holds it."""
        x, y = self.low[0] - other.low[0], self.low[1] - other.low[1]
        return slice(y, y + self.shape[0]), slice(x, x + self.shape[1])


class Bricks:
    """Integer counts by box; exact, since a page of bricks is widened before one of its counts outgrows it."""

    def __init__(self) -> None:
        self._tiles: dict[int, int] = {}
        self._tables: I32 = np.zeros((0, BOXES), np.int32)  # each tile's rows of its bricks, from 1; 0 = none
        self._index: I32 = np.zeros((0, 3), np.int32)  # each row's brick
        self._changed: I64 = np.zeros(0, np.int64)
        self._pages: list[Unsigned] = []
        self._size = 0

    def add(self, keys: I64, counts: I64 | None = None) -> None:
        """Adds `counts` (default 1 each) at the boxes `keys` of `pack_voxel`; keys may repeat."""
        distinct, at = np.unique(keys, return_inverse=True)
        amount = np.zeros(len(distinct), np.int64)
        np.add.at(amount, at, 1 if counts is None else counts)
        self.raise_at(unpack_voxel(distinct), amount)

    def raise_at(self, index: I64, amount: I64 | None = None, time: int = 0) -> None:
        """Adds `amount` (default 1 each) at distinct boxes `(N, 3)`; their bricks changed at `time`."""
        if not len(index):
            return
        row = self._rows_of(index >> 3)
        within = index & (SIDE - 1)
        place = (within[:, 2] * SIDE + within[:, 1]) * SIDE + within[:, 0]
        self._changed[row] = time
        pages = row // _PAGE
        for number in np.unique(pages).tolist():
            here = pages == number
            more = 1 if amount is None else amount[here]
            self._put(number, row[here], place[here], self._value(number, row[here], place[here]) + more)

    def items(self) -> tuple[I64, I64]:
        """Sorted distinct keys `(K,)` and their counts `(K,)`: 16 bytes a box, for small scenes."""
        keys, counts = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
        for rows, blocks in self._read(np.arange(self._size)):
            row, place = np.nonzero(blocks)
            within = np.stack([place & 7, (place >> 3) & 7, place >> 6], axis=1)
            keys.append(pack_voxel(self._index[rows[row]].astype(np.int64) * SIDE + within))
            counts.append(blocks[row, place].astype(np.int64))
        joined, amounts = np.concatenate(keys), np.concatenate(counts)
        order = np.argsort(joined)
        return joined[order], amounts[order]

    def used_layers(self) -> I64:
        """The layers (z indices) in which some box has a count, rising -> `(L,)`."""
        heights = self._index[: self._size, 2]
        used = [np.zeros(0, np.int64)]
        for height in np.unique(heights).tolist():
            some = np.zeros(SIDE, bool)
            for _, blocks in self._read(np.flatnonzero(heights == height)):
                some |= blocks.any(axis=0).reshape(SIDE, -1).any(axis=1)
            used.append(height * SIDE + np.flatnonzero(some))
        return np.concatenate(used)

    def window(self, low: int, high: int) -> Window | None:
        """Whole bricks that hold every count in the layers `low` to below `high`; None where there is none."""
        x, y, z = self._index[: self._size].T
        inside = (z >= low // SIDE) & (z * SIDE < high)
        if not inside.any():
            return None
        x, y = x[inside], y[inside]
        return Window(
            (int(x.min()) * SIDE, int(y.min()) * SIDE), ((int(x.max()) + 1) * SIDE, (int(y.max()) + 1) * SIDE)
        )

    def sums(self, layers: Sequence[tuple[int, int]], window: Window) -> I32:
        """Each column's counts, summed over the layers of each of K bands (from, to below), brick by brick.

        window: of N whole bricks -> `(K, N, 64)`, see `unblocked`.
        """
        counts = np.zeros((len(layers), window.bricks[0] * window.bricks[1], SIDE * SIDE), np.int32)
        for band, bricks, boxes in self._parts(layers, window):
            counts[band, bricks] += _over_layers(boxes, np.int32)
        return counts

    def filled(self, layers: Sequence[tuple[int, int]], window: Window) -> U16:
        """How many of each column's boxes have a count, as `sums` -> `(K, N, 64)`."""
        boxes_with = np.zeros((len(layers), window.bricks[0] * window.bricks[1], SIDE * SIDE), np.uint16)
        for band, bricks, boxes in self._parts(layers, window):
            boxes_with[band, bricks] += _over_layers(boxes != 0, np.uint16)
        return boxes_with

    def changed(self, since: int) -> I64:
        """Keys (`pack_voxel` of their indices) of the bricks that changed after `since`, sorted -> `(N,)`.

        All bricks for `since` 0 or less.
        """
        rows = slice(self._size) if since <= 0 else np.flatnonzero(self._changed[: self._size] > since)
        return np.sort(pack_voxel(self._index[: self._size][rows].astype(np.int64)))

    def read(self, keys: I64) -> Iterator[Unsigned]:
        """The counts of bricks that exist, by key and in that order, some at a time -> `(n, BOXES)` each."""
        rows = self._rows_of(unpack_voxel(keys)) if len(keys) else np.zeros(0, np.int64)
        return (blocks for _, blocks in self._read(rows))

    def write(self, keys: I64, blocks: Unsigned, time: int) -> None:
        """Sets bricks `(N,)` whole, to `(N, BOXES)` counts."""
        if not len(keys):
            return
        row = self._rows_of(unpack_voxel(keys))
        self._changed[row] = time
        for number in np.unique(row // _PAGE).tolist():
            here = row // _PAGE == number
            self._put(number, row[here], slice(None), blocks[here])

    def _parts(
        self, layers: Sequence[tuple[int, int]], window: Window
    ) -> Iterator[tuple[int, I64, Unsigned]]:
        """A band, some bricks of the window (no two of one column of bricks), their boxes in the band `(n, d, 64)`."""
        up, across = window.bricks
        x, y, z = self._index[: self._size].T
        left, bottom = window.low[0] // SIDE, window.low[1] // SIDE
        rows = np.flatnonzero((y >= bottom) & (y < bottom + up))
        inside = rows[(x[rows] >= left) & (x[rows] < left + across)]
        column = (y[inside] - bottom).astype(np.int64) * across + (x[inside] - left)
        heights = z[inside]
        for height in np.unique(heights).tolist():
            edges = np.clip(np.array(layers) - height * SIDE, 0, SIDE).tolist()
            parts = [(band, slice(a, b)) for band, (a, b) in enumerate(edges) if a < b]
            here = np.flatnonzero(heights == height) if parts else inside[:0]
            start = 0
            for chunk, blocks in self._read(inside[here]):
                bricks = column[here[start : start + len(chunk)]]
                boxes = blocks.reshape(len(chunk), SIDE, SIDE * SIDE)
                start += len(chunk)
                for band, part in parts:
                    yield band, bricks, boxes[:, part]

    def _read(self, rows: I64) -> Iterator[tuple[I64, Unsigned]]:
        """Rows and their counts `(n, BOXES)`, in the order given, `_AT_ONCE` or fewer together."""
        for start in range(0, len(rows), _AT_ONCE):
            chunk = rows[start : start + _AT_ONCE]
            pages = chunk // _PAGE
            numbers = np.unique(pages).tolist()
            if len(numbers) == 1:
                yield chunk, self._pages[numbers[0]].take(chunk % _PAGE, axis=0)
                continue
            blocks = np.zeros((len(chunk), BOXES), np.result_type(*(self._pages[n] for n in numbers)))
            for number in numbers:
                blocks[pages == number] = self._pages[number].take(chunk[pages == number] % _PAGE, axis=0)
            yield chunk, blocks

    def _value(self, page: int, row: I64, place: I64) -> I64:
        return self._pages[page][row % _PAGE, place].astype(np.int64)

    def _put(self, page: int, row: I64, place: I64 | slice, value: npt.NDArray[np.integer]) -> None:
        most = int(value.max())
        if most > np.iinfo(self._pages[page].dtype).max:
            width = next(width for width in _WIDTHS if most <= np.iinfo(width).max)
            self._pages[page] = self._pages[page].astype(width)
        self._pages[page][row % _PAGE, place] = value

    def _rows_of(self, brick: I64) -> I64:
        """The row of each brick `(N, 3)`, made where there is none -> `(N,)`."""
        tile = pack_voxel(brick >> 3)
        tiles = np.unique(tile)
        numbers = np.array([self._tiles.setdefault(code, len(self._tiles)) for code in tiles.tolist()])
        self._tables = _room_for(self._tables, len(self._tiles))
        local = brick & (SIDE - 1)
        slot = (
            numbers[np.searchsorted(tiles, tile)] * BOXES
            + (local[:, 0] * SIDE + local[:, 1]) * SIDE
            + local[:, 2]
        )
        table = self._tables.reshape(-1)
        new = table[slot] == 0
        if new.any():
            slots, first = np.unique(slot[new], return_index=True)
            table[slots] = self._size + 1 + np.arange(len(slots))
            self._extend(brick[new][first])
        rows: I64 = table[slot].astype(np.int64) - 1
        return rows

    def _extend(self, bricks: I64) -> None:
        size = self._size + len(bricks)
        self._index, self._changed = _room_for(self._index, size), _room_for(self._changed, size)
        self._index[self._size : size] = bricks
        while len(self._pages) * _PAGE < size:
            self._pages.append(np.zeros((_PAGE, BOXES), np.uint8))
        self._size = size


def _over_layers(boxes: Unsigned | Bools, width: type[_Width]) -> npt.NDArray[_Width]:
    """The sum over layers `(n, d, 64)` -> `(n, 64)`; layer by layer, which is twice as fast as the array's own."""
    total = boxes[:, 0].astype(width)
    for layer in range(1, boxes.shape[1]):
        np.add(total, boxes[:, layer], out=total, casting="unsafe")
    return total


def unblocked(columns: npt.NDArray[_Scalar], window: Window) -> npt.NDArray[_Scalar]:
    """Columns brick by brick `(N, 64)` -> the rows and columns of a window of whole bricks, `(R, C)`."""
    grid = columns.reshape(*window.bricks, SIDE, SIDE)
    return grid.transpose(0, 2, 1, 3).reshape(window.shape)


def _room_for(array: _Array, size: int) -> _Array:
    """The array itself, or one of twice the length that starts with it."""
    if size <= len(array):
        return array
    grown = np.zeros((max(size, 2 * len(array), 8), *array.shape[1:]), array.dtype)
    grown[: len(array)] = array
    return grown
