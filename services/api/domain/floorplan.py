"""A storey drawn as a PNG: free space, walls, coloured regions with their names, objects."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ovip.errors import InvalidInput
from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN, FloorGrid
from ovip.scene.types import F64, U8, MapObject, Region
from services.api.domain.palette import region_colors, rgb

GREY_OF = {UNKNOWN: 205, FREE: 254, OCCUPIED: 0}
_PAPER, _FREE, _WALL, _INK = (238, 237, 233), (255, 255, 255), (139, 149, 163), (33, 41, 54)
_MARGIN_CELLS = 6
_MAX_SIDE = 6000
_TINT = 0.34


@dataclass(frozen=True, slots=True)
class PlanParams:
    """Scale in pixels a metre; the least extent in metres that gives an object its label."""

    pixels_per_metre: float = 80.0
    font_px: int = 13


def draw_floorplan(
    grid: FloorGrid,
    regions: Sequence[Region],
    objects: Sequence[MapObject],
    params: PlanParams = PlanParams(),
) -> bytes:
    """The grid's known part as PNG bytes, larger y up, with the objects that stand on this floor."""
    rows, columns = _known(grid)
    factor = params.pixels_per_metre * grid.resolution
    size = (round((columns.stop - columns.start) * factor), round((rows.stop - rows.start) * factor))
    if max(size) > _MAX_SIDE:
        raise InvalidInput(
            f"scale: the plan would be {size[0]} x {size[1]} pixels, expected at most {_MAX_SIDE} on a side"
        )
    colors = region_colors(regions)
    picture = Image.fromarray(_cells(grid, colors)[rows, columns][::-1]).resize(
        (max(size[0], 1), max(size[1], 1)), Image.Resampling.NEAREST
    )
    pen = _Pen(picture, _corner(grid, rows, columns), params)
    for obj in sorted(objects, key=lambda obj: float(obj.box[2])):
        pen.footprint(obj)
    taken: list[tuple[float, float, float, float]] = []
    for region in regions:
        pen.write(region.display_name, region.centroid[:2], params.font_px + 3, taken)
    for obj in sorted(objects, key=lambda obj: -obj.observations):
        pen.write(obj.label, obj.centroid[:2], params.font_px, taken)
    return _png(picture)


def occupancy_png(grid: FloorGrid) -> bytes:
    """Occupancy as 8-bit grey (unknown 205, free 254, occupied 0); first image row = grid row 0."""
    lookup = np.zeros(256, dtype=np.uint8)
    for cell, grey in GREY_OF.items():
        lookup[cell] = grey
    return _png(Image.fromarray(lookup[grid.occupancy]))


def regions_png(grid: FloorGrid) -> bytes:
    """Region labels as 16-bit grey (0 none, else 1 + index into region_ids); first image row = row 0."""
    return _png(Image.fromarray(grid.regions.astype(np.uint16)))


def _cells(grid: FloorGrid, colors: dict[str, str]) -> U8:
    """One colour a cell, `(R, C, 3)`."""
    image = np.empty((*grid.occupancy.shape, 3), dtype=np.float64)
    image[:] = _PAPER
    image[grid.occupancy == FREE] = _FREE
    tints = np.array(
        [_FREE, *(rgb(colors.get(region_id, "#ffffff")) for region_id in grid.region_ids)], dtype=np.float64
    )
    inside = (grid.regions > 0) & (grid.occupancy != OCCUPIED)
    image[inside] = (1 - _TINT) * np.array(_FREE) + _TINT * tints[grid.regions[inside]]
    image[grid.occupancy == OCCUPIED] = _WALL
    return np.round(image).astype(np.uint8)


def _known(grid: FloorGrid) -> tuple[slice, slice]:
    """The rows and columns that hold anything known, with a margin; all of them where nothing is."""
    known = grid.occupancy != UNKNOWN
    if not known.any():
        return slice(0, grid.occupancy.shape[0]), slice(0, grid.occupancy.shape[1])
    return _span(known.any(axis=1)), _span(known.any(axis=0))


def _span(known: np.ndarray) -> slice:
    places = np.flatnonzero(known)
    return slice(max(0, int(places[0]) - _MARGIN_CELLS), min(len(known), int(places[-1]) + 1 + _MARGIN_CELLS))


def _corner(grid: FloorGrid, rows: slice, columns: slice) -> F64:
    """World x, y of the upper left corner of the picture."""
    return np.array(
        [grid.origin[0] + columns.start * grid.resolution, grid.origin[1] + rows.stop * grid.resolution]
    )


class _Pen:
    """Draws in world metres on a picture whose upper left corner is at `corner`."""

    def __init__(self, picture: Image.Image, corner: F64, params: PlanParams) -> None:
        self._size = picture.size
        self._draw = ImageDraw.Draw(picture, "RGBA")
        self._corner = corner
        self._scale = params.pixels_per_metre

    def footprint(self, obj: MapObject) -> None:
        x0, y1 = self._pixel(obj.box[:2])
        x1, y0 = self._pixel(obj.box[3:5])
        ink = tuple(round(float(value)) for value in np.nan_to_num(obj.mean_color))
        self._draw.rectangle(
            (x0, y0, max(x1, x0 + 3), max(y1, y0 + 3)), fill=(*ink, 225), outline=(*_INK, 200)
        )

    def write(self, text: str, at: F64, size: int, taken: list[tuple[float, float, float, float]]) -> None:
        """Centred, unless it would cover what is already written."""
        font = ImageFont.load_default(size)
        x, y = self._pixel(at)
        left, top, right, bottom = self._draw.textbbox((x, y), text, font=font, anchor="mm")
        shift = min(0.0, self._size[0] - 2 - right) + max(0.0, 2 - left)
        place = (left + shift - 2, top - 1, right + shift + 2, bottom + 1)
        if any(_overlap(place, other) for other in taken):
            return
        taken.append(place)
        self._draw.text(
            (x + shift, y),
            text,
            font=font,
            anchor="mm",
            fill=_INK,
            stroke_width=2,
            stroke_fill=(255, 255, 255),
        )

    def _pixel(self, xy: F64) -> tuple[float, float]:
        return (
            float((xy[0] - self._corner[0]) * self._scale),
            float((self._corner[1] - xy[1]) * self._scale),
        )


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _png(picture: Image.Image) -> bytes:
    stream = io.BytesIO()
    picture.save(stream, format="PNG")
    return stream.getvalue()
