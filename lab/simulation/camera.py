"""The simulated robot's camera: its intrinsics, where it sits, and the pose that looks a given way."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ovip.scene.types import F64, Intrinsics

EYE_HEIGHT, PITCH = 1.3, -0.28  # of the robot's camera: metres above the floor, radians
CAMERA = Intrinsics(fx=230.0, fy=230.0, cx=159.5, cy=119.5, width=320, height=240)


def pose_looking(position: npt.ArrayLike, yaw: float, pitch: float) -> F64:
    """world_from_camera `(4, 4)` at `position` (x, y, z metres), looking along `yaw` and `pitch`, no roll.

    yaw: radians from +x towards +y. pitch: radians, positive looks up. Camera x right, y down, z forward.
    """
    forward = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)])
    right = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = position
    return pose
