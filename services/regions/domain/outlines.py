"""Outlines: the polygons of a region's cells, in metres."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ovip.scene.types import F64, I64, Bools


@dataclass(frozen=True, slots=True)
class Outlines:
    """Open rings `(N, 2)` of world x, y: outer ones counter-clockwise, holes clockwise."""

    outer: tuple[F64, ...]
    holes: tuple[F64, ...]


def trace_outlines(
    cells: Bools, origin: tuple[float, float], resolution: float, tolerance: float = 0.05
) -> Outlines:
    """Outlines of the cells that are set in `(R, C)`, along their edges; straightened by at most `tolerance`
    metres.

    Cells that touch only by a corner are apart. Rings come in row-major order of their lowest, then leftmost
    edge.
    """
    outer: list[F64] = []
    holes: list[F64] = []
    for ring in _rings(_border(cells)):
        world = _straightened(ring, tolerance / resolution) * resolution + np.asarray(origin)
        (outer if signed_area(ring) > 0 else holes).append(world)
    return Outlines(tuple(outer), tuple(holes))


def signed_area(ring: F64) -> float:
    """Area of an open ring `(N, 2)`; positive where it runs counter-clockwise."""
    following = np.roll(ring, -1, axis=0)
    return float(0.5 * (ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum())


def _border(cells: Bools) -> I64:
    """Cell edges between in and out, `(K, 4)`: x, y of the start, step to the end; the inside on the left."""
    inside = np.pad(cells, 1)
    edges = []
    for out, start, step in (
        (inside[:-2, 1:-1], (0, 0), (1, 0)),  # below
        (inside[1:-1, 2:], (1, 0), (0, 1)),  # right
        (inside[2:, 1:-1], (1, 1), (-1, 0)),  # above
        (inside[1:-1, :-2], (0, 1), (0, -1)),  # left
    ):
        at = np.argwhere(cells & ~out)[:, ::-1] + start
        edges.append(np.hstack([at, np.broadcast_to(step, at.shape)]))
    border = np.concatenate(edges).astype(np.int64)
    in_order: I64 = border[np.lexsort((border[:, 0], border[:, 1]))]
    return in_order


def _rings(border: I64) -> list[F64]:
    """The edges strung into closed rings of corners `(N, 2)`; where two ways part, the left one is taken."""
    if not len(border):
        return []
    after = _successors(border)
    ends, turns = border[:, :2] + border[:, 2:], (border[:, 2:] != border[after, 2:]).any(axis=1)
    way, rings = after.tolist(), []
    strung = [False] * len(way)
    for first in range(len(way)):
        ring, edge = [], first
        while not strung[edge]:
            strung[edge] = True
            ring.append(edge)
            edge = way[edge]
        if ring:
            rings.append(ends[ring][turns[ring]].astype(np.float64))
    return rings


def _successors(border: I64) -> I64:
    """For each edge `(K, 4)` the one that goes on from its end: left where there is a choice -> `(K,)`."""
    x, y, dx, dy = border.T
    width = int(x.max()) + 2
    starts, ends = y * width + x, (y + dy) * width + x + dx
    order = np.argsort(starts, kind="stable")
    first = np.searchsorted(starts[order], ends)
    other = np.minimum(first + 1, len(order) - 1)
    one, two = order[first], order[other]
    left = (dx[two] == -dy) & (dy[two] == dx) & (starts[two] == ends)
    chosen: I64 = np.where(left, two, one)
    return chosen


def _straightened(ring: F64, tolerance: float) -> F64:
    """The open ring with fewer points, or as it is where too few would remain (Douglas and Peucker 1973)."""
    fewer = cv2.approxPolyDP(ring.astype(np.int32)[:, None], tolerance, True)[:, 0].astype(np.float64)
    return fewer if len(fewer) >= 3 else ring
