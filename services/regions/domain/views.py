"""Views: which frames saw most of each region's floor, so that few of them show all of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy import ndimage, sparse

from ovip.scene.types import F64, I32, I64
from services.regions.domain.counts import SPAN
from services.regions.domain.evidence import VIEW, FloorEvidence

_NEAR = 0.10  # metres from a floor's height to a cube that may hold some of it
_ABOVE = 0.15  # metres from a floor up to a camera that looks down on it
_INDEX = (1 << 21) - 1
_NOTHING: I64 = np.zeros(0, np.int64)


def seen_by(
    evidence: FloorEvidence,
    storey_z: float,
    labels: I32,
    count: int,
    origin: tuple[float, float],
    resolution: float,
    most: int = 32,
) -> tuple[tuple[str, ...], ...]:
    """The ids of the frames that see each region's floor, at most `most`, best first.

    Each next frame adds most cells that none before it saw, then sees most cells; ties go to the first id. labels:
    R `(R, C)`, regions 1 to `count`, on a floor at height `storey_z`, the grid's corner at the world's `origin` (x, y).
    A frame sees the cells under the VIEW cubes at the floor's height in which it saw a surface, from above.
    """
    names = sorted(name for name, place in evidence.cameras.items() if place[2] > storey_z + _ABOVE)
    rows, columns = (
        np.floor((start + (np.arange(size) + 0.5) * resolution) / VIEW).astype(np.int64)
        for start, size in zip(origin[::-1], labels.shape, strict=True)
    )
    if not labels.size:
        return ((),) * count
    seen = _floor_seen([evidence.views.get(name, _NOTHING) for name in names], storey_z, rows, columns)
    rows, columns = rows - rows[0], columns - columns[0]
    return tuple(
        tuple(names[frame] for frame in _best(seen, *region, most))
        for region in _squares_of_regions(labels, count, rows, columns)
    )


def _floor_seen(views: Sequence[I64], z: float, rows: I64, columns: I64) -> sparse.csr_matrix:
    """Which squares of floor, row by row `(Y X,)`, each frame sees `(N,)`; a square is VIEW wide.

    rows, columns: the square that each row and column of the grid lies in, rising.
    """
    keys = np.concatenate([*views, _NOTHING])
    frames = np.repeat(np.arange(len(views)), [len(view) for view in views])
    height = (keys & _INDEX) - SPAN
    at_floor = (height >= np.floor((z - _NEAR) / VIEW)) & (height <= np.floor((z + _NEAR) / VIEW))
    frames, x, y = frames[at_floor], (keys[at_floor] >> 42) - SPAN, (keys[at_floor] >> 21 & _INDEX) - SPAN
    inside = (x >= columns[0]) & (x <= columns[-1]) & (y >= rows[0]) & (y <= rows[-1])
    across, down = (int(axis[-1] - axis[0]) + 1 for axis in (columns, rows))
    square = (y[inside] - rows[0]) * across + x[inside] - columns[0]
    seen = sparse.csr_matrix(
        (np.ones(len(square), bool), (square, frames[inside])), shape=(down * across, len(views))
    )
    seen.sum_duplicates()
    return seen


def _squares_of_regions(labels: I32, count: int, rows: I64, columns: I64) -> Iterator[tuple[I64, F64]]:
    """The squares that each region lies in, and how many of its cells are in each."""
    across = int(columns[-1]) + 1
    for number, window in enumerate(ndimage.find_objects(labels, count), start=1):
        if window is None:
            yield _NOTHING, np.zeros(0)
            continue
        y, x = rows[window[0]], columns[window[1]]
        down, right = (np.flatnonzero(np.diff(axis, prepend=-1)) for axis in (y, x))
        mask = (labels[window] == number).astype(np.int32)
        cells = np.add.reduceat(np.add.reduceat(mask, down, axis=0), right, axis=1)
        row, column = np.nonzero(cells)
        yield y[down][row] * across + x[right][column], cells[row, column].astype(np.float64)


def _best(seen: sparse.csr_matrix, squares: I64, cells: F64, most: int) -> list[int]:
    """The frames that cover `squares` (rows of `seen`), worth `cells` each: greedily, then by what each sees."""
    first, sizes = seen.indptr[squares], np.diff(seen.indptr)[squares]
    square = np.repeat(np.arange(len(squares)), sizes)
    entries = np.arange(len(square)) + np.repeat(first - np.cumsum(sizes) + sizes, sizes)
    frame = seen.indices[entries]
    sees, left = np.bincount(frame, cells[square], seen.shape[1]), cells.copy()
    adds, chosen = sees, list[int]()
    while len(chosen) < most and adds.any():
        ties = np.flatnonzero(adds == adds.max())
        chosen.append(int(ties[np.argmax(sees[ties])]))
        left[square[frame == chosen[-1]]] = 0.0
        adds = np.bincount(frame, left[square], seen.shape[1])
    sees[chosen] = 0.0
    rest = np.flatnonzero(sees)
    return [*chosen, *rest[np.argsort(-sees[rest], kind="stable")][: most - len(chosen)].tolist()]
