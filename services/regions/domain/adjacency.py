"""Adjacency: which regions of a storey touch, where, and how wide the opening between them is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.clusters import clusters
from ovip.scene.types import F64, I32, I64, Bools

_APART = 10.0
"""Cells: sets the crossings of each pair of regions apart, so that all are clustered at once."""


@dataclass(frozen=True, slots=True)
class Opening:
    """A border between regions `a` < `b` (0-based). width: metres; middle: (row, column) of its middle; ends: `(2, 2)`
    of its two ends."""

    a: int
    b: int
    width: float
    middle: F64
    ends: F64


def find_openings(labels: I32, resolution: float, min_width: float = 0.30) -> tuple[Opening, ...]:
    """Openings between regions of R `(R, C)` (0 = none), by (a, b), then by place; narrower ones are left
    out.

    Two regions may share several. An opening's width is that of the straight line through it: with n_r cell
    edges crossed from row to row and n_c from column to column, sqrt(n_r^2 + n_c^2) cells.
    """
    pairs, middles, down = _crossings(labels)
    if not len(pairs):
        return ()
    pair, number = np.unique(pairs, axis=0, return_inverse=True)
    piece = clusters(np.column_stack([middles, number * _APART]), 1.5)
    openings = []
    for members in np.split(np.argsort(piece, kind="stable"), np.cumsum(np.bincount(piece))[:-1]):
        width = resolution * float(np.hypot(down[members].sum(), (~down[members]).sum()))
        if width >= min_width:
            a, b = pair[number[members[0]]].tolist()
            openings.append(Opening(a, b, width, _middle(middles[members]), _ends(middles[members])))
    return tuple(sorted(openings, key=lambda opening: (opening.a, opening.b)))


def _crossings(labels: I32) -> tuple[I64, F64, Bools]:
    """Cell edges between two regions: the regions `(K, 2)` rising, middles `(K, 2)`, row to row or not."""
    found_pairs, found_middles, found_down = [], [], []
    for one, other, step, down in (
        (labels[:-1], labels[1:], (0.5, 0.0), True),
        (labels[:, :-1], labels[:, 1:], (0.0, 0.5), False),
    ):
        at = np.argwhere((one != other) & (one > 0) & (other > 0))
        pair = np.stack([one[tuple(at.T)], other[tuple(at.T)]], axis=1).astype(np.int64) - 1
        found_pairs.append(np.sort(pair, axis=1))
        found_middles.append(at + np.asarray(step))
        found_down.append(np.full(len(at), down))
    return np.concatenate(found_pairs), np.concatenate(found_middles), np.concatenate(found_down)


def _middle(points: F64) -> F64:
    """The point nearest to the mean, so that it lies in the opening even where the border bends."""
    middle: F64 = points[np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1))]
    return middle


def _ends(points: F64) -> F64:
    """The point farthest from the mean, and the one farthest from that -> `(2, 2)`."""
    first = points[np.argmax(((points - points.mean(axis=0)) ** 2).sum(axis=1))]
    last = points[np.argmax(((points - first) ** 2).sum(axis=1))]
    return np.stack([first, last])
