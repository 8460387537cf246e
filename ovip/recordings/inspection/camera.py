"""Checks of the camera and its depth: intrinsics fit the image, depth is of the size of rooms, up is as said."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.inspection.finding import Finding
from ovip.recordings.inspection.views import View
from ovip.recordings.scales import KNOWN_SCALES
from ovip.recordings.up import find_up
from ovip.scene.types import F64, Intrinsics

FIELD_OF_VIEW = (30.0, 120.0)
OFF_CENTRE = 0.1
MEDIAN_DEPTH = (0.3, 10.0)
MOST_MISSING, ALL_MISSING = 0.5, 0.95
UP_OK, UP_WRONG = 5.0, 15.0
_FULL = 65535


def check_intrinsics(k: Intrinsics) -> Finding:
    """Whether the camera could have taken such images."""
    across, down = (
        math.degrees(2 * math.atan(size / 2 / focal)) for size, focal in ((k.width, k.fx), (k.height, k.fy))
    )
    off_x, off_y = (k.cx - (k.width - 1) / 2) / k.width, (k.cy - (k.height - 1) / 2) / k.height
    figures = {"fov_x_deg": across, "fov_y_deg": down, "off_centre_x": off_x, "off_centre_y": off_y}
    says = f"sees {across:.0f} x {down:.0f} degrees, principal point ({k.cx:.1f}, {k.cy:.1f})"
    low, high = FIELD_OF_VIEW
    if _swapped(k):
        return Finding("intrinsics", "wrong", f"cx and cy look swapped: {says}", figures)
    off = max(abs(off_x), abs(off_y))
    if off > OFF_CENTRE:
        told = (
            f"the principal point is far from the middle of {k.width}x{k.height}; are the intrinsics those of "
            f"another image size? {says}"
        )
        return Finding("intrinsics", "wrong" if off > 2 * OFF_CENTRE else "warning", told, figures)
    if not (low <= across <= high and low <= down <= high):
        return Finding(
            "intrinsics", "warning", f"expected a view of {low:g} to {high:g} degrees: {says}", figures
        )
    if not 0.9 < k.fx / k.fy < 1.1:
        return Finding(
            "intrinsics", "warning", f"pixels are not square (fx / fy {k.fx / k.fy:.2f}): {says}", figures
        )
    return Finding("intrinsics", "ok", says, figures)


def _swapped(k: Intrinsics) -> bool:
    near = abs(k.cx - k.height / 2) < 0.05 * k.height and abs(k.cy - k.width / 2) < 0.05 * k.width
    return near and abs(k.width - k.height) > 0.1 * k.width


def check_depth(views: Sequence[View], scale: float) -> Finding:
    """Whether depth is there, and of the size of rooms; `scale` in units per metre."""
    raw = np.concatenate([view.raw.ravel() for view in views]) if views else np.zeros(1, np.uint16)
    some = raw[raw > 0]
    missing = 1 - some.size / raw.size
    if missing > ALL_MISSING:
        return Finding("depth", "wrong", f"{missing:.0%} of depth is missing", {"missing": missing})
    low, middle, high = (float(value) / scale for value in np.quantile(some, (0.05, 0.5, 0.95)))
    figures = {"median_m": middle, "low_m": low, "high_m": high, "missing": missing, "scale": scale}
    says = f"median {middle:.2f} m (5 to 95 %: {low:.2f} to {high:.2f}), {missing:.0%} missing"
    if not MEDIAN_DEPTH[0] <= middle <= MEDIAN_DEPTH[1]:
        fitting = [known for known in KNOWN_SCALES if 0.5 <= middle * scale / known <= 6]
        told = " or ".join(f"{known:g}" for known in fitting) or "no known scale"
        return Finding(
            "depth",
            "wrong",
            f"not the size of rooms at {scale:g} units a metre ({told} would fit): {says}",
            figures,
        )
    if (raw == _FULL).mean() > 0.01:
        return Finding(
            "depth",
            "warning",
            f"{(raw == _FULL).mean():.0%} of it is {_FULL}, which may mean none: {says}",
            figures,
        )
    if missing > MOST_MISSING:
        return Finding("depth", "warning", f"much is missing: {says}", figures)
    return Finding("depth", "ok", says, figures)


def check_up(views: Sequence[tuple[F64, View]], k: Intrinsics, world_from_source: F64) -> Finding:
    """Whether floors and tables face +z in the world that the poses `(4, 4)` lead to."""
    try:
        up = find_up([(view.metres, pose) for pose, view in views], k)
    except InvalidInput as error:
        return Finding("up", "warning", f"not checked: {str(error).removeprefix('up: ')}")
    angle = math.degrees(math.acos(max(-1.0, min(1.0, float(up[2])))))
    source = world_from_source[:3, :3].T @ up
    words = ",".join(f"{value:.3f}" for value in source)
    figures = {"angle_deg": angle, "up_in_source": source.round(4).tolist()}
    if angle < UP_OK:
        return Finding("up", "ok", f"floors and tables face z to {angle:.1f} degrees", figures)
    return Finding(
        "up",
        "wrong" if angle > UP_WRONG else "warning",
        f"the world is not z up: floors and tables face {angle:.0f} degrees away from it; pass --up {words}",
        figures,
    )
