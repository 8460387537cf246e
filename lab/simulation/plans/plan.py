"""The floor plan of a home: its storeys with their rooms, functional areas, walls, openings and stairs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Area, Storey
from lab.simulation.plans.drawing import draw_storeys
from lab.simulation.plans.layout import Cell, Layout, Stair
from lab.simulation.plans.openings import with_openings
from lab.simulation.plans.rectilinear import Rect, clipped, region
from lab.simulation.plans.walls import Wall, walls_of

_RAIL = 0.06  # thickness of the parapet around a stair's hole, metres


@dataclass(frozen=True, slots=True)
class PlanParams:
    """Ranges in metres. storey_height: from one floor's surface to the next."""

    wall_thickness: tuple[float, float] = (0.10, 0.15)
    ceiling: tuple[float, float] = (2.5, 2.7)
    storey_height: tuple[float, float] = (2.8, 3.0)
    parapet: float = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class FloorPlan:
    """One storey. rooms, areas: see `Home`. cells_of: the cells (to the wall centre lines) of each room id.

    flight: the stair that starts here; hole: what one that arrives leaves open in the floor; rails: parapets
    around the hole, footprints.
    """

    storey: Storey
    layout: Layout
    walls: tuple[Wall, ...]
    rooms: tuple[Area, ...]
    areas: tuple[Area, ...]
    cells_of: dict[int, tuple[Rect, ...]]
    flight: Stair | None
    hole: Rect | None
    rails: tuple[Rect, ...]
    parapet: float

    def room_at_side(self, side: int) -> Area | None:
        """The room that a wall's side names; None for the outside."""
        return self.rooms[side] if side >= 0 else None


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """All storeys of a home, lowest first."""

    style: str
    floors: tuple[FloorPlan, ...]

    @property
    def rooms(self) -> tuple[Area, ...]:
        """Walled rooms of all storeys."""
        return tuple(room for floor in self.floors for room in floor.rooms)

    @property
    def areas(self) -> tuple[Area, ...]:
        """Functional areas of all storeys."""
        return tuple(area for floor in self.floors for area in floor.areas)


def make_plan(rng: np.random.Generator, style: str, params: PlanParams | None = None) -> Plan:
    """A floor plan of a style. KeyError for a style that is not."""
    chosen = params or PlanParams()
    layouts = draw_storeys(rng, style)
    thickness = round(float(rng.uniform(*chosen.wall_thickness)) / 2, 2) * 2
    ceiling = round(float(rng.uniform(*chosen.ceiling)), 2)
    rise = round(float(rng.uniform(*chosen.storey_height)), 2)
    names = _Names()
    count = sum(len(_functions(layout)) for layout in layouts)
    floors: list[FloorPlan] = []
    for floor, layout in enumerate(layouts):
        storey = Storey(floor, round(floor * rise, 3), round(floor * rise + ceiling, 3))
        walls = _walls(layout, thickness, ceiling, chosen.parapet, rng, entrance=floor == 0)
        first = (1 + len(names.given), 1 + count + sum(len(f.rooms) for f in floors))
        floors.append(_floor_plan(storey, layout, walls, names, first, chosen.parapet))
    return Plan(style, tuple(floors))


class _Names:
    """Gives areas of one function distinct names."""

    def __init__(self) -> None:
        self.given: list[str] = []
        self._count: Counter[str] = Counter()

    def new(self, function: str) -> str:
        self._count[function] += 1
        name = function if self._count[function] == 1 else f"{function} {self._count[function]}"
        self.given.append(name)
        return name


def _functions(layout: Layout) -> dict[tuple[int, str], list[Cell]]:
    """The cells of each functional area, in the order of the layout."""
    found: dict[tuple[int, str], list[Cell]] = {}
    for cell in layout.cells:
        found.setdefault((cell.room, cell.function), []).append(cell)
    return found


def _walls(
    layout: Layout, thickness: float, ceiling: float, parapet: float, rng: np.random.Generator, entrance: bool
) -> tuple[Wall, ...]:
    functions: dict[int, tuple[str, ...]] = {}
    for room, function in _functions(layout):
        functions[room] = (*functions.get(room, ()), function)
    return with_openings(layout, walls_of(layout, thickness, ceiling, parapet), functions, rng, entrance)


def _floor_plan(
    storey: Storey,
    layout: Layout,
    walls: tuple[Wall, ...],
    names: _Names,
    first: tuple[int, int],
    parapet: float,
) -> FloorPlan:
    """first: the first area's id, and the first room's."""
    solid = [wall.rect for wall in walls]
    hole = _inner(layout.arriving, solid)
    rails = _rails(layout.arriving, hole)
    open_floor = [*solid, *([hole] if hole else [])]
    areas, room_cells = [], dict[int, list[Rect]]()
    for offset, ((room, function), cells) in enumerate(_functions(layout).items()):
        rects = [cell.rect for cell in cells]
        room_cells.setdefault(room, []).extend(rects)
        ring = region(rects, open_floor).ring()
        areas.append(
            Area(first[0] + offset, storey.floor, function, names.new(function), ring, first[1] + room)
        )
    rooms = tuple(
        _room(
            first[1] + room,
            storey.floor,
            [a for a in areas if a.room_id == first[1] + room],
            cells,
            open_floor,
        )
        for room, cells in sorted(room_cells.items())
    )
    cells_of = {first[1] + room: tuple(cells) for room, cells in room_cells.items()}
    rising = _inner(layout.rising, solid)
    flight = Stair(rising, layout.rising.up) if rising and layout.rising else None
    return FloorPlan(storey, layout, walls, rooms, tuple(areas), cells_of, flight, hole, rails, parapet)


def _room(room_id: int, floor: int, areas: Sequence[Area], cells: list[Rect], less: list[Rect]) -> Area:
    """A room takes the function of its first living room, else of its first area."""
    main = next((a for a in areas if a.function == "living room"), areas[0])
    name = main.name if len(areas) == 1 else " and ".join(area.name for area in areas)
    return Area(room_id, floor, main.function, name, region(cells, less).ring(), room_id)


def _inner(stair: Stair | None, solid: Sequence[Rect]) -> Rect | None:
    """A flight's footprint up to the faces of the walls beside it."""
    if stair is None:
        return None
    left = region([stair.rect], [wall for wall in solid if clipped(wall, stair.rect)])
    ring = left.ring()
    return (*map(float, ring.min(axis=0)), *map(float, ring.max(axis=0)))  # type: ignore[return-value]


def _rails(stair: Stair | None, hole: Rect | None) -> tuple[Rect, ...]:
    """Parapets along the hole's open side and behind the flight's foot."""
    if stair is None or hole is None:
        return ()
    x0, y0, x1, y1 = hole
    dx, dy = stair.up
    if dx:
        open_low = abs(y0 - stair.rect[1]) < 1e-6  # the side not cut by a wall
        side = (x0, y0 - _RAIL, x1, y0) if open_low else (x0, y1, x1, y1 + _RAIL)
        back = (x0 - _RAIL, y0, x0, y1) if dx > 0 else (x1, y0, x1 + _RAIL, y1)
    else:
        open_low = abs(x0 - stair.rect[0]) < 1e-6
        side = (x0 - _RAIL, y0, x0, y1) if open_low else (x1, y0, x1 + _RAIL, y1)
        back = (x0, y0 - _RAIL, x1, y0) if dy > 0 else (x0, y1, x1, y1 + _RAIL)
    return side, back
