"""A tabletop in front of a wall, many times over: plain pictures whose every mistake can be counted."""

from __future__ import annotations

import numpy as np
import pytest

from lab.simulation.imperfect import SeenFrame, Thing
from ovip.scene.types import Intrinsics

WALL, TABLE, FIRST_CUP, CUPS = 1, 2, 10, 24
CAMERA = Intrinsics(fx=230.0, fy=230.0, cx=159.5, cy=119.5, width=320, height=240)


@pytest.fixture(scope="session")
def things() -> tuple[Thing, ...]:
    cups = (Thing(FIRST_CUP + i, "mug", ("red",) if i % 2 else ()) for i in range(CUPS))
    return (Thing(WALL, "wall", (), True), Thing(TABLE, "table"), *cups)


@pytest.fixture(scope="session")
def tabletop() -> list[SeenFrame]:
    """60 frames of one view: a table 240 x 140 pixels in front of a wall, on it 24 mugs of 14 x 14 pixels."""
    ids = np.full((240, 320), WALL, np.uint16)
    depth = np.full((240, 320), 3.0, np.float32)
    ids[60:200, 40:280] = TABLE
    depth[60:200, 40:280] = 2.0
    for i in range(CUPS):
        row, column = 70 + 32 * (i // 6), 50 + 38 * (i % 6)
        ids[row : row + 14, column : column + 14] = FIRST_CUP + i
    pose = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 1.4], [0, 0, 0, 1]])
    return [SeenFrame(i, i * 100_000_000, CAMERA, pose, None, depth, ids) for i in range(60)]
