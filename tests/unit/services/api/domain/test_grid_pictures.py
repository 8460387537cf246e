"""Grids as pictures."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
from PIL import Image

from ovip.scene.types import U8
from services.api.domain.grid_pictures import occupancy_png, regions_png
from tests.unit.services.api.flat import grid


def pixels(png: bytes) -> U8:
    return np.asarray(Image.open(io.BytesIO(png)))


def test_occupancy_keeps_the_grids_rows_in_order() -> None:
    cells = grid()
    picture = pixels(occupancy_png(cells))
    assert picture.shape == cells.occupancy.shape
    assert picture[0, 0] == 205
    row, column = cells.cell_of(np.array([4.95, 1.6]))
    assert picture[row, column] == 254
    row, column = cells.cell_of(np.array([4.95, 3.0]))
    assert picture[row, column] == 0


def test_region_labels_are_sixteen_bit_and_exact() -> None:
    labels = np.zeros((4, 5), np.uint16)
    labels[1, 2] = 40_000
    picture = pixels(regions_png(replace(grid(), regions=labels)))
    assert picture[1, 2] == 40_000
