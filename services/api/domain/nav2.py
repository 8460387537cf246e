"""A floor as a map of ROS 2 nav2's map server: a PGM picture and the YAML that describes it, mode trinary."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.grid import FloorGrid
from services.api.domain.grid_pictures import occupancy_grey

_FREE_THRESH = 0.196
"""An unknown cell is grey 205, which reads as 1 - 205 / 255 = 0.19608 occupied: under nav2's default of 0.25 it would
be free."""
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The date of files in an archive, so that the same map is the same bytes."""


@dataclass(frozen=True, slots=True)
class Nav2Map:
    """Two files by name: the picture, and the YAML to give to the map server."""

    pgm_name: str
    pgm: bytes
    yaml_name: str
    yaml: str


def nav2_map(grid: FloorGrid) -> Nav2Map:
    """One floor. Rows run from the largest y down; origin is the outer corner of the lower left cell, metres."""
    pgm_name = f"floor-{grid.floor}.pgm"
    rows, columns = grid.occupancy.shape
    x, y = grid.origin
    yaml = (
        f"image: {pgm_name}\n"
        "mode: trinary\n"
        f"resolution: {_written(grid.resolution)}\n"
        f"origin: [{_written(x)}, {_written(y)}, 0.0]\n"
        "negate: 0\n"
        "occupied_thresh: 0.65\n"
        f"free_thresh: {_FREE_THRESH}\n"
    )
    pgm = f"P5\n{columns} {rows}\n255\n".encode() + occupancy_grey(grid)[::-1].tobytes()
    return Nav2Map(pgm_name, pgm, f"floor-{grid.floor}.yaml", yaml)


def nav2_zip(grids: Sequence[FloorGrid]) -> bytes:
    """All floors in one archive; the same grids give the same bytes."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for floor in map(nav2_map, grids):
            archive.writestr(zipfile.ZipInfo(floor.pgm_name, _EPOCH), floor.pgm, zipfile.ZIP_DEFLATED)
            archive.writestr(zipfile.ZipInfo(floor.yaml_name, _EPOCH), floor.yaml, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def _written(value: float) -> str:
    """All digits and no exponent: YAML readers differ on "1e-07"."""
    return str(np.format_float_positional(value, trim="0"))
