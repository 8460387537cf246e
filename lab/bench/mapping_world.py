"""A made-up floor of any number of things at one density, and frames of it: what the mapper is measured on.

The floor is cut into square sites of eight things each, numbered outwards from a corner, so that a smaller floor is a
part of a larger one and every place is as crowded as every other. Each site and each view come from their own seed:
nothing of the floor need be held in memory.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ovip.scene.boxes import box_of
from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, U8, Box2, Detection, DetectionBatch, Intrinsics
from ovip.scene.voxels import voxel_keys

SITE_THINGS = 8
SITE_SIDE = 2.4  # metres
CAMERA = Intrinsics(600.0, 600.0, 599.5, 339.5, 1200, 680)
_PITCH = 0.02  # metres between points of a thing, and the voxels that a detection has one in
_ALONE = 0.89  # share of a thing's points that are the first in their voxel
_ON_TOP = 4  # of a site's things stand on its largest one; the others beside it
_SUNK = 0.03  # metres by which neighbours' boxes go into one another
_JITTER = np.float32(0.003)  # metres by which each point is off, each axis
_FRAME_NS = 33_333_333

# energies of a feature's parts; two views of a thing share all but the last: cosines of 0.93, 0.86 and 0.74
_COMMON, _CLASS, _OWN, _VIEW = 0.74, 0.12, 0.07, 0.07


@dataclass(frozen=True, slots=True, eq=False)
class Thing:
    """One thing of the floor. points: `(N, 3)` of the sides that are seen; feature: `(D,)` its views' common part."""

    label: str
    points: F32
    color: U8
    feature: F32


@dataclass(frozen=True, slots=True)
class CrowdedFloor:
    """Things by the site. points: fewest and most of a detection, about, log-uniform. words: how many labels there are.

    shift: metres by which a frame's pose is off, each axis.
    """

    dimension: int
    points: tuple[int, int] = (500, 5000)
    words: int = 150
    seed: int = 0
    shift: float = 0.01
    _classes: F32 = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_classes", np.array([self._class(label) for label in range(self.words)]))

    def site(self, number: int) -> tuple[Thing, ...]:
        """The eight things of a site, the largest first: what stands on it and beside it reaches a little into it."""
        rng = self._stream("site", number)
        low, high = np.log(self.points)
        counts = np.sort(np.exp(rng.uniform(low, high, SITE_THINGS)))[::-1]
        sizes = _sizes(counts, rng)
        corners = _corners(sizes, rng)
        corners[:, :2] += middle_of(number)
        labels = rng.integers(self.words, size=SITE_THINGS)
        own = self._directions(rng, SITE_THINGS)
        return tuple(
            Thing(
                f"word {label}",
                (_seen_sides(size) + corner).astype(np.float32),
                rng.integers(0, 256, 3).astype(np.uint8),
                self._classes[label] + np.float32(np.sqrt(_OWN)) * direction,
            )
            for size, corner, label, direction in zip(sizes, corners, labels, own, strict=True)
        )

    def things(self, first: int, last: int) -> list[Thing]:
        """Things `first` to `last`, the latter not included, site after site."""
        sites = range(first // SITE_THINGS, -(-last // SITE_THINGS))
        found = [thing for site in sites for thing in self.site(site)]
        return found[first - sites.start * SITE_THINGS :][: last - first]

    def batch(
        self, things: Sequence[Thing], frame: int, pose: F64 | None = None, nearest: F32 | None = None
    ) -> DetectionBatch:
        """A frame that sees `things`: all of it shifted by the frame's pose error, features with noise of their own.

        pose, nearest: the camera's, and what depth it measured; None where it measured none.
        """
        rng = self._stream("frame", frame)
        shift = rng.normal(0, self.shift, 3).astype(np.float32)
        noise = np.float32(np.sqrt(_VIEW)) * self._directions(rng, len(things))
        features = normalize(np.array([thing.feature for thing in things], np.float32) + noise)
        return DetectionBatch(
            frame_id=f"robot.bench.{frame:08d}",
            timestamp_ns=frame * _FRAME_NS,
            intrinsics=CAMERA,
            world_from_camera=np.eye(4) if pose is None else pose,
            detections=tuple(
                _detection(f"robot.bench.{frame:08d}/{index}", thing, feature, shift, rng)
                for index, (thing, feature) in enumerate(zip(things, features, strict=True))
            ),
            surface=np.zeros((0, 3), np.float32),
            nearest=np.zeros((0, 0), np.float32) if nearest is None else nearest,
        )

    def _stream(self, what: str, number: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, len(what), number])

    def _directions(self, rng: np.random.Generator, count: int) -> F32:
        unit: F32 = normalize(rng.standard_normal((count, self.dimension), np.float32))
        return unit

    def _class(self, label: int) -> F32:
        """What all things of a label share: what is common to everything, and the class's own direction."""
        shared = np.full(self.dimension, np.sqrt(_COMMON / self.dimension), np.float32)
        own = np.float32(np.sqrt(_CLASS)) * self._directions(self._stream("label", label), 1)[0]
        return np.asarray(shared + own)


def cell_of(number: int) -> tuple[int, int]:
    """Column and row of a site: squares of 1, 4, 9, ... sites grow around a corner, an L at a time."""
    ring = math.isqrt(number)
    along = number - ring * ring
    return (ring, along) if along <= ring else (2 * ring - along, ring)


def site_at(column: int, row: int) -> int:
    """The number of the site in a cell."""
    ring = max(column, row)
    return ring * ring + (row if column == ring else 2 * ring - column)


def middle_of(number: int) -> F64:
    """The middle `(2,)` of a site, metres."""
    return SITE_SIDE * (np.array(cell_of(number)) + 0.5)


def _sizes(counts: F64, rng: np.random.Generator) -> F64:
    """`(N, 3)` metres of boxes whose three seen sides have room for `counts` points."""
    shapes = rng.uniform(0.6, 1.4, (len(counts), 3))
    area = shapes[:, 0] * shapes[:, 1] + shapes[:, 0] * shapes[:, 2] + shapes[:, 1] * shapes[:, 2]
    return np.asarray(shapes * np.sqrt(counts / _ALONE * _PITCH**2 / area)[:, None])


def _corners(sizes: F64, rng: np.random.Generator) -> F64:
    """Low corners `(N, 3)`: the first around the site's middle, some on it, the others against its four sides."""
    corners = np.zeros_like(sizes)
    width, depth, height = sizes[0]
    corners[0, :2] = -0.5 * sizes[0, :2]
    on_top = slice(1, 1 + _ON_TOP)
    corners[on_top, :2] = rng.uniform(-0.5, 0.5, (_ON_TOP, 2)) * (width, depth) - 0.5 * sizes[on_top, :2]
    corners[on_top, 2] = height - _SUNK
    for side, index in enumerate(range(1 + _ON_TOP, len(sizes))):
        axis, high = side % 2, side // 2
        edge = 0.5 * sizes[0, axis]
        corners[index, axis] = edge - _SUNK if high else _SUNK - edge - sizes[index, axis]
        corners[index, 1 - axis] = -0.5 * sizes[index, 1 - axis]
    return corners


def _seen_sides(size: F64) -> F64:
    """Points `(N, 3)` every `_PITCH` metres on a box's top, front and left side, from its low corner."""
    sides = []
    for fixed, at in ((2, size[2]), (1, 0.0), (0, 0.0)):
        across = [axis for axis in range(3) if axis != fixed]
        grid = np.meshgrid(*(np.arange(0.5 * _PITCH, size[axis], _PITCH) for axis in across))
        side = np.full((grid[0].size, 3), at)
        side[:, across] = np.stack([line.ravel() for line in grid], axis=1)
        sides.append(side)
    return np.concatenate(sides)


def _one_a_voxel(points: F32) -> F32:
    """One point of `(N, 3)` in each voxel, by voxel key: as lifting leaves a detection."""
    _, first = np.unique(voxel_keys(points, _PITCH), return_index=True)
    return points[first]


def _detection(name: str, thing: Thing, feature: F32, shift: F32, rng: np.random.Generator) -> Detection:
    jitter = _JITTER * rng.standard_normal(thing.points.shape, np.float32)
    points = _one_a_voxel(thing.points + shift + jitter)
    x, y = rng.uniform(0, CAMERA.width - 260), rng.uniform(0, CAMERA.height - 260)
    side = 3.0 * np.sqrt(len(points))
    return Detection(
        detection_id=name,
        label=thing.label,
        score=0.8,
        box2=Box2(x, y, x + side, y + side),
        box=box_of(points),
        feature=feature,
        points=points,
        colors=np.broadcast_to(thing.color, points.shape).copy(),
    )
