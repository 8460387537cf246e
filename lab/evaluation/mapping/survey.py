"""What a walk saw of a scene: the reconstruction of its depth, and which objects were in view for long enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lab.simulation.imperfect import SeenFrame
from ovip.scene.camera import backproject
from ovip.scene.types import F32, I64
from ovip.scene.voxels import downsample

DENSE_VOXEL = 0.025
_FOLD_AT = 40


@dataclass(frozen=True, slots=True)
class SurveyParams:
    """An object counts as seen in `frames` views with at least this share of the image's pixels in each.

    25 pixels of 320x240, under which no mask could be lifted, in as many frames as confirm an object.
    """

    frames: int = 3
    share: float = 25 / (320 * 240)


class Survey:
    """Collects frames one at a time."""

    def __init__(self, params: SurveyParams | None = None) -> None:
        self._params = params or SurveyParams()
        self._clouds: list[F32] = []
        self._frames_with = np.zeros(1, np.int64)
        self.frames = 0

    def add(self, seen: SeenFrame) -> SeenFrame:
        """Takes note of a frame, and hands it on."""
        points, _ = backproject(seen.depth, seen.intrinsics, seen.world_from_camera)
        self._clouds.append(downsample(points, DENSE_VOXEL)[0])
        if len(self._clouds) >= _FOLD_AT:
            self._clouds = [self.dense]
        pixels = np.bincount(seen.ids.ravel(), minlength=len(self._frames_with))
        self._frames_with = np.pad(self._frames_with, (0, len(pixels) - len(self._frames_with)))
        self._frames_with += pixels >= self._params.share * seen.ids.size
        self.frames += 1
        return seen

    @property
    def dense(self) -> F32:
        """`(Q, 3)` all depth seen, one point a voxel of DENSE_VOXEL."""
        return downsample(np.concatenate([*self._clouds, np.zeros((0, 3), np.float32)]), DENSE_VOXEL)[0]

    @property
    def seen_ids(self) -> I64:
        """The ids of the objects that were seen for long enough, ascending; not 0."""
        ids = np.flatnonzero(self._frames_with >= self._params.frames)
        return ids[ids > 0]
