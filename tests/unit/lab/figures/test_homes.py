"""Pictures of homes."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

pytest.importorskip("open3d", reason="rendering needs Open3D")

from lab.figures.homes import draw_home, storey_from_above
from ovip.errors import InvalidInput
from tests.unit.lab.simulation.box_homes import box_home


def test_a_storey_from_above_is_upright_and_open() -> None:
    plan = storey_from_above(box_home(), 0, width=545)  # x -0.4..10.5, y -0.4..3.4: 50 pixels a metre
    assert plan.shape == (190, 545, 3)

    def at(x: float, y: float) -> np.ndarray:
        return plan[round((3.4 - y) * 50), round((x + 0.4) * 50)].astype(int)

    red, blue = at(2.0, 2.35), at(9.5, 0.5)  # the mug on the table, the bed
    assert red[0] > 2 * red[1:].max()
    assert blue[2] > 1.5 * blue[:2].max()
    np.testing.assert_array_equal(at(-0.3, 3.3), [255, 255, 255])  # outside: paper


def test_a_home_is_drawn_with_both_storeys(tmp_path: Path) -> None:
    path = draw_home(box_home(storeys=2), tmp_path / "deep" / "home.png")
    picture = cv2.imread(str(path))
    assert picture.shape[1] > 1200
    assert picture.shape[0] > 480 + 200


def test_a_name_that_is_no_pictures_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"home\.nonsense"):
        draw_home(box_home(), tmp_path / "home.nonsense")
