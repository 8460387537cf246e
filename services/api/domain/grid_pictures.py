"""The grids of a floor as grey pictures, one pixel a cell, row 0 (the smallest y) first."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import U8

GREY_OF = {UNKNOWN: 205, FREE: 254, OCCUPIED: 0}


def occupancy_png(grid: FloorGrid) -> bytes:
    """Occupancy as 8-bit grey (unknown 205, free 254, occupied 0)."""
    return _png(Image.fromarray(occupancy_grey(grid)))


def regions_png(grid: FloorGrid) -> bytes:
    """Region labels as 16-bit grey (0 none, else 1 + index into region_ids)."""
    return _png(Image.fromarray(grid.regions.astype(np.uint16)))


def occupancy_grey(grid: FloorGrid) -> U8:
    """Grey values of the cells, `(R, C)`."""
    lookup = np.zeros(256, dtype=np.uint8)
    for cell, grey in GREY_OF.items():
        lookup[cell] = grey
    grey_cells: U8 = lookup[grid.occupancy]
    return grey_cells


def _png(picture: Image.Image) -> bytes:
    stream = io.BytesIO()
    picture.save(stream, format="PNG")
    return stream.getvalue()
