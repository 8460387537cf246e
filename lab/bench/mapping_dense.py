"""The dense map that ours is measured against: every detection with every object, clouds joined and thinned anew.

What ConceptGraphs (Gu et al., ICRA 2024) does in a frame, written in plain numpy with care: boxes, features and labels
lie ready as arrays (the original stacks them anew in every frame), the cosines are one matrix product, and labels are
compared as numbers. An object keeps its cloud as points, and of every view its mask over the whole image.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.boxes import box_of
from ovip.scene.types import F32, F64, I64, U8, Detection
from ovip.scene.voxels import downsample

NEW = -1


@dataclass(frozen=True, slots=True, eq=False)
class Stacked:
    """N detections or objects: boxes `(N, 6)`, unit features `(N, D)`, labels `(N,)` as numbers."""

    boxes: F64
    features: F32
    labels: I64

    @classmethod
    def of(cls, detections: Sequence[Detection], numbers: Mapping[str, int]) -> Stacked:
        """A frame's detections; numbers: of each label, -1 for another."""
        return cls(
            np.stack([d.box for d in detections]),
            np.stack([d.feature for d in detections]),
            np.array([numbers.get(d.label, NEW) for d in detections], np.int64),
        )


def associate_all_pairs(
    detections: Stacked, objects: Stacked, tau: float = 1.0, label_penalty: float = 0.5
) -> I64:
    """For each of M detections the best of N objects where its score (Eq. 2, a = 0) exceeds tau, else NEW."""
    cosine = detections.features @ objects.features.T
    differs = detections.labels[:, None] != objects.labels[None]
    scores = _all_ious(detections.boxes, objects.boxes) + cosine - label_penalty * differs
    best = scores.argmax(axis=1)
    return np.where(scores[np.arange(len(best)), best] > tau, best, NEW)


@dataclass(slots=True, eq=False)
class DenseObject:
    """points `(N, 3)`, colors `(N, 3)`, feature `(D,)`: the mean of `seen` views; masks: one a view."""

    points: F32
    colors: U8
    feature: F32
    seen: int
    masks: list[object]
    box: F64 | None = None

    def fuse(self, detection: Detection, mask: object, voxel: float) -> None:
        """Joins a view's points to the whole cloud, thins it to a point a voxel again, and boxes it."""
        points = np.concatenate([self.points, detection.points])
        self.points, colors = downsample(points, voxel, np.concatenate([self.colors, detection.colors]))
        assert colors is not None
        self.colors = colors
        self.box = box_of(self.points)
        mean = (self.feature * self.seen + detection.feature) / (self.seen + 1)
        self.feature = np.asarray(mean / np.linalg.norm(mean), np.float32)
        self.seen += 1
        self.masks.append(mask)


def _all_ious(a: F64, b: F64) -> F64:
    low = np.maximum(a[:, None, :3], b[None, :, :3])
    high = np.minimum(a[:, None, 3:], b[None, :, 3:])
    shared = np.prod(np.maximum(high - low, 0.0), axis=2)
    volumes = [np.prod(boxes[:, 3:] - boxes[:, :3], axis=1) for boxes in (a, b)]
    return np.asarray(shared / (volumes[0][:, None] + volumes[1][None] - shared), np.float64)
