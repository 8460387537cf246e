"""The lines and areas of a floor plan, without its words."""

from __future__ import annotations

import numpy as np
from PIL import Image
from scipy import ndimage

from ovip.scene.grid import FREE, OCCUPIED, UNKNOWN
from ovip.scene.types import F64, Bools, EdgeKind, MapObject, Region, RegionEdge
from services.api.domain.palette import (
    DOOR,
    FLOOR,
    FRONTIER,
    HAZE,
    INK,
    PAPER,
    STAIRS,
    TINT,
    WALL,
    mixed,
    region_colors,
    rgb,
)
from services.api.domain.plan_marks import frontier_lines, passage_line, stairs_lines
from services.api.domain.plan_pen import Pen
from services.api.domain.plan_sheet import PlanFrame, PlanSheet

_FURNITURE_ALPHA = 26
_OBJECT_ALPHA = 150
_TICK = 0.09
"""Half the length in metres of the jambs of a doorway's mark."""


def draw_floor(sheet: PlanSheet, frame: PlanFrame, finer: int) -> Image.Image:
    """The plan at `frame.size`, drawn `finer` times larger and shrunk."""
    pen = Pen(frame.size, frame.corner, frame.scale, finer, PAPER)
    grid, origin, resolution = sheet.grid, sheet.grid.origin, sheet.grid.resolution
    occupied = grid.occupancy == OCCUPIED
    pen.hatch(enclosed_unknown(sheet), origin, resolution, HAZE, 7.0)
    pen.cells(grid.occupancy == FREE, origin, resolution, FLOOR, 255)
    _regions(pen, sheet)
    pen.cells(occupied & (grid.regions > 0), origin, resolution, INK, _FURNITURE_ALPHA)
    for obj in sorted(sheet.objects, key=lambda obj: float(obj.box[2])):
        _footprint(pen, obj, 3.0 / frame.scale)
    pen.cells(walls_of(sheet), origin, resolution, WALL, 255)
    for edge in sheet.passages(EdgeKind.DOORWAY):
        _doorway(pen, passage_line(grid, edge))
    for line in frontiers_of(sheet):
        pen.dashes(line, FRONTIER, 2.8, 8.0, 6.0)
    for edge in sheet.passages(EdgeKind.STAIRS):
        _stairs(pen, edge, sheet)
    return pen.picture()


def walls_of(sheet: PlanSheet) -> Bools:
    """Cells of walls: what is occupied and no region's floor. Furniture stands on a region's floor."""
    walls: Bools = (sheet.grid.occupancy == OCCUPIED) & (sheet.grid.regions == 0)
    return walls


def enclosed_unknown(sheet: PlanSheet) -> Bools:
    """Cells that were never seen, within the floor: paths over such cells do not lead out of the grid."""
    unknown = np.pad((sheet.grid.occupancy == UNKNOWN) & (sheet.grid.regions == 0), 1, constant_values=True)
    pieces, _ = ndimage.label(unknown)
    enclosed: Bools = (unknown & (pieces != pieces[0, 0]))[1:-1, 1:-1]
    return enclosed


def frontiers_of(sheet: PlanSheet) -> tuple[F64, ...]:
    """The lines of all frontiers of the floor."""
    outlines = {region.region_id: (*region.outlines, *region.holes) for region in sheet.regions}
    return tuple(
        line
        for frontier in sheet.frontiers
        for line in frontier_lines(sheet.grid, frontier, outlines.get(frontier.region_id, ()))
    )


def floor_color(color: str) -> tuple[int, int, int]:
    """The colour that the floor of a region of `color` is drawn in."""
    return mixed(FLOOR, rgb(color), TINT)


def _regions(pen: Pen, sheet: PlanSheet) -> None:
    """From the one with the largest rim inward, so that a region in another's hole is not drawn over."""
    colors = region_colors(sheet.partition.regions)
    rings = [(ring, region) for region in sheet.regions for ring in region.outlines]
    for ring, region in sorted(rings, key=lambda pair: -_area(pair[0])):
        fill = floor_color(colors[region.region_id])
        pen.area(ring, fill)
        pen.line(_closed(ring), mixed(fill, rgb(colors[region.region_id]), 0.55), 1.0)
        for hole in _inside(region, ring):
            pen.area(hole, PAPER)


def _inside(region: Region, ring: F64) -> list[F64]:
    """The region's holes within one of its outlines: those whose bounds lie within the outline's."""
    low, high = ring.min(axis=0), ring.max(axis=0)
    return [
        hole for hole in region.holes if (hole.min(axis=0) >= low).all() and (hole.max(axis=0) <= high).all()
    ]


def _footprint(pen: Pen, obj: MapObject, least: float) -> None:
    low = obj.box[:2]
    high = np.maximum(obj.box[3:5], low + least)
    ring = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    red, green, blue = (min(255, max(0, round(float(value)))) for value in np.nan_to_num(obj.mean_color))
    pen.patch(ring, (red, green, blue), _OBJECT_ALPHA, mixed(INK, PAPER, 0.3))


def _doorway(pen: Pen, line: F64) -> None:
    """A line across the gap with a jamb at each end."""
    along = line[1] - line[0]
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
    pen.line(line, FLOOR, 4.0)
    pen.line(line, DOOR, 1.6)
    for end in line:
        pen.line(np.stack([end - _TICK * across, end + _TICK * across]), DOOR, 2.4)


def _stairs(pen: Pen, stairs: RegionEdge, sheet: PlanSheet) -> None:
    """Treads between the rails, and an arrow that points up on the lower floor and down on the upper."""
    rim, treads, up = stairs_lines(stairs)
    pen.area(rim, mixed(PAPER, STAIRS, 0.12))
    for tread in treads:
        pen.line(tread, mixed(STAIRS, PAPER, 0.35), 1.2)
    pen.line(_closed(rim), STAIRS, 1.6)
    pen.arrow(up if sheet.other_floor(stairs) > sheet.floor.floor else up[::-1], STAIRS, 2.0)


def _closed(ring: F64) -> F64:
    return np.concatenate([ring, ring[:1]])


def _area(ring: F64) -> float:
    following = np.roll(ring, -1, axis=0)
    return abs(float((ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum())) / 2
