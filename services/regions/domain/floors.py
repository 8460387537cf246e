"""Floors: the storeys of a scene, from the peaks of its height histograms (SPEC 3).

A floor is a level that cameras look down on and stand above; a table top is too, so of the levels within one
storey's height the lowest counts. Surfaces seen from below (ceilings) are kept apart from the start, which
tells the ceiling of one storey from the floor of the next, a few decimetres higher.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import ndimage, signal

from ovip.scene.types import F64, I64
from services.regions.domain.evidence import BIN, Counts, FloorEvidence


@dataclass(frozen=True, slots=True)
class FloorParams:
    """How peaks become storeys.

    blur: Gaussian sigma in bins of 0.01 m (HOV-SG's 2). peak_share: a floor's peak holds at least this share
    of the highest one. peak_gap: metres between peaks (HOV-SG's 0.2). min_storey: a floor lies at least this
    far above the one below it, metres. camera_low, camera_high: cameras that stand on a floor are this far
    above it, metres. tolerance: what lies this far under a floor still belongs to it, metres. min_headroom: a
    ceiling is at least this far above its floor, metres.
    """

    blur: float = 2.0
    peak_share: float = 0.05
    peak_gap: float = 0.2
    min_storey: float = 2.0
    camera_low: float = 0.15
    camera_high: float = 2.2
    tolerance: float = 0.3
    min_headroom: float = 1.9


@dataclass(frozen=True, slots=True)
class Storey:
    """One storey in metres: floor and ceiling height (None where none was seen), and the heights it owns."""

    z: float
    ceiling_z: float | None
    low: float
    high: float


def find_storeys(evidence: FloorEvidence, params: FloorParams | None = None) -> tuple[Storey, ...]:
    """The storeys from the lowest up; none where no frame has been added, one where no level stands out."""
    params = params or FloorParams()
    if not evidence.cameras:
        return ()
    cameras = _camera_heights(evidence)
    floors = _floor_heights(evidence, cameras, params)
    edges = [-np.inf, *(z - params.tolerance for z in floors[1:]), np.inf]
    return tuple(
        Storey(z, _ceiling(evidence.heights_above, z, above, params), low, high)
        for z, above, (low, high) in zip(floors, [*floors[1:], np.inf], pairwise(edges), strict=True)
    )


def storey_of(storeys: tuple[Storey, ...], heights: F64) -> I64:
    """Index of the storey that owns each height `(N,)` -> `(N,)`; below the lowest floor counts as the
    lowest.

    Raises ValueError where there is no storey.
    """
    if not storeys:
        raise ValueError("expected at least one storey")
    edges = [storey.low for storey in storeys[1:]]
    return np.searchsorted(np.asarray(edges, dtype=np.float64), np.asarray(heights), side="right").astype(
        np.int64
    )


def _camera_heights(evidence: FloorEvidence) -> F64:
    return np.array([place[2] for place in evidence.cameras.values()])


def _floor_heights(evidence: FloorEvidence, cameras: F64, params: FloorParams) -> list[float]:
    """Peaks of what was seen from above, from the lowest up, each a storey above the last and stood upon."""
    floors: list[float] = []
    for z in _peaks(evidence.heights_below, params):
        rises = not floors or z >= floors[-1] + params.min_storey
        stood_on = ((cameras > z + params.camera_low) & (cameras < z + params.camera_high)).any()
        if rises and stood_on:
            floors.append(z)
    return floors or [_lowest(evidence, cameras)]


def _peaks(heights: Counts, params: FloorParams) -> list[float]:
    """Heights of the peaks in metres, rising."""
    bins, counts = heights.items()
    if not len(bins):
        return []
    margin = int(np.ceil(4 * params.blur)) + 1
    first = int(bins[0]) - margin
    histogram = np.zeros(int(bins[-1]) - first + margin + 1)
    histogram[bins - first] = counts
    smooth = ndimage.gaussian_filter1d(histogram, params.blur, mode="constant")
    tops, _ = signal.find_peaks(
        smooth, height=params.peak_share * smooth.max(), distance=max(1, round(params.peak_gap / BIN))
    )
    return [(first + int(top) + 0.5) * BIN for top in tops]


def _lowest(evidence: FloorEvidence, cameras: F64) -> float:
    """Where no peak will do: the second percentile of what was seen from above, else the lowest camera."""
    bins, counts = evidence.heights_below.items()
    if not len(bins):
        return float(cameras.min())
    at = int(np.searchsorted(np.cumsum(counts), 0.02 * counts.sum()))
    return float((bins[at] + 0.5) * BIN)


def _ceiling(heights: Counts, z: float, above: float, params: FloorParams) -> float | None:
    """The height seen most often from below, between headroom and the next floor; None where nothing was."""
    bins, counts = heights.items()
    metres = (bins + 0.5) * BIN
    inside = (metres > z + params.min_headroom) & (metres < above)
    if not inside.any():
        return None
    return float(metres[inside][np.argmax(counts[inside])])
