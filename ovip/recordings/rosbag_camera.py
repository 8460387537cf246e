"""The colour camera of a ROS bag: by CameraInfo, or by option."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ovip.errors import InvalidInput
from ovip.recordings.layout import ImageSource, Options
from ovip.recordings.text import parse_numbers
from ovip.scene.camera import check_intrinsics
from ovip.scene.types import Intrinsics

_SLIGHT = 1e-3


def camera_of(
    info: Any, colors: Sequence[ImageSource], options: Options
) -> tuple[Intrinsics, tuple[str, ...]]:
    """Intrinsics for the size of the images, and what there is to say of them in words."""
    header = next((found for found in (image.header() for image in colors) if found), None)
    if header is None:
        raise InvalidInput("expected colour images in JPEG or PNG, got none that is")
    given = options.get("intrinsics")
    if given is not None:
        return _given(given, header.width, header.height), ()
    if info is None:
        raise InvalidInput("expected CameraInfo of the colour camera; give intrinsics=fx,fy,cx,cy")
    k = info.K if hasattr(info, "K") else info.k
    width, height = info.width or header.width, info.height or header.height
    found = Intrinsics(float(k[0]), float(k[4]), float(k[2]), float(k[5]), int(width), int(height))
    return check_intrinsics(found), _distortion(info.D if hasattr(info, "D") else info.d)


def _given(word: str, width: int, height: int) -> Intrinsics:
    numbers = parse_numbers(word, "option intrinsics")
    if numbers.size != 4:
        raise InvalidInput(f"option intrinsics: expected fx,fy,cx,cy, got {word!r}")
    fx, fy, cx, cy = map(float, numbers)
    return check_intrinsics(Intrinsics(fx, fy, cx, cy, width, height))


def _distortion(coefficients: Sequence[float]) -> tuple[str, ...]:
    strongest = max((abs(float(value)) for value in coefficients), default=0.0)
    if strongest <= _SLIGHT:
        return ()
    note = f"the camera's lens distortion (up to {strongest:.2g}) is not undone: use rectified images if there are"
    return (note,)
