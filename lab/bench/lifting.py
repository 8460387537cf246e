"""What lifting the masks of one large frame costs, beside the former way, one mask at a time (SPEC 1.6)."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from lab.bench.rows import Row
from ovip.scene.camera import lift_pixels, project
from ovip.scene.clusters import clusters
from ovip.scene.types import F32, F64, I64, Bools, Frame, Intrinsics
from ovip.scene.voxels import downsample
from services.perception.domain.lifting import LiftParams, clouds_of_masks, lift_all, main_clusters

CAMERA = Intrinsics(600.0, 600.0, 599.5, 339.5, 1200, 680)
"""1200 x 680 pixels, as Replica is rendered."""

_SMALLEST, _LARGEST = 500, 60_000  # pixels of a mask
_DEPTH_NOISE = (0.0012, 0.0019)  # metres at 0.4 m, and by the square of what is beyond (Nguyen et al. 2012)
_RADII = (
    0.06,
    0.1,
)  # metres of the exact clusters that the cells' are compared with; ConceptGraphs' is the last


@dataclass(frozen=True, slots=True, eq=False)
class Looked:
    """A frame and the masks `(H, W)` in it."""

    frame: Frame
    masks: tuple[Bools, ...]


def measure_lifting(
    masks: int = 20,
    repeats: int = 15,
    former_repeats: int = 2,
    seed: int = 0,
    params: LiftParams | None = None,
) -> Row:
    """Milliseconds (medians) for the masks of a synthetic frame, and how often the clusters are the exact ones.

    lift_ms: all of it, masks to boxes; denoise_ms: the largest clusters alone; former_ms: mask by mask with
    full-frame erosion and a KD-tree over points, radius 0.1 as in ConceptGraphs; ratio: of it to lift_ms.
    same_share, iou: of the points kept, against exact clusters of either radius.
    """
    params, look = params or LiftParams(), synthetic_look(masks, seed)
    clouds = clouds_of_masks(look.frame, look.masks, params)
    lift_ms = _median_ms(lambda: lift_all(look.frame, look.masks, params), repeats)
    former_ms = _median_ms(
        lambda: [lift_one(look.frame, mask, params, _RADII[-1]) for mask in look.masks], former_repeats
    )
    return {
        "masks": masks,
        "mask_pixels": int(sum(mask.sum() for mask in look.masks)),
        "points": len(clouds.owners),
        "lift_ms": round(lift_ms, 2),
        "denoise_ms": round(_median_ms(lambda: main_clusters(clouds, params), repeats), 2),
        "former_ms": round(former_ms, 1),
        "ratio": round(former_ms / lift_ms, 1),
        **{name: value for radius in _RADII for name, value in agreement(look, params, radius).items()},
    }


def agreement(look: Looked, params: LiftParams, radius: float) -> Row:
    """Share of the masks whose kept points are the same as those of exact clusters, and the mean IoU of the two."""
    clouds = clouds_of_masks(look.frame, look.masks, params)
    kept, ious = main_clusters(clouds, params), []
    for owner in np.unique(clouds.owners):
        own = clouds.owners == owner
        labels = clusters(clouds.points[own], radius)
        exact = labels == np.bincount(labels).argmax()
        ious.append(float((exact & kept[own]).sum() / (exact | kept[own]).sum()))
    name = f"{radius:g}"
    return {
        f"same_share_{name}": round(float(np.mean(np.array(ious) == 1.0)), 3),
        f"iou_{name}": round(float(np.mean(ious)), 4),
    }


def lift_one(frame: Frame, mask: Bools, params: LiftParams, radius: float) -> F32:
    """The former way: points `(N, 3)` of one mask's largest exact cluster, one a voxel."""
    kernel = np.ones((2 * params.edge + 1,) * 2, np.uint8)
    inner = cv2.erode(mask.astype(np.uint8), kernel, borderValue=0).astype(bool)
    index = np.flatnonzero(inner & (frame.depth > 0) & (frame.depth <= params.max_depth))
    points = lift_pixels(index, frame.depth.ravel()[index], frame.intrinsics, frame.world_from_camera)
    thin, _ = downsample(points, params.voxel, frame.rgb.reshape(-1, 3)[index])
    labels = clusters(thin, radius)
    return thin[labels == np.bincount(labels).argmax()] if len(thin) else thin


def synthetic_look(masks: int = 20, seed: int = 0, noise: bool = True) -> Looked:
    """A furnished room of boxes seen from one place: tables with legs, things on them, cupboards, pictures, walls.

    The masks are the exact ones of the `masks` largest things of 500 to 60,000 pixels.
    """
    rng = np.random.default_rng(seed)
    pose = _pose(height=1.4, pitch=0.3)
    depth, ids = _cast(_things(rng), pose)
    pixels = np.bincount(ids.ravel())
    largest = np.argsort(-pixels, kind="stable")
    chosen = [i for i in largest if i and _SMALLEST <= pixels[i] <= _LARGEST][:masks]
    if noise:
        base, growth = _DEPTH_NOISE
        depth = depth + rng.standard_normal(depth.shape) * (base + growth * (depth - 0.4) ** 2)
    rgb = rng.integers(0, 256, (len(pixels), 3), dtype=np.uint8)[ids]
    frame = Frame("synthetic", 0, CAMERA, pose, rgb, np.maximum(depth, 0).astype(np.float32))
    return Looked(frame, tuple(ids == i for i in chosen))


def _things(rng: np.random.Generator) -> list[F64]:
    """What stands before the camera, which looks along +x from over the origin: each thing's boxes `(B, 6)`, metres."""
    things: list[F64] = []
    for x, y in [(1.5, -1.4), (1.1, 0.3), (2.7, -0.6), (2.6, 1.3), (2.6, -2.6), (4.0, -2.0)]:
        things += _laid_table(np.array([x, y, 0.0]), rng.uniform([0.6, 0.7, 0.4], [0.9, 1.1, 0.78]), rng)
    for y in np.arange(-3.2, 3.0, 0.8):
        deep, tall = rng.uniform([0.3, 0.8], [0.9, 2.2])
        cupboard = [5.2 - deep, y, 0, 5.2, y + 0.7, tall]
        picture = [5.16, y, 1.5, 5.19, y + rng.uniform(0.3, 0.6), 2.1]
        things += [np.array([cupboard]), np.array([picture])]
    for x, y in [(2.1, 0.1), (1.9, 2.4), (1.3, -2.1), (4.2, 0.3)]:
        seat, back = [x, y, 0, x + 0.45, y + 0.45, 0.45], [x + 0.4, y, 0.45, x + 0.45, y + 0.45, 0.9]
        things.append(np.array([seat, back]))
    return things


def _laid_table(at: F64, size: F64, rng: np.random.Generator) -> list[F64]:
    """A table of top and legs with its low corner at a place `(3,)`, and six things on it."""
    (x, y, _), (deep, wide, tall) = at, size
    legs = [
        [x + dx, y + dy, 0, x + dx + 0.05, y + dy + 0.05, tall - 0.03]
        for dx in (0, deep - 0.05)
        for dy in (0, wide - 0.05)
    ]
    things = [np.array([[x, y, tall - 0.03, x + deep, y + wide, tall], *legs])]
    for number in range(6):
        low = at + np.array([0.05 + deep / 2 * (number % 2), 0.05 + wide / 3 * (number // 2), tall])
        things.append(np.array([[*low, *(low + rng.uniform(0.06, [0.24, 0.24, 0.34]))]]))
    return things


def _pose(height: float, pitch: float) -> F64:
    """world_from_camera at a height over the origin, looking along +x and down by `pitch` radians."""
    forward, right = np.array([np.cos(pitch), 0, -np.sin(pitch)]), np.array([0.0, -1.0, 0.0])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[2, 3] = right, np.cross(forward, right), forward, height
    return pose


def _median_ms(work: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        times.append((time.perf_counter() - began) * 1e3)
    return float(np.median(times))


def _cast(things: Sequence[F64], pose: F64) -> tuple[F64, I64]:
    """Depth `(H, W)` metres and the number of the nearest thing `(H, W)` from 1; 0 is the room itself."""
    rows, columns = np.mgrid[: CAMERA.height, : CAMERA.width]
    rays = np.stack([(columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy, np.ones(rows.shape)])
    rays = np.einsum("ij,jhw->ihw", pose[:3, :3], rays)
    rays = np.where(np.abs(rays) < 1e-9, 1e-9, rays)
    room = np.array([-6.0, -3.3, 0.0, 5.2, 3.3, 2.6])
    depth, ids = _slabs(room, rays, pose[:3, 3])[1].min(axis=0), np.zeros(rows.shape, np.int64)
    for number, box in ((number, box) for number, boxes in enumerate(things, start=1) for box in boxes):
        window = _window(box, pose)
        low, high = _slabs(box, rays[:, *window], pose[:3, 3])
        enter = low.max(axis=0)
        nearer = (enter < high.min(axis=0)) & (enter > 0) & (enter < depth[window])
        depth[window][nearer], ids[window][nearer] = enter[nearer], number
    return depth, ids


def _window(box: F64, pose: F64) -> tuple[slice, slice]:
    """The part of the image that a box in front of the camera lies in."""
    corners = np.array(
        [[box[3 * (i & 1)], box[1 + 3 * (i >> 1 & 1)], box[2 + 3 * (i >> 2)]] for i in range(8)]
    )
    uv, _ = project(corners, CAMERA, pose)
    (left, top), (right, bottom) = np.floor(uv.min(axis=0)), np.ceil(uv.max(axis=0)) + 1
    return (
        slice(int(np.clip(top, 0, CAMERA.height)), int(np.clip(bottom, 0, CAMERA.height))),
        slice(int(np.clip(left, 0, CAMERA.width)), int(np.clip(right, 0, CAMERA.width))),
    )


def _slabs(box: F64, rays: F64, origin: F64) -> tuple[F64, F64]:
    """Depth at which rays `(3, H, W)` enter and leave a box, axis by axis: `(3, H, W)` each."""
    a = (box[:3, None, None] - origin[:, None, None]) / rays
    b = (box[3:, None, None] - origin[:, None, None]) / rays
    return np.minimum(a, b), np.maximum(a, b)
