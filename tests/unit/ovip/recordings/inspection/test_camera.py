"""Checks of intrinsics, depth and up, on numbers."""

from __future__ import annotations

import numpy as np
import pytest

from ovip.recordings.inspection.camera import check_depth, check_intrinsics, check_up
from ovip.recordings.inspection.views import View
from ovip.scene.types import Intrinsics


def view(value: int, scale: float = 1000, missing: float = 0.0) -> View:
    raw = np.full((30, 40), value, np.uint16)
    raw[: round(30 * missing)] = 0
    return View(np.zeros((30, 40), np.uint8), raw, (raw / scale).astype(np.float32))


def test_a_usual_camera_is_ok() -> None:
    found = check_intrinsics(Intrinsics(320, 320, 319.5, 239.5, 640, 480))
    assert found.level == "ok"
    assert found.figures["fov_x_deg"] == pytest.approx(90)
    assert found.says == "sees 90 x 74 degrees, principal point (319.5, 239.5)"


@pytest.mark.parametrize(
    ("k", "level", "says"),
    [
        (Intrinsics(525, 525, 240, 320, 640, 480), "wrong", "cx and cy look swapped"),
        (Intrinsics(525, 525, 159.5, 119.5, 640, 480), "wrong", "the principal point is far from the middle"),
        (Intrinsics(525, 525, 400, 239.5, 640, 480), "warning", "the principal point is far from the middle"),
        (Intrinsics(2000, 2000, 319.5, 239.5, 640, 480), "warning", "expected a view of 30 to 120 degrees"),
        (Intrinsics(100, 100, 319.5, 239.5, 640, 480), "warning", "expected a view of 30 to 120 degrees"),
        (Intrinsics(525, 400, 319.5, 239.5, 640, 480), "warning", "pixels are not square (fx / fy 1.31)"),
    ],
)
def test_a_camera_that_does_not_fit_its_images_is_told(k: Intrinsics, level: str, says: str) -> None:
    found = check_intrinsics(k)
    assert found.level == level
    assert found.says.startswith(says)


def test_a_square_image_has_no_swapped_centre() -> None:
    assert check_intrinsics(Intrinsics(256, 256, 255.5, 255.5, 512, 512)).level == "ok"


def test_depth_of_the_size_of_rooms_is_ok() -> None:
    found = check_depth([view(2000), view(2000)], 1000)
    assert (found.level, found.figures["median_m"]) == ("ok", 2.0)


def test_depth_that_is_too_far_or_too_near_names_the_scales_that_fit() -> None:
    far = check_depth([view(12000)], 1000)
    assert far.level == "wrong"
    assert far.says.startswith(
        "not the size of rooms at 1000 units a metre (5000 or 6553.5 or 4000 or 10000 would fit)"
    )
    near = check_depth([view(1500)], 6553.5)
    assert near.level == "wrong"
    assert "1000" in near.says
    assert "no known scale would fit" in check_depth([view(20)], 1000).says


@pytest.mark.parametrize(
    ("missing", "level"), [(0.4, "ok"), (0.6, "warning"), (0.97, "wrong"), (1.0, "wrong")]
)
def test_missing_depth_is_told(missing: float, level: str) -> None:
    found = check_depth([view(2000, missing=missing)], 1000)
    assert found.level == level
    assert found.figures["missing"] == pytest.approx(missing, abs=0.02)


def test_a_largest_value_that_occurs_often_may_mean_none() -> None:
    full = view(2000)
    full.raw[:3] = 65535
    found = check_depth([full], 1000)
    assert found.level == "warning"
    assert found.says.startswith("10% of it is 65535, which may mean none")


def test_up_that_cannot_be_told_is_said_not_guessed() -> None:
    found = check_up([(np.eye(4), view(0))], Intrinsics(40, 40, 19.5, 14.5, 40, 30), np.eye(4))
    assert found.level == "warning"
    assert found.says.startswith("not checked: expected a floor or a table below the cameras")
