"""Pinhole cameras: checking poses and intrinsics, lifting depth to the world, projecting back (SPEC 0).

Camera frame: x right, y down, z forward. `world_from_camera` is a rigid 4x4. Depth is z-depth in metres.
"""

from __future__ import annotations

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.types import F32, F64, I64, Bools, Intrinsics

ROTATION_TOLERANCE = 1e-3
FARTHEST_WORLD = 1e4  # metres; a pose beyond is a broken pose, and voxels of 2 cm reach 20 km


def check_pose(pose: F64) -> F64:
    """`pose` as a float64 `(4, 4)`; InvalidInput where it is not finite, not rigid or absurdly far."""
    pose = np.asarray(pose, dtype=np.float64)
    if pose.shape != (4, 4):
        raise InvalidInput(
            f"pose: expected 16 numbers (4x4 row-major world_from_camera), got shape {pose.shape}"
        )
    if not np.isfinite(pose).all():
        raise InvalidInput(
            "pose: expected finite numbers, got NaN or infinity (tracking lost? skip the frame)"
        )
    # entries beyond 1 are wrong already; squares of huge ones overflow
    rotation = np.clip(pose[:3, :3], -2.0, 2.0)
    error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    determinant = float(rotation[0] @ np.cross(rotation[1], rotation[2]))
    if error > ROTATION_TOLERANCE or determinant < 0:
        raise InvalidInput(
            "pose: expected a rigid world_from_camera "
            f"(rotation orthonormal within {ROTATION_TOLERANCE}, right-handed), "
            f"got a rotation off by {error:.3g} with determinant {determinant:.3g}"
        )
    if np.abs(pose[3] - [0, 0, 0, 1]).max() > 1e-6:
        raise InvalidInput(f"pose: expected last row 0 0 0 1, got {pose[3].tolist()}")
    if np.abs(pose[:3, 3]).max() > FARTHEST_WORLD:
        raise InvalidInput(
            f"pose: expected a position in metres within {FARTHEST_WORLD:.0f}, got {pose[:3, 3].tolist()}"
        )
    return pose


def check_intrinsics(k: Intrinsics) -> Intrinsics:
    """`k` itself; InvalidInput where it cannot be a pinhole camera's."""
    if not np.isfinite([k.fx, k.fy, k.cx, k.cy]).all():
        raise InvalidInput("intrinsics: expected finite fx, fy, cx, cy")
    if not (16 <= k.width <= 8192 and 16 <= k.height <= 8192):
        raise InvalidInput(
            f"intrinsics: expected width and height of 16 to 8192 pixels, got {k.width}x{k.height}"
        )
    if not (0.1 * k.width < k.fx < 20 * k.width and 0.1 * k.height < k.fy < 20 * k.height):
        raise InvalidInput(
            f"intrinsics: expected focal lengths in pixels between 0.1 and 20 image sizes, got fx {k.fx}, fy {k.fy} "
            f"for {k.width}x{k.height}"
        )
    if not (-0.5 * k.width < k.cx < 1.5 * k.width and -0.5 * k.height < k.cy < 1.5 * k.height):
        raise InvalidInput(
            f"intrinsics: expected the principal point near the image, got cx {k.cx}, cy {k.cy}"
        )
    return k


def backproject(
    depth: F32, k: Intrinsics, world_from_camera: F64, mask: Bools | None = None
) -> tuple[F32, I64]:
    """World points `(N, 3)` of the pixels that have depth (and lie in `mask`), and their flat pixel index `(N,)`.

    depth: `(H, W)` metres, 0 = none.
    """
    keep = depth > 0 if mask is None else (depth > 0) & mask
    index = np.flatnonzero(keep)
    return lift_pixels(index, depth.ravel()[index], k, world_from_camera), index


def lift_pixels(index: I64, z: F32, k: Intrinsics, world_from_camera: F64) -> F32:
    """World points `(N, 3)` of flat pixel indices `(N,)` at depths `(N,)` metres."""
    rows, columns = np.divmod(index, k.width)
    camera = np.empty((len(index), 3), dtype=np.float64)
    camera[:, 0] = (columns - k.cx) / k.fx * z
    camera[:, 1] = (rows - k.cy) / k.fy * z
    camera[:, 2] = z
    world = camera @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    return world.astype(np.float32)


def project(points: F32 | F64, k: Intrinsics, world_from_camera: F64) -> tuple[F64, F64]:
    """Pixels `(N, 2)` (x, y) and depths `(N,)` of world points; meaningless pixels where depth <= 0."""
    camera = (np.asarray(points, np.float64) - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]
    z = camera[:, 2]
    safe = np.where(z > 1e-9, z, 1e-9)
    uv = np.stack([k.fx * camera[:, 0] / safe + k.cx, k.fy * camera[:, 1] / safe + k.cy], axis=1)
    return uv, z
