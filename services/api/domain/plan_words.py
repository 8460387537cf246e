"""The words of a floor plan: names and areas of regions, widths of doorways, where stairs lead, what is unexplored,
objects where there is room."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ovip.scene.grid import OCCUPIED
from ovip.scene.types import F64, Bools, EdgeKind, MapObject, Region
from services.api.domain.labels import Label, LabelSpace
from services.api.domain.lettering import Line, Rect, measure
from services.api.domain.plan_drawing import walls_of
from services.api.domain.plan_marks import passage_line, stairs_lines
from services.api.domain.plan_sheet import PlanFrame, PlanSheet

_SIZES = ((17, 14), (15, 13), (13, 12))
_SMALL, _MARK = 12, 11
_MOST_OBJECTS = 250


@dataclass(frozen=True, slots=True)
class PlanWords:
    """Labels of one plan, in pixels of its frame: of regions, of marks, of objects."""

    regions: tuple[Label, ...]
    marks: tuple[Label, ...]
    objects: tuple[Label, ...]


def words_of(sheet: PlanSheet, frame: PlanFrame) -> PlanWords:
    """Regions have the first choice, the largest before the others, then marks, then the most seen objects."""
    space = LabelSpace(
        frame.pictured(sheet.grid.regions.astype(np.int32)),
        frame.pictured(_busy(sheet)),
        frame.pictured(walls_of(sheet)),
        frame.cell,
        (0.0, 0.0),
    )
    marks = [(_bounds(points, frame), lines) for points, lines in _mark_words(sheet)]
    for box, _ in marks:
        space.reserve(box)
    numbers = {name: 1 + index for index, name in enumerate(sheet.grid.region_ids)}
    regions = sorted(
        (region for region in sheet.regions if region.region_id in numbers), key=lambda region: -region.area
    )
    named = [space.name(numbers[region.region_id], _variants(region)) for region in regions]
    marked = [space.beside(lines, _around(box, lines)) for box, lines in marks]
    seen_most = sorted(sheet.objects, key=lambda obj: (-obj.observations, obj.object_id))[:_MOST_OBJECTS]
    things = [_object(space, obj, frame) for obj in seen_most]
    return PlanWords(_there(named), _there(marked), _there(things))


def area_words(area: float) -> str:
    """ "4.2 m²", "23 m²"."""
    return f"{area:.1f} m²" if area < 9.95 else f"{area:.0f} m²"


def _there(labels: list[Label | None]) -> tuple[Label, ...]:
    return tuple(label for label in labels if label is not None)


def _variants(region: Region) -> list[tuple[Line, ...]]:
    """From the best to write to the smallest: name over area, the name in two lines, smaller, the name alone."""
    name, area = region.display_name, area_words(region.area)
    halves = _halved(name)
    variants: list[tuple[Line, ...]] = []
    for large, small in _SIZES:
        variants.append((Line(name, large), Line(area, small)))
        if halves:
            variants.append((*(Line(half, large) for half in halves), Line(area, small)))
    variants.append((Line(name, _SMALL),))
    return [*variants, (Line(f"{name}, {area}", _SMALL),)]


def _halved(name: str) -> tuple[str, ...]:
    """A name of several words in two lines, as even as can be; nothing for one word. "living room 2" breaks before
    "room"."""
    words = name.split()
    cuts = [(" ".join(words[:at]), " ".join(words[at:])) for at in range(1, len(words))]
    return min(cuts, key=lambda cut: max(map(len, cut))) if cuts else ()


def _mark_words(sheet: PlanSheet) -> Iterator[tuple[F64, tuple[Line, ...]]]:
    """What is said of each mark, with the points that the mark spans."""
    for edge in sheet.passages(EdgeKind.STAIRS):
        other = sheet.other_floor(edge)
        word = "up" if other > sheet.floor.floor else "down"
        yield stairs_lines(edge)[0], (Line(f"{word} to floor {other}", _SMALL),)
    for edge in sheet.passages(EdgeKind.DOORWAY):
        yield passage_line(sheet.grid, edge), (Line(f"{edge.width:.1f} m", _MARK),)
    for frontier in sheet.frontiers:
        half = 0.25 * np.array([[-1.0, -1.0], [1.0, 1.0]])
        yield frontier.position[:2] + half, (Line("unexplored", _SMALL),)


def _object(space: LabelSpace, obj: MapObject, frame: PlanFrame) -> Label | None:
    """In its footprint where it is large enough, else beside it."""
    lines = (Line(obj.label, _MARK),)
    corners = np.stack([obj.box[:2], obj.box[3:5]])
    box = _bounds(corners, frame, 0.0)
    width, height = measure(lines)
    if box[2] - box[0] > width and box[3] - box[1] > height:
        return space.beside(lines, [((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)])
    return space.beside(lines, _around(box, lines))


def _around(box: Rect, lines: tuple[Line, ...]) -> list[tuple[float, float]]:
    """Middles of words above, below, right and left of a box."""
    width, height = measure(lines)
    x, y = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
    above = height / 2 + 2.5
    return [
        (x, box[1] - above),
        (x, box[3] + above),
        (box[2] + width / 2 + 5, y),
        (box[0] - width / 2 - 5, y),
    ]


def _bounds(points: F64, frame: PlanFrame, pad: float = 4.0) -> Rect:
    """The box in pixels about world points."""
    x0, y1 = frame.pixel(points.min(axis=0))
    x1, y0 = frame.pixel(points.max(axis=0))
    return x0 - pad, y0 - pad, x1 + pad, y1 + pad


def _busy(sheet: PlanSheet) -> Bools:
    """Cells that furniture or objects cover."""
    grid = sheet.grid
    busy: Bools = (grid.occupancy == OCCUPIED) & (grid.regions > 0)
    for obj in sheet.objects:
        row, column = (max(0, at) for at in grid.cell_of(obj.box[:2]))
        last_row, last_column = (max(0, at) for at in grid.cell_of(obj.box[3:5]))
        busy[row : last_row + 1, column : last_column + 1] = True
    return busy
