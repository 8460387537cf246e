"""Floor evidence: what the frames' depth says about a building's storeys, kept as counts that add (SPEC 3).

Every accumulator is an integer count summed over frames, so frames may come in any order, two maps' evidence
adds, and the bytes of one are exact. Nothing here knows where the floors are: that is decided later, from
these counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64, I64, Bools
from services.regions.domain import segments
from services.regions.domain.bricks import Bricks
from services.regions.domain.counts import SPAN, Counts, pack_voxel, unpack_voxel

__all__ = [
    "BIN",
    "CELL",
    "SLAB",
    "VIEW",
    "Counts",
    "EvidenceParams",
    "FloorEvidence",
    "pack_voxel",
    "unpack_voxel",
]

CELL = 0.05
"""Metres; the grid's own resolution and the height of a hit voxel."""
SLAB = 0.25
"""Metres; height of the layers in which rays are counted."""
BIN = 0.01
"""Metres; bin of the height histograms."""
VIEW = 0.5
"""Metres; the cubes in which it is kept what a frame saw."""

_VOXELS = 5  # of CELL in a SLAB
_RAYS_AT_ONCE = 2048


@dataclass(frozen=True, slots=True)
class EvidenceParams:
    """max_range: depth farther from the camera is not used, metres. end_gap: rays stop this far before their
    point, metres. ray_spacing: rays are thinned to one for each voxel of this size that holds end points."""

    max_range: float = 8.0
    end_gap: float = 0.10
    ray_spacing: float = 0.10


@dataclass(slots=True)
class FloorEvidence:
    """The counts, in frames unless said otherwise, and where each frame was taken. One thread at a time.

    cameras: frame id -> world position in metres. views: frame id -> sorted `pack_voxel` of the VIEW cubes that
    its surface lies in, `(K,)`. hits: by CELL cubes that held a surface point. passes: by CELL x CELL x SLAB boxes
    that a ray from the camera crossed without a hit in the same frame. stood: by `pack_voxel` of the CELL cube of
    the camera. heights_below, heights_above: points (not frames) by BIN of height, seen from above (floors, table
    tops) and from below (ceilings). restored: frames that came from bytes, whose order among them is not known.
    """

    cameras: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    views: dict[str, I64] = field(default_factory=dict)
    hits: Bricks = field(default_factory=Bricks)
    passes: Bricks = field(default_factory=Bricks)
    stood: Counts = field(default_factory=Counts)
    heights_below: Counts = field(default_factory=Counts)
    heights_above: Counts = field(default_factory=Counts)
    restored: int = 0

    @property
    def revision(self) -> int:
        """How many frames were added."""
        return len(self.cameras)

    def add(self, frame_id: str, surface: F32, camera: F64, params: EvidenceParams | None = None) -> None:
        """Adds one frame: its coarse cloud `(N, 3)` and its camera position `(3,)`, world metres, z up.

        A frame that was added before changes nothing. Points that are not finite or out of range are left
        out. Raises InvalidInput where the camera is not finite or is beyond the 52 km that a voxel key spans.
        """
        if frame_id in self.cameras:
            return
        params = params or EvidenceParams()
        camera = _checked(camera)
        points = _in_range(surface, camera, params.max_range)
        hit = _distinct(_voxels(points, CELL, CELL))
        self.cameras[frame_id] = (float(camera[0]), float(camera[1]), float(camera[2]))
        self.views[frame_id] = np.unique(pack_voxel(_voxels(points, VIEW, VIEW)))
        self.stood.add(pack_voxel(_voxels(camera[None], CELL, CELL)))
        self.hits.raise_at(hit, time=self.revision)
        self.passes.raise_at(_crossed(points, camera, hit, params), time=self.revision)
        below = points[:, 2] < camera[2]
        self.heights_below.add(*_histogram(points[below, 2]))
        self.heights_above.add(*_histogram(points[~below, 2]))

    def to_bytes(self) -> bytes:
        """These counts exactly; equal evidence gives equal bytes, however it was gathered."""
        return self.segment(0)

    @classmethod
    def from_bytes(cls, data: bytes) -> FloorEvidence:
        """What `to_bytes` wrote. Raises Corrupt for anything else."""
        return cls.restore([data])

    def segment(self, since: int) -> bytes:
        """What changed after the first `since` frames, as bytes for `restore`; all of it for 0.

        All of it also where `since` lies among frames that themselves came from bytes.
        """
        return segments.encode(self, since if since >= self.restored else 0)

    @classmethod
    def restore(cls, parts: Sequence[bytes]) -> FloorEvidence:
        """The evidence that wrote these segments, each from where one before it ended; empty from none.

        A later segment wins over what it says anew. Raises Corrupt for bytes that are no segments, and for a
        segment that begins after what those before it tell of.
        """
        evidence = cls()
        for part in parts:
            segments.decode_into(evidence, part)
            evidence.restored = evidence.revision
        return evidence


def _checked(camera: F64) -> F64:
    camera = np.asarray(camera, dtype=np.float64)
    if camera.shape != (3,) or not np.isfinite(camera).all():
        raise InvalidInput(f"camera position: expected three finite numbers, got {camera!r}")
    if np.abs(camera).max() > 0.99 * SPAN * CELL:
        raise InvalidInput(
            f"camera position: expected within {0.99 * SPAN * CELL:.0f} m of the origin, got {camera}"
        )
    return camera


def _in_range(surface: F32, camera: F64, max_range: float) -> F64:
    points = np.asarray(surface, dtype=np.float64).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    near: F64 = points[np.linalg.norm(points - camera, axis=1) <= max_range]
    return near


def _voxels(points: F64, size: float, height: float) -> I64:
    index: I64 = np.floor(points / (size, size, height)).astype(np.int64)
    return index


def _distinct(index: I64) -> I64:
    return unpack_voxel(np.unique(pack_voxel(index)))


def _histogram(heights: F64) -> tuple[I64, I64]:
    bins, counts = np.unique(np.floor(heights / BIN).astype(np.int64), return_counts=True)
    return bins, counts.astype(np.int64)


def _crossed(points: F64, camera: F64, hit: I64, params: EvidenceParams) -> I64:
    """CELL x CELL x SLAB boxes that the rays cross and no point of the frame lies in -> indices `(M, 3)`."""
    if not len(points):
        return np.zeros((0, 3), np.int64)
    _, one_each = np.unique(
        pack_voxel(_voxels(points, params.ray_spacing, params.ray_spacing)), return_index=True
    )
    ends = points[np.sort(one_each)]
    low = _voxels(np.minimum(ends.min(axis=0), camera)[None], CELL, SLAB)[0] - 1
    high = _voxels(np.maximum(ends.max(axis=0), camera)[None], CELL, SLAB)[0] + 2
    crossed: Bools = np.zeros(high - low, dtype=bool)
    for start in range(0, len(ends), _RAYS_AT_ONCE):
        _mark(crossed, low, ends[start : start + _RAYS_AT_ONCE], camera, params.end_gap)
    inside = np.stack([hit[:, 0], hit[:, 1], hit[:, 2] // _VOXELS], axis=1) - low
    crossed[tuple(inside.T)] = False
    x, y, z = np.unravel_index(np.flatnonzero(crossed), crossed.shape)
    boxes: I64 = np.stack([x, y, z], axis=1) + low
    return boxes


def _mark(crossed: Bools, low: I64, ends: F64, camera: F64, end_gap: float) -> None:
    """Sets the boxes at every CELL along the rays from `camera` to `ends`, `end_gap` short of them."""
    way = ends - camera
    length = np.linalg.norm(way, axis=1)
    direction = way / np.maximum(length, 1e-9)[:, None]
    along = np.arange(0.0, float(length.max()), CELL)
    steps = np.searchsorted(along, length - end_gap)  # a ray's samples: those short of its end
    distance = along[np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)]
    flat: I64 = np.zeros(len(distance), np.int64)
    for axis, size in enumerate((CELL, CELL, SLAB)):
        sample = np.repeat(direction[:, axis], steps)
        sample *= distance
        sample += camera[axis]
        sample /= size
        flat *= crossed.shape[axis]
        flat += np.floor(sample, out=sample).astype(np.int64)
        flat -= low[axis]
    crossed.reshape(-1)[flat] = True
