"""A storey's evidence by column of its grid: what was hit and passed between heights above its floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import I32, I64, U16, Bools
from services.regions.domain.bricks import SIDE, Window, unblocked
from services.regions.domain.evidence import CELL, SLAB, Counts, FloorEvidence, unpack_voxel
from services.regions.domain.floors import Storey

Span = tuple[float, float]

_BRICKS_AT_ONCE = 4096


@dataclass(frozen=True, slots=True)
class Bandwidths:
    """The bands wanted by name, metres above the floor: of surface, of rays, and the heights of cameras."""

    hits: Mapping[str, Span]
    passes: Mapping[str, Span]
    stood: Span


@dataclass(frozen=True, slots=True)
class Columns:
    """Counts of some columns by the name of their band, arrays of one shape.

    hits: summed counts of surface. filled: voxels with a hit, of the bands of both. passes: summed counts of rays.
    spans: metres above the floor.
    """

    hits: Mapping[str, I32]
    filled: Mapping[str, U16]
    passes: Mapping[str, I32]
    spans: Mapping[str, Span]

    def is_filled(self, band: str, share: float, height: float) -> Bools:
        """Columns with surface in `share` of the band and in `height` metres of it, hit as often as seen through.

        How often: the mean of the voxels that were hit against the mean of the slabs of rays.
        """
        low, high = self.spans[band]
        enough = max(height, share * (high - low)) / CELL
        filled = self.filled[band]
        often = self.hits[band] * self.slabs(band) >= self.passes[band] * filled.astype(np.int64)
        mask: Bools = (filled >= enough - 1e-9) & often
        return mask

    def goes_on(self, band: str) -> Bools:
        """Columns hit as often as seen through, on the mean of all voxels and slabs of the band, and hit at all."""
        low, high = self.spans[band]
        voxels = max(1, round((high - low) / CELL))
        often = self.hits[band] * self.slabs(band) >= self.passes[band].astype(np.int64) * voxels
        mask: Bools = (self.hits[band] > 0) & often
        return mask

    def slabs(self, band: str) -> int:
        """Layers of rays in a band."""
        low, high = self.spans[band]
        return max(1, round((high - low) / SLAB))


@dataclass(frozen=True, slots=True)
class Marks:
    """Masks of one window of columns by name, each `(R, C)`. stood: columns in which a camera was."""

    window: Window
    masks: Mapping[str, Bools]
    stood: Bools


def marked(
    evidence: FloorEvidence,
    storey: Storey,
    wanted: Bandwidths,
    judge: Callable[[Columns], Mapping[str, Bools]],
    margin: int,
) -> Marks | None:
    """What `judge` says of each column, for the least window that holds all it says; None where that is nothing.

    The storey is judged a strip at a time, so that counts of all of it are never held. margin: cells around.
    """
    hits = {name: layers_of(storey, CELL, span) for name, span in wanted.hits.items()}
    passes = {name: layers_of(storey, SLAB, span) for name, span in wanted.passes.items()}
    stood = _stood(evidence.stood, storey, wanted.stood)
    whole = _around(evidence, list(hits.values()), list(passes.values()), stood)
    if whole is None:
        return None
    masks: dict[str, Bools] = {}
    for strip in _strips(whole):
        both = [name for name in hits if name in passes]
        columns = Columns(
            dict(zip(hits, evidence.hits.sums([*hits.values()], strip), strict=True)),
            dict(zip(both, evidence.hits.filled([hits[name] for name in both], strip), strict=True)),
            dict(zip(passes, evidence.passes.sums([*passes.values()], strip), strict=True)),
            {**wanted.passes, **wanted.hits},
        )
        for name, mask in judge(columns).items():
            here = masks.setdefault(name, np.zeros(whole.shape, bool))
            here[strip.inside(whole)] = unblocked(mask, strip)
    return _cut(whole, masks, stood, margin)


def layers_of(storey: Storey, layer: float, span: Span) -> tuple[int, int]:
    """The layers (from, to below) whose middles lie in a span above the floor and within the storey's heights."""
    low, high = max(storey.z + span[0], storey.low), min(storey.z + span[1], storey.high)
    first, last = (int(np.ceil(edge / layer - 0.5 - 1e-9)) for edge in (low, high))
    return first, max(first, last)


def _stood(counts: Counts, storey: Storey, heights: Span) -> I64:
    index = unpack_voxel(counts.items()[0])
    first, last = layers_of(storey, CELL, heights)
    return index[(index[:, 2] >= first) & (index[:, 2] < last), :2]


def _around(
    evidence: FloorEvidence, hits: list[tuple[int, int]], passes: list[tuple[int, int]], stood: I64
) -> Window | None:
    """Whole bricks, and one more on each side, around all of it."""
    windows = [
        bricks.window(min(low for low, _ in layers), max(high for _, high in layers))
        for bricks, layers in ((evidence.hits, hits), (evidence.passes, passes))
    ]
    corners = [corner for window in windows if window is not None for corner in (window.low, window.high)]
    corners += (
        [tuple(stood.min(axis=0).tolist()), tuple((stood.max(axis=0) + 1).tolist())] if len(stood) else []
    )
    if not corners:
        return None
    x, y = zip(*corners, strict=True)
    return Window((min(x) - SIDE, min(y) - SIDE), (max(x) + SIDE, max(y) + SIDE)).of_bricks()


def _strips(whole: Window) -> list[Window]:
    """The window cut into strips of rows, not too large."""
    rows = SIDE * max(1, _BRICKS_AT_ONCE // max(1, whole.bricks[1]))
    (x0, y0), (x1, y1) = whole.low, whole.high
    return [Window((x0, y), (x1, min(y + rows, y1))) for y in range(y0, y1, rows)]


def _cut(whole: Window, masks: dict[str, Bools], stood: I64, margin: int) -> Marks | None:
    cells = np.zeros(whole.shape, bool)
    cells[stood[:, 1] - whole.low[1], stood[:, 0] - whole.low[0]] = True
    some = np.logical_or.reduce([cells, *masks.values()])
    if not some.any():
        return None
    rows, columns = (_span_of(some.any(axis=axis), margin) for axis in (1, 0))
    (x, y) = whole.low
    window = Window((x + columns.start, y + rows.start), (x + columns.stop, y + rows.stop))
    return Marks(window, {name: mask[rows, columns] for name, mask in masks.items()}, cells[rows, columns])


def _span_of(some: Bools, margin: int) -> slice:
    """From the first to the last that is True, with a margin around them, as far as there is room."""
    at = np.flatnonzero(some)
    return slice(max(0, int(at[0]) - margin), min(len(some), int(at[-1]) + margin + 1))
