"""Outlines: the polygons of a region's cells, in metres."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from skimage.measure import approximate_polygon

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
    ways: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for x, y, dx, dy in border.tolist():
        ways[x, y].append((dx, dy))
    rings = []
    for x, y, dx, dy in border.tolist():
        if (dx, dy) not in ways[x, y]:
            continue
        at, step, corners = (x, y), (dx, dy), []
        while step in ways[at]:
            ways[at].remove(step)
            at = (at[0] + step[0], at[1] + step[1])
            turned = _next_step(ways[at], step)
            if turned != step:
                corners.append(at)
            step = turned
        if step != (dx, dy):
            corners.append(at)
        rings.append(np.array(corners, dtype=np.float64))
    return rings


def _next_step(ways: list[tuple[int, int]], step: tuple[int, int]) -> tuple[int, int]:
    """The way on after `step`: left, else straight, else right; the same step where the ring is closed."""
    left = (-step[1], step[0])
    right = (step[1], -step[0])
    return next((way for way in (left, step, right) if way in ways), step)


def _straightened(ring: F64, tolerance: float) -> F64:
    """The open ring with fewer points, or as it is where too few would remain."""
    fewer: F64 = approximate_polygon(np.vstack([ring, ring[:1]]), tolerance)[:-1]
    return fewer if len(fewer) >= 3 else ring
