"""Whether an object is still where the map has it: what later depth saw through, and what turned up again (SPEC 2.8).

A place of an object is seen through where nothing nearer than well behind it is measured around its ray. Poses drift
by more than a cup is thick, so an object is first moved, as a whole and by no more than the drift, to where the frame
sees through the least of it: what counts against it is only what no such error of the pose can explain. As much of a
thing that went as lies within that reach of what carried it says nothing, and a thing that is thinner never departs.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from ovip.scene.boxes import box_of
from ovip.scene.types import F32, F64, I64, NEAREST_BLOCK, Bools, Intrinsics
from ovip.scene.voxels import voxel_keys

I8 = npt.NDArray[np.int8]

THROUGH, UNKNOWN, THERE = -1, 0, 1
"""What a view says of a place: seen through, nothing, a surface is there."""

MOST_SAMPLES = 256
"""Places of an object that are watched."""

_FINEST = 0.02  # metres between samples of a small thing
_MOST_COUNT = 127
_STEP = 0.5  # of the drift, between errors of the pose that are tried
_WORTH_A_LOOK = (
    0.05  # share of an object's places seen through, as it stands, from which on it is moved about
)


@dataclass(frozen=True, slots=True)
class PresenceParams:
    """nearest, farthest: metres of depth between which a view counts; nearest is more than the drift.

    drift: metres by which a frame's pose may be off against the poses that an object was mapped from.
    margin: metres behind a place that must be empty too, for voxels and noise; margin_growth: more of it, times the
    depth squared (1/m), as a structured-light sensor's noise grows.
    through_frames: views one after the other that must see through a place. departed_share: share of an object's
    places that must be seen through before it is given up, small_share: of one whose longest side is at most `small`
    metres: it is cleaner in the map, and what carries it hides more of it. Infinite: nothing ever is given up.
    same_cosine: of the features of a departed object and of one that is taken for it; same_lead: how much better than
    any other pair of that label.
    """

    nearest: float = 0.4
    farthest: float = 5.0
    drift: float = 0.03
    margin: float = 0.015
    margin_growth: float = 0.003
    through_frames: int = 3
    departed_share: float = 0.4
    small_share: float = 0.25
    small: float = 0.6
    same_cosine: float = 0.88
    same_lead: float = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What a frame measured. nearest: `(h, w)` as in DetectionBatch: metres, 0 = unknown."""

    nearest: F32
    intrinsics: Intrinsics
    world_from_camera: F64


def frustum_box(view: View, params: PresenceParams) -> F64 | None:
    """World box `(6,)` of all that the view can say something of; None where it measured nothing."""
    if not view.nearest.any():
        return None
    behind = params.drift + params.margin + params.margin_growth * params.farthest**2
    far = min(params.farthest, float(view.nearest.max()) + behind)
    k, pose = view.intrinsics, view.world_from_camera
    u, v = np.meshgrid([-0.5, k.width - 0.5], [-0.5, k.height - 0.5])
    rim = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones((2, 2))], axis=2).reshape(4, 3) * far
    return box_of(np.vstack([np.zeros(3), rim]) @ pose[:3, :3].T + pose[:3, 3])


def sight(points: F32, owners: I64, view: View, params: PresenceParams) -> I8:
    """What the view says of places `(N, 3)`, world metres -> `(N,)` THROUGH, UNKNOWN or THERE.

    owners: `(N,)` from 0, the object that each is of. UNKNOWN outside the image and range, behind something nearer,
    and where depth is missing around the ray. THROUGH are only places that stay so when their object is moved, as a
    whole, by that error of the pose, up to `drift`, that leaves the fewest; of equal errors by the smallest. What is
    said of an object does not depend on the others.
    """
    camera = (np.asarray(points, np.float64) - view.world_from_camera[:3, 3]) @ view.world_from_camera[:3, :3]
    rim, k = np.pad(view.nearest, 1), view.intrinsics
    said = np.full(len(points), UNKNOWN, np.int8)
    index = np.flatnonzero(_in_view(camera, view, params))
    said[index] = _said(camera[index], rim, k, params)
    through = np.flatnonzero(said == THROUGH)
    error = _least_errors(camera[through], owners[through], np.bincount(owners), rim, k, params)
    said[through] = _said(camera[through] + error[owners[through]], rim, k, params)
    return said


def _least_errors(
    camera: F64, owners: I64, sizes: I64, rim: F32, k: Intrinsics, params: PresenceParams
) -> F64:
    """The error of the pose `(O, 3)` that leaves the fewest of each object's places `(N, 3)` seen through.

    sizes: `(O,)` places of each object, seen through or not.
    """
    error = np.zeros((len(sizes), 3))
    least = np.bincount(owners, minlength=len(sizes))
    for errors in _errors(params.drift):
        doubtful = least > _WORTH_A_LOOK * sizes
        live = np.flatnonzero(doubtful[owners])
        moved = (camera[live] + errors[:, None]).reshape(-1, 3)
        through = (_said(moved, rim, k, params) == THROUGH).reshape(len(errors), -1)
        counts = np.stack([np.bincount(owners[live[row]], minlength=len(sizes)) for row in through])
        better = doubtful & (counts.min(axis=0) < least)
        error[better] = errors[counts.argmin(axis=0)[better]]
        least = np.where(better, counts.min(axis=0), least)
    return error


@functools.lru_cache(maxsize=4)
def _errors(drift: float) -> tuple[F64, ...]:
    """Errors of a pose, metres, in steps of half the drift, `(E, 3)` of each length but none, the smallest first."""
    steps = np.array([-2, -1, 0, 1, 2])
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    squares = (grid**2).sum(axis=1)
    lengths = sorted({n for n in squares.tolist() if 0 < n * _STEP**2 <= 1}) if drift else []
    return tuple(grid[squares == n] * _STEP * drift for n in lengths)


def _in_view(camera: F64, view: View, params: PresenceParams) -> Bools:
    """Which of the places `(N, 3)` in camera axes lie within range and the image."""
    x, y, z = camera.T
    k, height, width = view.intrinsics, *view.nearest.shape
    low_x, high_x = (-0.5 - k.cx) / k.fx, (width * NEAREST_BLOCK - 0.5 - k.cx) / k.fx
    low_y, high_y = (-0.5 - k.cy) / k.fy, (height * NEAREST_BLOCK - 0.5 - k.cy) / k.fy
    across = (x >= low_x * z) & (x < high_x * z) & (y >= low_y * z) & (y < high_y * z)
    return np.asarray((z >= params.nearest) & (z <= params.farthest) & across)


def _said(camera: F64, rim: F32, k: Intrinsics, params: PresenceParams) -> I8:
    """What is said of places `(N, 3)` in camera axes as they stand, all before the camera -> `(N,)`.

    rim: the view's nearest depths with a rim of unknown ones. Around a ray is what lies within half a step between
    errors of the pose: what one error just misses, the next one sees.
    """
    x, y, z = camera.T
    u, v, aside = k.fx * x / z + k.cx, k.fy * y / z + k.cy, params.drift * _STEP / 2 / z
    own = _depths(rim, [v], [u])
    around = _depths(rim, [v - k.fy * aside, v + k.fy * aside], [u - k.fx * aside, u + k.fx * aside])
    around = np.minimum(own, around)
    margin = params.margin + params.margin_growth * z**2
    there = (np.abs(own - z) <= margin) | (np.abs(around - z) <= margin)
    return np.where(there, THERE, np.where(around > z + margin, THROUGH, UNKNOWN)).astype(np.int8)


def _depths(rim: F32, v: Sequence[F64], u: Sequence[F64]) -> F32:
    """The least of the blocks that hold the pixels of all rows v and columns u, each `(N,)`; 0 outside the image."""
    rows = [_block(at, rim.shape[0]) * rim.shape[1] for at in v]
    columns = [_block(at, rim.shape[1]) for at in u]
    return functools.reduce(np.minimum, [rim.take(row + column) for row in rows for column in columns])


def _block(pixel: F64, blocks: int) -> I64:
    """Which of the blocks, the rim's two among them, a pixel lies in; the rim's outside the image."""
    counted = (pixel + (0.5 + NEAREST_BLOCK)) * (1 / NEAREST_BLOCK)
    return np.asarray(np.minimum(np.maximum(counted, 0), blocks - 1), np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Against one object's presence. points: `(S, 3)` places of its surface, S <= MOST_SAMPLES, spread evenly.

    counts: `(S,)` views that saw through each, since the last that saw a surface there.
    """

    points: F32
    counts: I8

    @classmethod
    def of(cls, points: F32) -> Evidence:
        """None yet, for a cloud `(N, 3)`."""
        samples = _spread(points)
        return cls(samples, np.zeros(len(samples), np.int8))

    def seen(self, said: I8) -> Evidence:
        """After one more view, `said` `(S,)` of its places by `sight`; itself where that changes nothing."""
        more = np.minimum(self.counts, _MOST_COUNT - 1) + np.int8(1)
        counts = np.where(said == THROUGH, more, np.where(said == THERE, np.int8(0), self.counts))
        return self if np.array_equal(counts, self.counts) else Evidence(self.points, counts)

    def cleared(self) -> Evidence:
        """After a view that found the object; itself where nothing was known against it."""
        return Evidence(self.points, np.zeros_like(self.counts)) if self.counts.any() else self

    def departed(self, params: PresenceParams) -> bool:
        """Whether enough of it was seen through often enough.

        Never before `through_frames` views; at the latest with the `through_frames`-th view that sees through the same
        more than `departed_share` (or `small_share`) of the places, where no view between sees a surface there.
        """
        if not self.counts.any():
            return False
        longest = float((self.points.max(axis=0) - self.points.min(axis=0)).max())
        share = params.small_share if longest <= params.small else params.departed_share
        return float((self.counts >= params.through_frames).mean()) > share

    def renewed(self, points: F32) -> Evidence:
        """For the object's new cloud `(N, 3)`: places take over what was known of the old ones they lie at."""
        fresh = Evidence.of(points)
        if not len(fresh.points) or not self.counts.any():
            return fresh
        distance, nearest = cKDTree(self.points).query(fresh.points)
        return Evidence(
            fresh.points, np.where(distance <= 2 * _FINEST, self.counts[nearest], 0).astype(np.int8)
        )


def _spread(points: F32) -> F32:
    """At most MOST_SAMPLES of `(N, 3)` points: one a voxel, of voxels not much coarser than need be.

    Of a surface at the finest, every step by the square root of 2 leaves half.
    """
    steps = max(0, int(np.log2(max(1, len(points)) / MOST_SAMPLES)) - 1)
    size = _FINEST * 2.0 ** (steps / 2)
    chosen = np.unique(voxel_keys(points, size), return_index=True)[1]
    while len(chosen) > MOST_SAMPLES:
        size *= np.sqrt(2.0)
        chosen = np.unique(voxel_keys(points, size), return_index=True)[1]
    return np.asarray(points[np.sort(chosen)], np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Looks:
    """N objects as they can be recognised: features `(N, D)` unit, labels, first and last seen `(N,)` nanoseconds."""

    features: F32
    labels: Sequence[str]
    first_seen_ns: I64
    last_seen_ns: I64


def matching_departed(
    candidate: Looks, departed: Looks, present: Looks, params: PresenceParams
) -> int | None:
    """Which of the departed objects turned up again as the candidate (one row), None for none or no telling.

    It has the candidate's label, was last seen before the candidate was first, looks like it, and like it more than
    any other such departed object, by `same_lead`, and more than it looks like any of `present`, the other objects
    in place: of three equal chairs nobody can say which one moved.
    """
    label, since = candidate.labels[0], candidate.first_seen_ns[0]
    before = np.flatnonzero(_labelled(departed, label) & (departed.last_seen_ns < since))
    if not len(before):
        return None
    alike = _cosines(departed.features[before], candidate.features[0])
    best = int(alike.argmax())
    rivals = _cosines(present.features[_labelled(present, label)], departed.features[before[best]])
    second = np.concatenate([np.delete(alike, best), rivals]).max(initial=-1.0)
    found = alike[best] > params.same_cosine and alike[best] - second >= params.same_lead
    return int(before[best]) if found else None


def _labelled(looks: Looks, label: str) -> Bools:
    return np.array([other == label for other in looks.labels], dtype=bool)


def _cosines(features: F32, feature: F32) -> F64:
    """Of unit features `(N, D)` with one `(D,)` -> `(N,)`, each the same to the bit in any company."""
    return np.asarray(np.einsum("nd,d->n", features.astype(np.float64), feature.astype(np.float64)))
