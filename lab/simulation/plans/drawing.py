"""Draws the storeys of a home of some style: rooms in bands along a hall, or open onto one another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from lab.simulation.plans.layout import Cell, Layout, Stair, mirrored, shifted, transposed

_WIDTHS = {
    "kitchen": (2.7, 3.5),
    "dining area": (2.8, 3.5),
    "living room": (4.3, 5.3),
    "bedroom": (3.3, 4.3),
    "bathroom": (2.1, 2.6),
    "office": (2.6, 3.3),
    "laundry": (1.9, 2.4),
    "playroom": (2.7, 3.4),
    "gym": (2.7, 3.4),
    "storage": (1.7, 2.2),
}
"""Metres along the hall that a room of a function likes to have."""

_TIGHT = ("bathroom", "laundry", "storage")
_MOST_STRETCH, _LEAST_STRETCH = 1.22, 0.92
_STEP = 0.05  # lengths are multiples of this, metres
STAIR_WIDTH, STAIR_RUN, _LANDING = 1.0, 3.75, 1.4
_DOOR_ROOM = 1.3  # wall that a room needs along the hall for its door, metres
MOST_AREAS = 12

Functions = tuple[str, ...]
Placed = list[tuple[str, float, float]]  # function, low x, high x

_PRIVATE: tuple[Functions, ...] = (
    ("bedroom", "bathroom"),
    ("bedroom", "bathroom", "bedroom"),
    ("bedroom", "bathroom", "office"),
    ("bedroom", "bathroom", "laundry"),
    ("bedroom", "bathroom", "playroom"),
    ("bedroom", "bathroom", "office", "laundry"),
    ("bedroom", "bathroom", "bedroom", "storage"),
    ("bedroom", "bathroom", "gym"),
    ("bedroom", "storage", "bathroom", "office"),
)
_SERVICE: tuple[Functions, ...] = (
    ("office", "bathroom", "laundry"),
    ("bedroom", "bathroom", "storage"),
    ("office", "bathroom", "playroom"),
    ("gym", "bathroom", "office"),
    ("bedroom", "bathroom", "laundry"),
    ("office", "bathroom"),
    ("bedroom", "bathroom"),
)
_SERVICE_WITH_OPEN: tuple[Functions, ...] = (
    ("office", "bathroom"),
    ("bedroom", "bathroom"),
    ("playroom", "bathroom"),
    ("office", "laundry", "bathroom"),
)
_UPSTAIRS: tuple[Functions, ...] = (
    ("bedroom", "bedroom"),
    ("bedroom", "office", "bedroom"),
    ("bedroom", "playroom", "bathroom"),
)
_DAY: tuple[Functions, ...] = (
    ("living room", "kitchen"),
    ("living room", "dining area", "kitchen"),
    ("kitchen", "dining area", "living room"),
)


def draw_storeys(rng: np.random.Generator, style: str) -> tuple[Layout, ...]:
    """The storeys of a home, lowest first; turned and mirrored at random. KeyError for a style that is not."""
    storeys = DRAWERS[style](rng)
    while sum(len(storey.cells) for storey in storeys) > MOST_AREAS:
        storeys = DRAWERS[style](rng)
    turns: list[Callable[[Layout], Layout]] = [lambda s: mirrored(s, 0), lambda s: mirrored(s, 1), transposed]
    for turn in turns:
        if rng.random() < 0.5:
            storeys = tuple(turn(storey) for storey in storeys)
    cells = [cell.rect for storey in storeys for cell in storey.cells]
    low = (-min(rect[0] for rect in cells), -min(rect[1] for rect in cells))
    return tuple(shifted(storey, low) for storey in storeys)


def _walled_compact(rng: np.random.Generator) -> tuple[Layout, ...]:
    """Day rooms along one side of a hall, private rooms along the other."""
    south, hall, north = _between(rng, 3.7, 4.4), _between(rng, 1.3, 1.6), _between(rng, 3.3, 3.9)
    day = _band(rng, _pick(rng, _DAY), _between(rng, 8.0, 10.2))
    width = day[-1][2]
    # a corner of the house may be missing: an L
    length = width - (_between(rng, 1.6, 2.4) if width > 8.8 and rng.random() < 0.4 else 0.0)
    private = _fitting(rng, _PRIVATE, length)
    cells = [
        *_row(day, 0.0, south, 0),
        Cell((0.0, south, width, south + hall), len(day), "hallway"),
        *_row(private, south + hall, south + hall + north, len(day) + 1),
    ]
    return (Layout(tuple(_with_balcony(rng, cells, 0.35))),)


def _walled_elongated(rng: np.random.Generator) -> tuple[Layout, ...]:
    """A living room across one end, and a hall from it along a row of rooms."""
    depth, hall = _between(rng, 3.6, 4.2), _between(rng, 1.3, 1.5)
    end = _between(rng, 4.2, 5.2)
    tail: tuple[Functions, ...] = (("bathroom", "bedroom"), ("bathroom", "bedroom", "office"))
    more: tuple[Functions, ...] = (("bedroom", "bathroom", "bedroom"), ("bedroom", "bathroom", "office"))
    head: tuple[Functions, ...] = (("kitchen",), ("dining area", "kitchen"))
    functions = (*_pick(rng, head), *_pick(rng, tail + more))[:4]
    rooms = [(name, end + low, end + high) for name, low, high in _band(rng, functions)]
    cells = [
        Cell((0.0, 0.0, end, hall + depth), 0, "living room"),
        Cell((end, 0.0, rooms[-1][2], hall), 1, "hallway"),
        *_row(rooms, hall, hall + depth, 2),
    ]
    return (Layout(tuple(_with_balcony(rng, cells, 0.3))),)


def _open_compact(rng: np.random.Generator) -> tuple[Layout, ...]:
    """Kitchen, dining and living in one room; closed rooms along it, one of them perhaps an open corner too."""
    south, north = _between(rng, 4.3, 4.9), _between(rng, 3.3, 3.8)
    programs: tuple[Functions, ...] = (("kitchen", "living room"), *_DAY[1:])
    day = _band(rng, _pick(rng, programs))
    private = _fitting(rng, _PRIVATE, day[-1][2])
    cells = [*_row(day, 0.0, south, 0, walled=False), *_row(private, south, south + north, 1)]
    last, others = private[-1][0], [name for name, _, _ in private[:-1]]
    if last != "bathroom" and "bedroom" in others and rng.random() < 0.6:
        corner = "office" if "office" not in others else "entryway"
        cells[-1] = replace(cells[-1], room=0, function=corner)
    return (Layout(tuple(_with_balcony(rng, cells, 0.35))),)


def _open_elongated(rng: np.random.Generator) -> tuple[Layout, ...]:
    """Kitchen, dining and living in a row, then a hall along closed rooms."""
    depth, hall = _between(rng, 3.4, 3.9), _between(rng, 1.3, 1.5)
    day = _band(rng, _pick(rng, _DAY[1:]), _between(rng, 8.6, 9.6))
    end = day[-1][2]
    private: tuple[Functions, ...] = (*_PRIVATE[1:4], ("bathroom", "bedroom"))
    rooms = [(name, end + low, end + high) for name, low, high in _band(rng, _pick(rng, private))]
    cells = [
        *_row(day, 0.0, hall + depth, 0, walled=False),
        Cell((end, 0.0, rooms[-1][2], hall), 1, "hallway"),
        *_row(rooms, hall, hall + depth, 2),
    ]
    return (Layout(tuple(_with_balcony(rng, cells, 0.3))),)


def _two_floors_walled(rng: np.random.Generator) -> tuple[Layout, ...]:
    return _two_floors(rng, walled=True)


def _two_floors_open(rng: np.random.Generator) -> tuple[Layout, ...]:
    return _two_floors(rng, walled=False)


def _two_floors(rng: np.random.Generator, walled: bool) -> tuple[Layout, ...]:
    """A hall with a stair between two bands of rooms, twice; downstairs it may be one with the day rooms."""
    south, hall, north = _between(rng, 3.6, 4.1), _between(rng, 2.25, 2.4), _between(rng, 3.2, 3.6)
    day = _band(rng, _pick(rng, _DAY), _between(rng, 8.0, 9.4))
    width = day[-1][2]
    top = south + hall
    stair = Stair((_LANDING, top - STAIR_WIDTH, _LANDING + STAIR_RUN, top), (-1, 0))
    service = _beside_stair(rng, _SERVICE if walled else _SERVICE_WITH_OPEN, width, stair)
    private = _beside_stair(rng, _PRIVATE[:3], width, stair)
    upstairs = _fitting(rng, _UPSTAIRS, width)
    hall_room = len(day) if walled else 0
    ground = [
        *_row(day, 0.0, south, 0, walled=walled),
        Cell((0.0, south, width, top), hall_room, "hallway" if walled else "entryway"),
        *_row(service, top, top + north, hall_room + 1),
    ]
    upper = [
        *_row(upstairs, 0.0, south, 0),
        Cell((0.0, south, width, top), len(upstairs), "hallway"),
        *_row(private, top, top + north, len(upstairs) + 1),
    ]
    return Layout(tuple(ground), rising=stair), Layout(tuple(upper), arriving=stair)


DRAWERS: dict[str, Callable[[np.random.Generator], tuple[Layout, ...]]] = {
    "walled-compact": _walled_compact,
    "walled-elongated": _walled_elongated,
    "open-compact": _open_compact,
    "open-elongated": _open_elongated,
    "two-floors-walled": _two_floors_walled,
    "two-floors-open": _two_floors_open,
}


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)) / _STEP) * _STEP


def _pick(rng: np.random.Generator, choices: Sequence[Functions]) -> Functions:
    return choices[int(rng.integers(len(choices)))]


def _band(rng: np.random.Generator, functions: Functions, length: float | None = None) -> Placed:
    """Rooms side by side from x = 0, each as wide as its function likes; scaled to `length` where given."""
    widths = np.array([rng.uniform(*_WIDTHS[function]) for function in functions])
    if length is not None:
        stretch = float(np.clip(length / widths.sum(), _LEAST_STRETCH, _MOST_STRETCH))
        widths = widths * stretch
    ends = np.round(np.cumsum([0.0, *widths]) / _STEP) * _STEP
    return [(name, float(ends[i]), float(ends[i + 1])) for i, name in enumerate(functions)]


def _fitting(
    rng: np.random.Generator, programs: Sequence[Functions], length: float, slack: float = 0.25
) -> Placed:
    """The rooms of one of the programs that fit a length, in any order, filling it exactly.

    slack: how far (in log) the length may be from what a program likes; the best one always may.
    """
    liking = np.array([abs(np.log(length / sum(sum(_WIDTHS[f]) / 2 for f in p))) for p in programs])
    near = [programs[int(i)] for i in np.flatnonzero(liking <= max(slack, liking.min() + 1e-9))]
    functions = tuple(str(name) for name in rng.permutation(_pick(rng, near)))
    widths = np.array([rng.uniform(*_WIDTHS[function]) for function in functions])
    # rooms that need little give and take little
    ease = np.array([0.15 if function in _TIGHT else 1.0 for function in functions]) * widths
    widths = widths + (length - widths.sum()) * ease / ease.sum()
    ends = np.round(np.cumsum([0.0, *widths]) / _STEP) * _STEP
    ends[-1] = length
    return [(name, float(ends[i]), float(ends[i + 1])) for i, name in enumerate(functions)]


def _beside_stair(
    rng: np.random.Generator, programs: Sequence[Functions], length: float, stair: Stair
) -> Placed:
    """As `_fitting`, until the flight along the rooms' wall leaves each of them place for a door."""
    for attempt in range(200):
        rooms = _fitting(rng, programs, length, slack=0.25 + attempt / 100)
        if all(_door_room(low, high, stair) >= _DOOR_ROOM for _, low, high in rooms):
            return rooms
    raise ValueError(f"no row of rooms {length:.2f} m long leaves each a door beside the stair")


def _door_room(low: float, high: float, stair: Stair) -> float:
    """The longest stretch of low..high that the flight does not stand along."""
    return max(min(high, stair.rect[0]) - low, high - max(low, stair.rect[2]))


def _row(rooms: Placed, low: float, high: float, first_room: int, walled: bool = True) -> list[Cell]:
    return [
        Cell((x0, low, x1, high), first_room + (i if walled else 0), function)
        for i, (function, x0, x1) in enumerate(rooms)
    ]


def _with_balcony(rng: np.random.Generator, cells: list[Cell], chance: float) -> list[Cell]:
    """Some homes have a balcony before the living room."""
    living = next(cell for cell in cells if cell.function == "living room")
    if rng.random() >= chance:
        return cells
    x0, y0, x1, _ = living.rect
    depth = _between(rng, 1.5, 1.8)
    return [*cells, Cell((x0, y0 - depth, x1, y0), 1 + max(cell.room for cell in cells), "balcony")]
