"""What clouds show of touching: which cells of a face one backs, which sides of a box it closes, how far two lie apart.

Clouds are partial: what lies behind a thing is hidden by it, so its backing is seen only in the rim around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, I64, Bools

_CELL = 0.04  # metres between cells of a face, where it is small enough
_MOST_CELLS = 32  # along a face
_SIDE_CELLS = 4  # along a side of a box
_DIRECTIONS = 36  # over half a turn: 5 degrees apart
_OUTLINE_POINTS = 1024
_SIDE_POINTS = 8192
_PLANE = 0.03  # metres from a plane that its points may lie
_TURNS = np.arange(_DIRECTIONS) * (np.pi / _DIRECTIONS)
_NORMALS = np.stack([np.cos(_TURNS), np.sin(_TURNS)]).astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A rectangle in cells, with a rim of cells around it.

    low: `(2,)` corner of the rim; cell: `(2,)` metres; cells: how many along each axis with the rim; rim: how many
    of them at each end.
    """

    low: F64
    cell: F64
    cells: tuple[int, int]
    rim: tuple[int, int]

    @classmethod
    def of(cls, box: F64, rim: float) -> Face:
        """Of a box `(4,)` low, high in a plane, with a rim of at least so many metres; 2 to 32 cells along a side."""
        extent = np.maximum(box[2:] - box[:2], _CELL)
        inner = np.clip(np.rint(extent / _CELL), 2, _MOST_CELLS)
        cell = extent / inner
        ring = np.ceil(rim / cell)
        low = (box[:2] + box[2:] - extent) / 2 - ring * cell
        (u, v), (ru, rv) = inner + 2 * ring, ring
        return cls(low, cell, (int(u), int(v)), (int(ru), int(rv)))

    def cells_of(self, places: F32 | F64) -> tuple[I64, I64]:
        """Which of `(K, 2)` places lie on it or its rim `(J,)`, and their flat cells `(J,)`."""
        at = np.floor((places - self.low) / self.cell).astype(np.int64)
        u, v = at[:, 0], at[:, 1]
        on = np.flatnonzero((u >= 0) & (v >= 0) & (u < self.cells[0]) & (v < self.cells[1]))
        return on, u[on] * self.cells[1] + v[on]

    def marked(self, flat: I64) -> Bools:
        """The grid `cells` with these flat cells set."""
        grid = np.zeros(self.cells, dtype=np.bool_)
        grid.ravel()[flat] = True
        return grid

    def backed(self, grid: Bools) -> Bools:
        """Which cells but the rim's a grid backs: those set, or between set ones in their row or their column."""
        (u, v), (ru, rv) = self.cells, self.rim
        full = grid | _between(grid, 0) | _between(grid, 1)
        return full[ru : u - ru, rv : v - rv]

    def edges(self, grid: Bools) -> tuple[Bools, Bools, Bools, Bools]:
        """Beside which cells of its edges the rim is set: at the low and the high end of the first axis, then of the
        second."""
        (u, v), (ru, rv) = self.cells, self.rim
        across, along = grid[:, rv : v - rv], grid[ru : u - ru]
        strips = ((across[:ru], 0), (across[u - ru :], 0), (along[:, :rv], 1), (along[:, v - rv :], 1))
        first, last, left, right = (np.asarray(strip.any(axis=axis)) for strip, axis in strips)
        return first, last, left, right


def plan_extents(points: F32) -> F64:
    """How far a cloud `(P, 3)` goes in 36 directions of the plan: `(2, 36)` least and most. P >= 1.

    From about a thousand of its points where it has more.
    """
    along = points[:: 1 + len(points) // _OUTLINE_POINTS, :2] @ _NORMALS
    return np.stack([along.min(axis=0), along.max(axis=0)]).astype(np.float64)


def plan_thickness(points: F32) -> float:
    """Metres across a cloud `(P, 3)` in plan where it is thinnest, but for a fiftieth of its points to either side."""
    along = points[:: 1 + len(points) // _OUTLINE_POINTS, :2] @ _NORMALS
    stray = len(along) // 50
    ordered = np.partition(along, (stray, len(along) - 1 - stray), axis=0)
    return float((ordered[len(along) - 1 - stray] - ordered[stray]).min())


def plan_gap(a: F64, b: F64) -> float:
    """Metres between the convex outlines of two clouds in plan, from their extents `(2, 36)`; 0 where they meet."""
    return float(max(0.0, np.maximum(a[0] - b[1], b[0] - a[1]).max()))


def closed_sides(points: F32, box: F64, rim: float) -> F64:
    """Share of each side of a box `(6,)` that a cloud `(P, 3)` closes -> `(6,)`: -x, +x, -y, +y, below, above.

    Each side is seen from the box's middle, with `rim` metres more around it; but the sides around are seen only
    above the box's lower quarter, for what it lies on is below, and no flatter than a noisy plane.
    """
    points = points[:: 1 + len(points) // _SIDE_POINTS]
    middle, low, high = (box[:3] + box[3:]) / 2, box[:3] - rim, box[3:] + rim
    x, y = (_cells(points[:, axis], low[axis], high[axis]) for axis in (0, 1))
    z = _cells(points[:, 2], box[2] + max((box[5] - box[2]) / 4, _PLANE), high[2])
    shares = np.zeros(6)
    for axis, (a, b) in enumerate(((y, z), (x, z), (x, y))):
        seen = np.flatnonzero((a >= 0) & (b >= 0) & (a < _SIDE_CELLS) & (b < _SIDE_CELLS))
        code = a[seen] * _SIDE_CELLS + b[seen]
        before = points[seen, axis] < middle[axis]
        shares[2 * axis : 2 * axis + 2] = _filled_share(code[before]), _filled_share(code[~before])
    return shares


def _cells(along: F32, low: float, high: float) -> I64:
    """Which of a side's cells, counted from `low`, coordinates `(P,)` fall in; others are out of 0 .. 3."""
    return np.asarray(np.floor((along - low) * (_SIDE_CELLS / (high - low))), np.int64)


def vertical_plane(points: F32) -> tuple[F64, float, Bools] | None:
    """The upright plane that at least half of a cloud `(K, 3)` lies in: normal `(2,)`, offset, which do `(K,)`.

    None where there is none. Fitted twice, the second time without what lies off it.
    """
    at = points[:, :2].astype(np.float64)
    keep = np.ones(len(at), dtype=np.bool_)
    for _ in range(2):
        if keep.sum() < 3:
            return None
        spread = at[keep] - at[keep].mean(axis=0)
        normal = np.linalg.eigh(spread.T @ spread)[1][:, 0]
        along = at @ normal
        offset = float(np.median(along[keep]))
        keep = np.abs(along - offset) <= _PLANE
    return (normal, offset, keep) if 2 * keep.sum() >= len(keep) else None


def _between(grid: Bools, axis: int) -> Bools:
    """Cells that are set or have set ones on both sides along an axis."""
    before = np.logical_or.accumulate(grid, axis=axis)
    after = np.flip(np.logical_or.accumulate(np.flip(grid, axis), axis=axis), axis)
    return np.asarray(before & after)


def _filled_share(code: I64) -> float:
    return float((np.bincount(code, minlength=_SIDE_CELLS**2) > 0).mean())
