"""Detections for a recording that has none, without a model: pieces of what its depth shows, the same in every view."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ovip.recordings import OnboardDetection, RecordedFrame
from ovip.scene.camera import lift_pixels
from ovip.scene.features import normalize
from ovip.scene.types import F32, F64, I64, Bools, Box2, Intrinsics

_WORDS = (
    "bag",
    "book",
    "bottle",
    "bowl",
    "box",
    "chair",
    "cup",
    "lamp",
    "mat",
    "pan",
    "plant",
    "shelf",
    "sofa",
    "table",
)
_NOISE = 0.27  # two views of a piece have a cosine of about 0.93


@dataclass(frozen=True, slots=True)
class PieceParams:
    """edge: metres of the world's cells that are taken for things. min_pixels: fewer are no detection.

    farthest: metres; dimension: of the features.
    """

    edge: float = 0.4
    min_pixels: int = 400
    farthest: float = 4.0
    dimension: int = 384


def with_pieces(
    frames: Iterable[RecordedFrame], k: Intrinsics, most: int, params: PieceParams
) -> Iterator[RecordedFrame]:
    """The frames with the `most` largest pieces in each as what the robot detected: mask, label and feature.

    A piece is what of the surfaces lies in one cell of the world, and its cell gives it its label and its feature.
    """
    for frame in frames:
        yield replace(frame, onboard=tuple(_pieces(frame, k, most, params)))


def _pieces(
    frame: RecordedFrame, k: Intrinsics, most: int, params: PieceParams
) -> Iterator[OnboardDetection]:
    depth = _depth(frame)
    index = np.flatnonzero((depth > 0) & (depth < params.farthest))
    points = lift_pixels(index, depth.ravel()[index], k, frame.world_from_camera)
    cells, inverse, counts = np.unique(_cells(points, params.edge), return_inverse=True, return_counts=True)
    rng = np.random.default_rng(frame.index)
    for piece in np.argsort(-counts, kind="stable")[:most]:
        if counts[piece] >= params.min_pixels:
            mask = np.zeros(depth.size, np.bool_)
            mask[index[inverse == piece]] = True
            yield _detection(int(cells[piece]), mask.reshape(depth.shape), params.dimension, rng)


def _depth(frame: RecordedFrame) -> F32:
    raw = cv2.imdecode(np.frombuffer(frame.depth_bytes, np.uint8), cv2.IMREAD_UNCHANGED)
    return np.asarray(raw, np.float32) / np.float32(frame.depth_scale)


def _cells(points: F32, edge: float) -> I64:
    """One number `(N,)` for each point's cell; cells beyond 1 km of the origin share numbers."""
    cells = np.floor(points.astype(np.float64) / edge).astype(np.int64) & 0xFFF
    return np.asarray((cells[:, 0] << 24) | (cells[:, 1] << 12) | cells[:, 2])


def _detection(cell: int, mask: Bools, dimension: int, rng: np.random.Generator) -> OnboardDetection:
    own = np.random.default_rng(cell).standard_normal(dimension)
    noise = rng.standard_normal(dimension)
    return OnboardDetection(
        label=_WORDS[cell % len(_WORDS)],
        score=0.9,
        box2=_box(mask),
        mask=mask,
        feature=normalize(_unit(own) + _NOISE * _unit(noise)),
    )


def _unit(vector: F64) -> F32:
    return normalize(vector.astype(np.float32))


def _box(mask: Bools) -> Box2:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return Box2(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
