"""Which way is up in a recording whose world is not z-up: given, or found as the floor's or a table's normal.

Finding it: local planes of a few depth images vote for directions near the cameras' own mean "up" (their -y);
of the directions voted for, the one with the largest plane below the cameras wins, and is refined on all its
planes at once. No randomness: the same images give the same answer.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64, Bools, Intrinsics

Up = tuple[float, float, float] | Literal["auto"] | None

_HINT = "pass --up x,y,z (the direction that points up, in the pose files' frame)"


@dataclass(frozen=True, slots=True)
class UpParams:
    """Distances in metres, areas in square metres a view, angles in degrees.

    farthest: depth used. grid_columns: blocks across an image. largest_tilt: between up and the cameras' mean
    -y. vote_width, support_width: a normal this near a direction counts for it. level_height: thickness of a
    plane. A second direction at least rival_distance away with ambiguous_ratio of the best one's area leaves
    up open.
    """

    farthest: float = 5.0
    grid_columns: int = 80
    most_voters: int = 15000
    largest_tilt: float = 65.0
    vote_width: float = 6.0
    support_width: float = 9.0
    rival_distance: float = 25.0
    level_height: float = 0.05
    below_cameras: float = 0.2
    least_level_area: float = 0.03
    ambiguous_ratio: float = 0.7


def parse_up(text: str) -> tuple[float, float, float] | Literal["auto"]:
    """`--up` as typed: "auto" or "x,y,z"."""
    if text.strip().lower() == "auto":
        return "auto"
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError as error:
        raise InvalidInput(f"up: expected auto or three numbers x,y,z, got {text!r}") from error
    unit = unit_up((x, y, z))
    return (float(unit[0]), float(unit[1]), float(unit[2]))


def unit_up(up: tuple[float, float, float]) -> F64:
    """`up` as a unit vector `(3,)`; InvalidInput where it has no direction."""
    vector = np.asarray(up, dtype=np.float64)
    if vector.shape != (3,) or not np.isfinite(vector).all() or np.linalg.norm(vector) < 1e-9:
        raise InvalidInput(f"up: expected three finite numbers that are not all zero, got {up!r}")
    return vector / np.linalg.norm(vector)


def rotation_to_z_up(up: F64) -> F64:
    """The smallest rotation `(4, 4)` that takes unit `up` to +z; about x where `up` is straight down."""
    x, y, z = up
    transform = np.eye(4)
    across = x * x + y * y
    if z < 0 and across < 1e-24:
        transform[:3, :3] = np.diag([1.0, -1.0, -1.0])
        return transform
    one_plus_z = 1 + z if z > 0 else across / (1 - z)  # exact where up is nearly straight down
    skew = np.array([[0, 0, -x], [0, 0, -y], [x, y, 0]], dtype=np.float64)
    transform[:3, :3] = np.eye(3) + skew + skew @ skew / one_plus_z
    return transform


def find_up(views: Iterable[tuple[F32, F64]], k: Intrinsics, params: UpParams | None = None) -> F64:
    """Up `(3,)` in the poses' frame, from depth images `(H, W)` metres and their `(4, 4)` poses.

    Raises InvalidInput where the cameras or the planes below them leave it open.
    """
    params = params or UpParams()
    seen = list(views)
    poses = np.array([pose for _, pose in seen]).reshape(-1, 4, 4)
    prior = _cameras_up(poses)
    patches = _Patches.joined([_patches(depth, k, pose, params) for depth, pose in seen])
    tilted = np.cos(np.radians(params.largest_tilt))
    refined = (_refined(start, patches, params) for start in _voted(patches, prior, params))
    candidates = [up for up in refined if up @ prior > tilted]
    scored = sorted(
        ((_support(up, patches, poses, params), up) for up in candidates), key=lambda pair: -pair[0]
    )
    if not scored or scored[0][0] < params.least_level_area:
        raise InvalidInput(
            f"up: expected a floor or a table below the cameras to tell up from, found none; {_HINT}"
        )
    (best, up), rivals = scored[0], scored[1:]
    far = np.cos(np.radians(params.rival_distance))
    for support, other in rivals:
        if up @ other < far and support > params.ambiguous_ratio * best:
            raise InvalidInput(
                f"up: two directions are as likely, {_words(up)} and {_words(other)} "
                f"(planes of {best:.2g} and {support:.2g} square metres a view); {_HINT}"
            )
    return unit_up(
        (round(up[0], 6), round(up[1], 6), round(up[2], 6))
    )  # the last bits differ between machines


@dataclass(frozen=True, slots=True)
class _Patches:
    """Bits of surface: centres `(N, 3)`, unit normals to the camera `(N, 3)`, areas `(N,)` m2 a view."""

    centers: F64
    normals: F64
    areas: F64

    @classmethod
    def joined(cls, parts: list[_Patches]) -> _Patches:
        return cls(
            np.concatenate([np.empty((0, 3)), *(part.centers for part in parts)]),
            np.concatenate([np.empty((0, 3)), *(part.normals for part in parts)]),
            np.concatenate([np.empty(0), *(part.areas for part in parts)]) / max(1, len(parts)),
        )


def _cameras_up(poses: F64) -> F64:
    """Mean of the cameras' -y axes; only a hint, good to some 60 degrees."""
    if len(poses) == 0:
        raise InvalidInput(f"up: expected frames with depth to find up from, got none; {_HINT}")
    mean = -poses[:, :3, 1].mean(axis=0)
    length = float(np.linalg.norm(mean))
    if length < 0.3:
        raise InvalidInput(f"up: the cameras are turned every way, so their own up says nothing; {_HINT}")
    return np.asarray(mean / length)


def _patches(depth: F32, k: Intrinsics, pose: F64, params: UpParams) -> _Patches:
    """Means over square blocks of pixels, normals from their neighbours; blocks over an edge are left out."""
    size = max(1, depth.shape[1] // params.grid_columns)
    rows, columns = depth.shape[0] // size, depth.shape[1] // size
    tiles = depth[: rows * size, : columns * size].reshape(rows, size, columns, size).swapaxes(1, 2)
    blocks = tiles.reshape(rows, columns, size * size).astype(np.float64)
    valid = (blocks > 0) & (blocks < params.farthest)
    z = np.where(valid, blocks, 0).sum(axis=2) / np.maximum(valid.sum(axis=2), 1)
    solid = valid.mean(axis=2) > 0.75
    v, u = np.mgrid[:rows, :columns] * size + (size - 1) / 2
    points = np.stack([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z], axis=2)
    right, left = points[1:-1, 2:], points[1:-1, :-2]
    below, above = points[2:, 1:-1], points[:-2, 1:-1]
    normals = np.cross(below - above, right - left)
    length = np.linalg.norm(normals, axis=2)
    center = points[1:-1, 1:-1]
    bend = np.abs(right + left - 2 * center)[..., 2] + np.abs(below + above - 2 * center)[..., 2]
    keep = solid[1:-1, 1:-1] & solid[1:-1, 2:] & solid[1:-1, :-2] & solid[2:, 1:-1] & solid[:-2, 1:-1]
    keep &= (length > 1e-9) & (bend < 0.02 * z[1:-1, 1:-1])
    center, normal = center[keep], normals[keep] / length[keep][:, None]
    sight = np.linalg.norm(center, axis=1)
    facing = np.einsum("ij,ij->i", normal, center) / sight
    normal = np.where(facing[:, None] > 0, -normal, normal)
    facing = np.abs(facing)
    steep = facing > 0.15
    pixel_area = center[:, 2] ** 2 / (k.fx * k.fy) * size * size
    areas = pixel_area * (center[:, 2] / sight) / facing.clip(0.15)
    rotation = pose[:3, :3]
    return _Patches((center @ rotation.T + pose[:3, 3])[steep], (normal @ rotation.T)[steep], areas[steep])


def _voted(patches: _Patches, prior: F64, params: UpParams) -> list[F64]:
    """Up to five directions near `prior` that most surface faces, apart by the rivals' distance."""
    directions = _sphere(1500)
    directions = directions[directions @ prior > np.cos(np.radians(params.largest_tilt))]
    some = slice(None, None, 1 + len(patches.areas) // params.most_voters)
    near = patches.normals[some] @ directions.T > np.cos(np.radians(params.vote_width))
    votes = patches.areas[some] @ near
    chosen: list[F64] = []
    while len(chosen) < 5 and votes.max(initial=0.0) > 0:
        best = directions[int(votes.argmax())]
        chosen.append(best)
        votes = np.where(directions @ best > np.cos(np.radians(params.rival_distance)), 0.0, votes)
    return chosen


def _sphere(count: int) -> F64:
    """`(count, 3)` unit vectors spread evenly (Fibonacci spiral)."""
    i = np.arange(count) + 0.5
    z = 1 - 2 * i / count
    angle = np.pi * (1 + 5**0.5) * i
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)


def _refined(up: F64, patches: _Patches, params: UpParams) -> F64:
    """`up` after a mean shift over normals and a common-normal fit to all planes that face it."""
    for _ in range(3):
        near = patches.normals @ up > np.cos(np.radians(params.support_width))
        mean = patches.areas[near] @ patches.normals[near]
        if not np.linalg.norm(mean) > 0:
            return up
        up = mean / np.linalg.norm(mean)
    for _ in range(4):
        up = _common_normal(up, patches, params)
    return up


def _common_normal(up: F64, patches: _Patches, params: UpParams) -> F64:
    """The normal shared by the levels along `up`: least scatter within the levels, summed over them."""
    near = patches.normals @ up > np.cos(np.radians(params.support_width))
    heights = patches.centers[near] @ up
    scatter = np.zeros((3, 3))
    for member in _levels(heights, patches.areas[near], params):
        points, weights = patches.centers[near][member], patches.areas[near][member]
        offset = points - weights @ points / weights.sum()
        scatter += (offset * weights[:, None]).T @ offset
    if not scatter.any():
        return up
    normal = np.linalg.eigh(scatter)[1][:, 0]
    normal = normal if normal @ up > 0 else -normal
    return normal if normal @ up > np.cos(np.radians(params.support_width)) else up


def _levels(heights: F64, areas: F64, params: UpParams) -> list[Bools]:
    """Members of the largest levels `(N,)` each, none smaller than a fifth of the largest."""
    left = np.ones(len(heights), dtype=np.bool_)
    levels: list[Bools] = []
    first = 0.0
    while len(levels) < 4 and left.any():
        height, area = _largest_level(heights[left], areas[left], params)
        first = first or area
        if area < first / 5:
            break
        member = left & (np.abs(heights - height) <= params.level_height / 2)
        levels.append(member)
        left &= np.abs(heights - height) > params.level_height
    return levels


def _largest_level(heights: F64, areas: F64, params: UpParams) -> tuple[float, float]:
    """Middle and area of the window one level high that holds most area."""
    step = params.level_height / 5
    low = float(heights.min())
    histogram = np.bincount(((heights - low) / step).astype(np.int64), weights=areas)
    window = np.convolve(histogram, np.ones(5))
    at = int(window.argmax())
    return low + (at - 1.5) * step, float(window[at])


def _support(up: F64, patches: _Patches, poses: F64, params: UpParams) -> float:
    """Area of the largest level along `up` below the cameras, square metres a view."""
    heights = patches.centers @ up
    ceiling = float(np.median(poses[:, :3, 3] @ up)) - params.below_cameras
    member = (patches.normals @ up > np.cos(np.radians(params.support_width))) & (heights < ceiling)
    return _largest_level(heights[member], patches.areas[member], params)[1] if member.any() else 0.0


def _words(direction: F64) -> str:
    return ",".join(f"{value:.3f}" for value in direction)
