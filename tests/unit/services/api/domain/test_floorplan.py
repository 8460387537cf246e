"""Floor plans: what colour a place of the floor gets, and where it lies in the picture."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from ovip.errors import InvalidInput
from ovip.scene.types import U8
from services.api.domain.floorplan import PlanParams, draw_floorplan, occupancy_png, regions_png
from tests.unit.services.api.flat import flat, grid, thing

WALL = [139, 149, 163]


def pixels(png: bytes) -> U8:
    return np.asarray(Image.open(io.BytesIO(png)))


def at(picture: U8, x: float, y: float, scale: float = 40.0) -> list[int]:
    """Colour of world point x, y; the flat's known cells begin at (-0.1, -0.1), the margin is 6 cells."""
    column = round((x - (-0.1 - 0.3)) * scale)
    row = round(((6.1 + 0.3) - y) * scale)
    return [int(value) for value in picture[row, column]]


def test_larger_y_is_up_and_walls_free_space_and_regions_have_their_colours() -> None:
    plain = pixels(draw_floorplan(grid(), [], [], PlanParams(pixels_per_metre=40)))
    assert at(plain, 4.95, 3.0) == WALL
    assert at(plain, 4.95, 1.6) == [255, 255, 255]
    home = flat()
    tinted = pixels(draw_floorplan(grid(), home.regions, [], PlanParams(pixels_per_metre=40)))
    kitchen, bath = at(tinted, 5.3, 5.8), at(tinted, 5.3, 2.5)
    assert kitchen != bath
    assert kitchen[0] > kitchen[2]
    assert bath[2] > bath[0]


def test_an_object_is_drawn_in_its_own_colour_where_it_stands() -> None:
    vase = thing("o-1", "v", (0.5, 3.0, 0.0, 1.0, 3.5, 1.0), (200, 10, 10))
    picture = pixels(draw_floorplan(grid(), [], [vase], PlanParams(pixels_per_metre=40)))
    red = at(picture, 0.6, 3.1)
    assert red[0] > 180
    assert red[1] < 60


def test_a_floor_of_which_nothing_is_known_is_drawn_whole() -> None:
    blank = replace(grid(), occupancy=np.zeros((20, 30), np.uint8), regions=np.zeros((20, 30), np.uint16))
    assert pixels(draw_floorplan(blank, [], [], PlanParams(pixels_per_metre=20))).shape == (20, 30, 3)


def test_a_scale_that_makes_too_large_a_picture_is_refused() -> None:
    with pytest.raises(InvalidInput, match="expected at most 6000"):
        draw_floorplan(grid(), [], [], PlanParams(pixels_per_metre=2000))


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
