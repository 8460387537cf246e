"""Floor evidence: what the frames' depth says about a building's storeys, kept as counts that add (SPEC 3).

Every accumulator is an integer count summed over frames, so frames may come in any order, two maps' evidence
adds, and the bytes of one are exact. Nothing here knows where the floors are: that is decided later, from
these counts.
"""

from __future__ import annotations

import json
import struct
import zlib
from dataclasses import dataclass, field

import numpy as np

from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import F32, F64, I32, I64, Bools

CELL = 0.05
"""Metres; the grid's own resolution and the height of a hit voxel."""
SLAB = 0.25
"""Metres; height of the layers in which rays are counted."""
BIN = 0.01
"""Metres; bin of the height histograms."""

_SPAN = 1 << 20
_MAGIC = b"OVIPFE01"
_STREAMS = ("hits", "passes", "stood", "heights_below", "heights_above")
_RAYS_AT_ONCE = 2048


@dataclass(frozen=True, slots=True)
class EvidenceParams:
    """max_range: depth farther from the camera is not used, metres. end_gap: rays stop this far before their
    point, metres. ray_spacing: rays are thinned to one for each voxel of this size that holds end points."""

    max_range: float = 8.0
    end_gap: float = 0.10
    ray_spacing: float = 0.10


class Counts:
    """Integer counts by sorted int64 key; additions are merged late, which changes no count."""

    def __init__(self, keys: I64 | None = None, counts: I64 | None = None) -> None:
        self._keys: I64 = np.zeros(0, np.int64) if keys is None else keys
        self._counts: I64 = np.zeros(0, np.int64) if counts is None else counts
        self._pending: list[tuple[I64, I64]] = []
        self._waiting = 0

    def add(self, keys: I64, counts: I64 | None = None) -> None:
        """Adds `counts` (default 1 each) at `keys`; keys may repeat."""
        self._pending.append((keys, np.ones(len(keys), np.int64) if counts is None else counts))
        self._waiting += len(keys)
        if self._waiting > max(100_000, len(self._keys)):
            self._merge()

    def items(self) -> tuple[I64, I64]:
        """Sorted distinct keys `(K,)` and their counts `(K,)`."""
        self._merge()
        return self._keys, self._counts

    def _merge(self) -> None:
        if not self._pending:
            return
        keys = np.concatenate([self._keys, *(keys for keys, _ in self._pending)])
        counts = np.concatenate([self._counts, *(counts for _, counts in self._pending)])
        order = np.argsort(keys, kind="stable")
        keys, counts = keys[order], counts[order]
        first = np.flatnonzero(np.diff(keys, prepend=keys[:1] - 1)) if len(keys) else np.zeros(0, np.int64)
        self._keys = keys[first]
        self._counts = np.add.reduceat(counts, first) if len(first) else np.zeros(0, np.int64)
        self._pending, self._waiting = [], 0


@dataclass(slots=True)
class FloorEvidence:
    """The counts, in frames unless said otherwise, and where each frame was taken.

    cameras: frame id -> world position in metres. hits: by `pack_voxel` of CELL cubes that held a surface
    point. passes: by `pack_voxel` of CELL x CELL x SLAB boxes that a ray from the camera crossed without a
    hit in the same frame. stood: by CELL cube of the camera. heights_below, heights_above: points (not
    frames) by BIN of height, seen from above (floors, table tops) and from below (ceilings).
    """

    cameras: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    hits: Counts = field(default_factory=Counts)
    passes: Counts = field(default_factory=Counts)
    stood: Counts = field(default_factory=Counts)
    heights_below: Counts = field(default_factory=Counts)
    heights_above: Counts = field(default_factory=Counts)

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
        self.stood.add(pack_voxel(_voxels(camera[None], CELL, CELL)))
        self.hits.add(pack_voxel(hit))
        self.passes.add(pack_voxel(_crossed(points, camera, hit, params)))
        below = points[:, 2] < camera[2]
        self.heights_below.add(*_histogram(points[below, 2]))
        self.heights_above.add(*_histogram(points[~below, 2]))

    def to_bytes(self) -> bytes:
        """These counts exactly; equal evidence gives equal bytes, however it was gathered."""
        ids = sorted(self.cameras)
        names = json.dumps(ids).encode()
        places = np.array([self.cameras[i] for i in ids], dtype="<f8").tobytes()
        parts = [struct.pack("<qq", len(names), len(ids)), names, places]
        for name in _STREAMS:
            keys, counts = getattr(self, name).items()
            parts += [struct.pack("<q", len(keys)), np.diff(keys, prepend=0).astype("<i8").tobytes()]
            parts += [counts.astype("<i8").tobytes()]
        return _MAGIC + zlib.compress(b"".join(parts), 1)

    @classmethod
    def from_bytes(cls, data: bytes) -> FloorEvidence:
        """What `to_bytes` wrote. Raises Corrupt for anything else."""
        if data[: len(_MAGIC)] != _MAGIC:
            raise Corrupt("floor evidence: the bytes do not start as floor evidence does")
        try:
            return cls._decode(zlib.decompress(data[len(_MAGIC) :]))
        except (zlib.error, struct.error, ValueError) as error:
            raise Corrupt(f"floor evidence: {error}") from error

    @classmethod
    def _decode(cls, body: bytes) -> FloorEvidence:
        length, frames = struct.unpack_from("<qq", body)
        ids = json.loads(body[16 : 16 + length])
        places = np.frombuffer(body, "<f8", 3 * frames, 16 + length).reshape(-1, 3).tolist()
        at, read = 16 + length + 24 * frames, []
        for _ in _STREAMS:
            (size,) = struct.unpack_from("<q", body, at)
            keys = np.cumsum(np.frombuffer(body, "<i8", size, at + 8)).astype(np.int64)
            counts = np.frombuffer(body, "<i8", size, at + 8 + 8 * size).astype(np.int64)
            read.append(Counts(keys, counts))
            at += 8 + 16 * size
        return cls(dict(zip(ids, map(tuple, places), strict=True)), *read)


def pack_voxel(index: I64) -> I64:
    """Integer voxel indices `(N, 3)` -> sortable keys `(N,)`, ordered by x, then y, then z."""
    shifted = index.astype(np.int64) + _SPAN
    packed: I64 = (shifted[:, 0] << 42) | (shifted[:, 1] << 21) | shifted[:, 2]
    return packed


def unpack_voxel(keys: I64) -> I64:
    """The inverse of `pack_voxel`: keys `(N,)` -> indices `(N, 3)`."""
    low = (1 << 21) - 1
    return np.stack([keys >> 42, (keys >> 21) & low, keys & low], axis=1) - _SPAN


def _checked(camera: F64) -> F64:
    camera = np.asarray(camera, dtype=np.float64)
    if camera.shape != (3,) or not np.isfinite(camera).all():
        raise InvalidInput(f"camera position: expected three finite numbers, got {camera!r}")
    if np.abs(camera).max() > 0.99 * _SPAN * CELL:
        raise InvalidInput(
            f"camera position: expected within {0.99 * _SPAN * CELL:.0f} m of the origin, got {camera}"
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
    layer = np.floor_divide(hit[:, 2] * CELL + 0.5 * CELL, SLAB).astype(np.int64)
    inside = np.stack([hit[:, 0], hit[:, 1], layer], axis=1) - low
    crossed[tuple(inside.T)] = False
    boxes: I64 = np.argwhere(crossed).astype(np.int64) + low
    return boxes


def _mark(crossed: Bools, low: I64, ends: F64, camera: F64, end_gap: float) -> None:
    """Sets the boxes at every CELL along the rays from `camera` to `ends`, `end_gap` short of them."""
    way = ends - camera
    length = np.linalg.norm(way, axis=1)
    along = np.arange(0.0, float(length.max()), CELL)
    ray, step = np.nonzero(along[None] < (length - end_gap)[:, None])
    direction = way / np.maximum(length, 1e-9)[:, None]
    samples = camera + direction[ray] * along[step][:, None]
    index: I32 = np.floor(samples / (CELL, CELL, SLAB)).astype(np.int32) - low.astype(np.int32)
    crossed.ravel()[np.ravel_multi_index(tuple(index.T), crossed.shape)] = True
