"""Regions with sides along x and y: sums of rectangles, less others, as a grid, a ring, or pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, Bools

Rect = tuple[float, float, float, float]
"""Low x, low y, high x, high y, metres."""

_DECIMALS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A region on the coarsest grid that fits it. xs: `(M + 1,)`, ys: `(N + 1,)` metres. filled: `(M, N)`."""

    xs: F64
    ys: F64
    filled: Bools

    @property
    def area(self) -> float:
        """Square metres."""
        return float((np.diff(self.xs)[:, None] * np.diff(self.ys)[None, :] * self.filled).sum())

    def ring(self) -> F64:
        """The outline `(N, 2)`, open, counter-clockwise, corners only.

        ValueError where the region is empty, in several parts, or has a hole.
        """
        after = _edges(self.filled)
        if not after:
            raise ValueError("an empty region has no outline")
        start = at = min(after)
        nodes = [start]
        while (at := after.pop(at)) != start:
            nodes.append(at)
        if after:
            raise ValueError("the region is in several parts, or has a hole")
        steps = np.array(nodes)
        turns = (steps - np.roll(steps, 1, axis=0) != np.roll(steps, -1, axis=0) - steps).any(axis=1)
        corners = steps[turns]
        return np.stack([self.xs[corners[:, 0]], self.ys[corners[:, 1]]], axis=1)


def region(add: Sequence[Rect], remove: Sequence[Rect] = ()) -> Region:
    """All of `add` less all of `remove`."""
    edges = np.round(np.array([*add, *remove], dtype=np.float64).reshape(-1, 4), _DECIMALS)
    xs, ys = np.unique(edges[:, [0, 2]]), np.unique(edges[:, [1, 3]])
    filled = np.zeros((max(len(xs) - 1, 0), max(len(ys) - 1, 0)), dtype=bool)
    for index, (x0, y0, x1, y1) in enumerate(edges):
        at = np.searchsorted(xs, [x0, x1]), np.searchsorted(ys, [y0, y1])
        filled[at[0][0] : at[0][1], at[1][0] : at[1][1]] = index < len(add)
    return Region(xs, ys, filled)


def clipped(rect: Rect, to: Rect) -> Rect | None:
    """The part of a rectangle inside another; None where they share no area."""
    x0, y0, x1, y1 = max(rect[0], to[0]), max(rect[1], to[1]), min(rect[2], to[2]), min(rect[3], to[3])
    return (x0, y0, x1, y1) if x1 - x0 > 1e-9 and y1 - y0 > 1e-9 else None


def _edges(filled: Bools) -> dict[tuple[int, int], tuple[int, int]]:
    """Grid edges around the filled cells, from node to node, with the region on the left."""
    wide = np.pad(filled, 1)
    inside = wide[1:-1, 1:-1]
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for i, j in zip(*np.nonzero(inside & ~wide[1:-1, :-2]), strict=True):
        after[int(i), int(j)] = (int(i) + 1, int(j))
    for i, j in zip(*np.nonzero(inside & ~wide[1:-1, 2:]), strict=True):
        after[int(i) + 1, int(j) + 1] = (int(i), int(j) + 1)
    for i, j in zip(*np.nonzero(inside & ~wide[2:, 1:-1]), strict=True):
        after[int(i) + 1, int(j)] = (int(i) + 1, int(j) + 1)
    for i, j in zip(*np.nonzero(inside & ~wide[:-2, 1:-1]), strict=True):
        after[int(i), int(j) + 1] = (int(i), int(j))
    return after
