"""A robot's walk over the crowded floor: frames of what stands before it, with what its depth camera measured."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from lab.bench.mapping_world import CAMERA, SITE_THINGS, CrowdedFloor, Thing, cell_of, middle_of, site_at
from ovip.scene.types import F32, F64, I64, NEAREST_BLOCK, DetectionBatch

_FRAMES_A_SITE = 5
_REACH = 3  # sites around the one looked at that the camera may see
_FARTHEST = 7.0  # metres: a wall behind everything
_BEFORE = np.array([-1.5, -1.5, 1.7])  # of what it looks at, on the side that things show


class Walk:
    """Frames `first`, `first + 1`, ... over the first `objects` things; each sees the `detections` nearest ones."""

    def __init__(self, floor: CrowdedFloor, objects: int, detections: int, first: int) -> None:
        self._floor = floor
        self._objects = objects
        self._detections = detections
        self._frame = first
        self._site = functools.lru_cache(maxsize=256)(floor.site)

    def frames(self, count: int) -> Iterator[DetectionBatch]:
        """The next `count` frames: five at a site, then five at the next one along a row of sites."""
        for _ in range(count):
            yield self._look(self._frame)
            self._frame += 1

    def _look(self, frame: int) -> DetectionBatch:
        side = max(1, math.isqrt(self._objects // SITE_THINGS))
        step = frame // _FRAMES_A_SITE
        at = site_at(step % side, (side // 2 + step // side) % side)
        around = self._around(at)
        pose = _pose(np.append(middle_of(at), 0.4))
        nearest = _nearest(np.concatenate([thing.points for thing in around]), pose)
        return self._floor.batch(around[: self._detections], frame, pose, nearest)

    def _around(self, site: int) -> list[Thing]:
        """Things of the sites around one, the nearest sites' first."""
        column, row = cell_of(site)
        cells = [
            (max(column + x, 0), max(row + y, 0))
            for x in range(-_REACH, _REACH + 1)
            for y in range(-_REACH, _REACH + 1)
        ]
        numbers = {site_at(*cell) for cell in cells}
        near = sorted(numbers, key=lambda n: (round(math.dist(middle_of(n), middle_of(site)), 6), n))
        return [thing for n in near for thing in self._standing(n)]

    def _standing(self, number: int) -> Sequence[Thing]:
        return self._site(number)[: max(0, self._objects - number * SITE_THINGS)]


def _pose(target: F64) -> F64:
    """world_from_camera `(4, 4)` from `_BEFORE` a target `(3,)`, looking at it."""
    forward = -_BEFORE / np.linalg.norm(_BEFORE)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = right, np.cross(forward, right), forward
    pose[:3, 3] = target + _BEFORE
    return pose


def _nearest(points: F32, pose: F64) -> F32:
    """What depth is nearest in each block of the image `(h, w)`: points `(N, 3)`, the floor, or the wall behind."""
    k, (height, width) = CAMERA, (CAMERA.height // NEAREST_BLOCK, CAMERA.width // NEAREST_BLOCK)
    nearest = _floor_depth(pose, height, width)
    camera = (points - pose[:3, 3].astype(np.float32)) @ pose[:3, :3].astype(np.float32)
    x, y, z = camera[camera[:, 2] > 0.3].T
    column = np.floor((k.fx * x / z + k.cx + 0.5) / NEAREST_BLOCK).astype(np.int64)
    row = np.floor((k.fy * y / z + k.cy + 0.5) / NEAREST_BLOCK).astype(np.int64)
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    _lower(nearest.reshape(-1), row[inside] * width + column[inside], z[inside])
    return nearest


def _lower(values: F32, at: I64, candidates: F32) -> None:
    order = np.argsort(-candidates)  # the nearest is written last
    values[at[order]] = np.minimum(values[at[order]], candidates[order])


def _floor_depth(pose: F64, height: int, width: int) -> F32:
    k = CAMERA
    u, v = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    rays = np.stack(
        [(u * NEAREST_BLOCK - k.cx) / k.fx, (v * NEAREST_BLOCK - k.cy) / k.fy, np.ones(u.shape)], 2
    )
    falling = np.minimum(rays @ pose[2, :3], -1e-6)
    return np.asarray(np.minimum(-pose[2, 3] / falling, _FARTHEST), np.float32)
