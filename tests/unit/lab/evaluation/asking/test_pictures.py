from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from lab.figures.searches import DrawnSearch, draw_searches
from ovip.scene.grid import FREE, FloorGrid


def test_searches_are_drawn_side_by_side(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="pictures need matplotlib")
    occupancy = np.full((20, 40), FREE, np.uint8)
    occupancy[8:12, 15:25] = 0
    grid = FloorGrid(0, (0.0, 0.0), 0.25, occupancy, np.zeros(occupancy.shape, np.uint16))
    looks = np.array([[1.0, 1.0, 0.0], [5.0, 4.0, 1.0]])
    one = DrawnSearch("mug: found", looks, np.array([[5.5, 4.0]]), np.array([5.4, 4.1]))
    nothing = DrawnSearch("piano: absent", np.zeros((0, 3)), np.zeros((0, 2)))
    alone = draw_searches(tmp_path / "a" / "one.png", grid, [one])
    both = draw_searches(tmp_path / "two.png", grid, [one, nothing])
    wide, narrow = (cv2.imread(str(path)) for path in (both, alone))
    assert wide is not None
    assert narrow is not None
    assert wide.shape[1] == 2 * narrow.shape[1]
    assert len(np.unique(narrow.reshape(-1, 3), axis=0)) > 10
