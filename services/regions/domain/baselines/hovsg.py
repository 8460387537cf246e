"""HOV-SG's floors and rooms: peaks of the height histogram; walls of a density histogram and a watershed.

After the released code (`segment_floors`, `segment_rooms`, `distance_transform`), step by step and with its numbers.
What differs: the cloud is our evidence. For the rooms that is its voxels of 0.05 m, each counted once, as in a
downsampled cloud; for the floors it is each frame's points, so that what many frames saw counts more. There, a room's
cells become the cloud's nearest points; here, cells with nothing seen in them belong to no room.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy import ndimage, signal

from ovip.scene.types import F64, I32, I64, U8
from services.regions.domain.baselines.heights import ceiling_of, filled_voxels
from services.regions.domain.evidence import BIN, FloorEvidence
from services.regions.domain.floors import Storey
from services.regions.domain.free_space import FreeSpace

_PAD = 10  # cells around the map, for walls at its edge and the outside's own marker
_CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=np.uint8)


@dataclass(frozen=True, slots=True)
class HovsgParams:
    """Heights in metres. wall_from: above the floor; wall_below: under the ceiling; between them a surface is wall.

    outside_below: under the ceiling; all surface below it is inside the home. wall_share: of the densest column.
    min_seed: square metres of a seed. For floors: blur in bins of 0.01 m, peak_gap and cluster_gap in metres, and the
    percentile of the histogram that a peak must exceed.
    """

    wall_from: float = 1.5
    wall_below: float = 0.3
    outside_below: float = 0.2
    wall_share: float = 0.25
    min_seed: float = 0.25
    blur: float = 2.0
    peak_gap: float = 0.2
    cluster_gap: float = 1.0
    percentile: float = 90.0


def hovsg_rooms(
    evidence: FloorEvidence, storey: Storey, space: FreeSpace, params: HovsgParams | None = None
) -> I32:
    """The storey's rooms on `space`'s grid -> `(R, C)`, 0 = none; no rooms where no surface was seen."""
    params = params or HovsgParams()
    ceiling = ceiling_of(evidence, storey)
    surface = filled_voxels(evidence, space, storey.z - 0.5, ceiling - params.outside_below)
    if not surface.any():
        return np.zeros(space.free.shape, np.int32)
    upper = filled_voxels(evidence, space, storey.z + params.wall_from, ceiling - params.wall_below)
    blocked = cv2.bitwise_or(_walls(upper, params), cv2.bitwise_not(_inside(surface)))
    blocked = cv2.morphologyEx(blocked, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8), iterations=2)
    seeds = _seeds(blocked, params.min_seed / space.resolution**2)
    outside = int(seeds.max()) + 1
    cv2.circle(seeds, (3, 3), 1, outside, -1)
    cv2.watershed(cv2.cvtColor(blocked, cv2.COLOR_GRAY2BGR), seeds)
    rooms = np.where((seeds > 0) & (seeds < outside), seeds, 0)[_PAD:-_PAD, _PAD:-_PAD]
    return np.where((surface > 0) | space.free, rooms, 0).astype(np.int32)


def hovsg_floors(
    evidence: FloorEvidence, params: HovsgParams | None = None
) -> tuple[tuple[float, float], ...]:
    """(floor, ceiling) heights from the lowest up, metres; none where no two levels stand out.

    Peaks of what was seen at each height are clustered; the lowest and the highest cluster each give their highest
    peak, those between (a ceiling and the next floor) their two highest; consecutive ones are floor and ceiling.
    """
    params = params or HovsgParams()
    heights, counts = _histogram(evidence)
    if not len(counts):
        return ()
    smooth = ndimage.gaussian_filter1d(counts, params.blur)
    beside = np.pad(smooth, 1)  # so that the lowest and the highest bin can be peaks
    tops, _ = signal.find_peaks(
        beside, height=np.percentile(smooth, params.percentile), distance=params.peak_gap / BIN
    )
    tops = tops - 1
    cluster = np.cumsum(np.diff(heights[tops], prepend=-np.inf) > params.cluster_gap)
    last = int(cluster[-1]) if len(cluster) else 0
    levels: list[float] = []
    for number in range(1, last + 1):
        peaks = tops[cluster == number]
        most = 1 if number in (1, last) else 2
        levels += heights[peaks[np.argsort(smooth[peaks], kind="stable")[-most:]]].tolist()
    levels.sort()
    return tuple(zip(levels[:-1:2], levels[1::2], strict=True))


def _walls(upper: I64, params: HovsgParams) -> U8:
    """255 where the blurred density is above a quarter of its maximum, closed -> padded `(R + 20, C + 20)`."""
    density = cv2.GaussianBlur(_bytes(upper), (5, 5), 1)
    walls = np.where(density > params.wall_share * density.max(), 255, 0).astype(np.uint8)
    return np.asarray(cv2.morphologyEx(np.pad(walls, _PAD), cv2.MORPH_CLOSE, _CROSS), np.uint8)


def _inside(surface: I64) -> U8:
    """255 inside the outline of all surface -> padded `(R + 20, C + 20)`."""
    near = np.where(cv2.GaussianBlur(_bytes(surface), (21, 21), 2) > 0, 255, 0).astype(np.uint8)
    near = cv2.morphologyEx(np.pad(near, _PAD), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8), iterations=3)
    outlines, _ = cv2.findContours(near, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return np.asarray(cv2.drawContours(np.zeros_like(near), outlines, -1, 255, -1), np.uint8)


def _seeds(blocked: U8, min_cells: float) -> I32:
    """Numbered places far from everything blocked: Otsu's threshold on the blurred distance -> `(R + 20, C + 20)`."""
    distance = cv2.distanceTransform(cv2.bitwise_not(blocked), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    blurred = cv2.GaussianBlur(_bytes(distance), (11, 1), 10)
    _, far = cv2.threshold(blurred, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    outlines, _ = cv2.findContours(far, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    seeds = np.zeros(blocked.shape, np.int32)
    large = [outline for outline in outlines if cv2.contourArea(outline) > min_cells]
    for number in range(len(large)):
        cv2.drawContours(seeds, large, number, number + 1, -1)
    return seeds


def _bytes(values: I64 | F64) -> U8:
    """Stretched to 0..255."""
    low, high = float(values.min()), float(values.max())
    return np.asarray((values - low) * (255.0 / max(high - low, 1e-9)), np.float64).astype(np.uint8)


def _histogram(evidence: FloorEvidence) -> tuple[F64, F64]:
    """Heights of consecutive bins `(B,)`, metres, and how many points fell in each `(B,)`."""
    bins, counts = (
        np.concatenate(parts)
        for parts in zip(evidence.heights_below.items(), evidence.heights_above.items(), strict=True)
    )
    if not len(bins):
        return np.zeros(0), np.zeros(0)
    histogram = np.zeros(int(bins.max() - bins.min()) + 1)
    np.add.at(histogram, bins - bins.min(), counts)
    return (np.arange(len(histogram)) + bins.min()) * BIN, histogram
