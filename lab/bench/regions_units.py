"""One unit of the bench's floor as surfaces: a corridor along y = 0 and, behind a wall with doors, rooms or a hall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64

UNIT = (10.0, 5.0)
"""Metres along x and y, a whole number of the evidence's cells."""

KINDS: tuple[tuple[str, ...], ...] = (
    ("bedroom", "bathroom"),
    ("office", "office"),
    ("kitchen", "dining area", "living room"),
)
"""Functions of the parts of each kind of unit, from left to right; the last kind has no walls between its parts."""

THINGS: dict[str, tuple[str, ...]] = {
    "bedroom": ("bed", "nightstand", "wardrobe", "dresser", "pillow", "lamp", "blanket", "curtain"),
    "bathroom": ("toilet", "bathtub", "shower", "towel", "mirror", "shampoo", "soap", "toothbrush"),
    "office": ("desk", "monitor", "keyboard", "office chair", "bookshelf", "printer", "book", "lamp"),
    "kitchen": ("stove", "fridge", "sink", "microwave", "pan", "kettle", "oven", "plate"),
    "dining area": ("dining table", "dining chair", "chair", "bowl", "glass", "vase", "plate", "tablecloth"),
    "living room": ("sofa", "tv stand", "coffee table", "armchair", "cushion", "rug", "remote", "plant"),
}
"""Words of the things that stand in a part of each function."""

Span = tuple[float, float]

_EDGE = 0.025  # metres: half a cell, so that a surface lies in the middle of one
_CORRIDOR, _THICK, _HEIGHT = 1.525, 0.15, 2.5  # metres
_DOOR, _HEAD = 0.9, 2.0  # metres wide and high
_THROUGH = (4.55, 5.45)  # x of the way from a hall to the next corridor
_STEP = 0.04  # metres between points of a surface


@dataclass(frozen=True, slots=True, eq=False)
class UnitSurfaces:
    """stands: x0, y0, x1, y1 of the corridor and of each room, one array `(4,)` each; shares: of the unit's walk.

    surfaces: what is seen from each of these, `(N, 3)` metres. parts: `(4,)` each, as stands, one a function.
    """

    stands: tuple[F64, ...]
    shares: F64
    surfaces: tuple[F32, ...]
    parts: tuple[F64, ...]


def unit_surfaces(kind: int, rng: np.random.Generator) -> UnitSurfaces:
    """A unit of a kind, its furniture placed by `rng`."""
    is_hall = kind == len(KINDS) - 1
    parts = _parts(len(KINDS[kind]), is_hall)
    rooms = [np.concatenate([parts[0][:2], parts[-1][2:]])] if is_hall else parts
    doors = [((room[0] + room[2] - _DOOR) / 2, (room[0] + room[2] + _DOOR) / 2) for room in rooms]
    corridor = np.array([0.0, _EDGE, UNIT[0], _CORRIDOR])
    surfaces = [_corridor(corridor, [*doors])]
    for room, door in zip(rooms, doors, strict=True):
        furniture = [_box(part, rng) for part in parts if room[0] <= part[0] < room[2] for _ in range(6)]
        surfaces.append(np.concatenate([_room(room, door, is_hall), *furniture]))
    stands = (corridor, *rooms)
    areas = np.array([(stand[2] - stand[0]) * (stand[3] - stand[1]) for stand in stands])
    return UnitSurfaces(stands, areas / areas.sum(), tuple(surfaces), tuple(parts))


def _parts(count: int, is_hall: bool) -> list[F64]:
    """Equal shares of what lies behind the corridor's wall; a wall between them where it is no hall."""
    low, high, gap = _EDGE, UNIT[0] - _EDGE, 0.0 if is_hall else _THICK
    width = round((high - low - (count - 1) * gap) / count, 3)
    bottom, top = _CORRIDOR + _THICK, UNIT[1] - _EDGE
    starts = [low + number * (width + gap) for number in range(count)]
    return [np.array([start, bottom, start + width, top]) for start in starts]


def _corridor(corridor: F64, doors: list[Span]) -> F32:
    """Floor, ceiling, and the walls on both sides; its ends are open, and so is the way down to a hall."""
    x0, y0, x1, y1 = corridor
    return np.concatenate(
        [
            *(_sheet((x0, x1), (y0, y1), (z, z)) for z in (0.0, _HEIGHT)),
            _holed(_sheet((x0, x1), (y1, y1), (0.0, _HEIGHT)), doors),
            _holed(_sheet((x0, x1), (y0, y0), (0.0, _HEIGHT)), [_THROUGH]),
            *(_sheet(door, (y1, y1 + _THICK), (0.0, 0.0)) for door in doors),
            _sheet(_THROUGH, (y0 - 2 * _EDGE, y0), (0.0, 0.0)),
        ]
    )


def _room(room: F64, door: Span, is_hall: bool) -> F32:
    """Floor, ceiling and four walls with the door to the corridor and, from a hall, the one behind."""
    x0, y0, x1, y1 = room
    return np.concatenate(
        [
            *(_sheet((x0, x1), (y0, y1), (z, z)) for z in (0.0, _HEIGHT)),
            _holed(_sheet((x0, x1), (y0, y0), (0.0, _HEIGHT)), [door]),
            _holed(_sheet((x0, x1), (y1, y1), (0.0, _HEIGHT)), [_THROUGH] if is_hall else []),
            *(_sheet((x, x), (y0, y1), (0.0, _HEIGHT)) for x in (x0, x1)),
        ]
    )


def _box(part: F64, rng: np.random.Generator) -> F32:
    """Sides and top of a piece of furniture somewhere in a part."""
    size = rng.uniform((0.4, 0.4, 0.4), (1.2, 0.7, 1.2))
    x, y = rng.uniform(part[:2] + 0.1, part[2:] - 0.1 - size[:2])
    across, along, up = (x, x + size[0]), (y, y + size[1]), (0.0, float(size[2]))
    return np.concatenate(
        [
            _sheet(across, along, (up[1], up[1])),
            *(_sheet((end, end), along, up) for end in across),
            *(_sheet(across, (end, end), up) for end in along),
        ]
    )


def _sheet(x: Span, y: Span, z: Span) -> F32:
    """Points of a rectangle along the axes -> `(N, 3)`; one of the three spans has no length."""
    axes = [
        np.arange(low + _STEP / 2, high, _STEP) if high > low else np.array([low]) for low, high in (x, y, z)
    ]
    grid = np.meshgrid(*axes, indexing="ij")
    return np.stack([axis.ravel() for axis in grid], axis=1).astype(np.float32)


def _holed(wall: F32, doors: list[Span]) -> F32:
    """A wall along x without its doors."""
    for left, right in doors:
        wall = wall[~((wall[:, 0] > left) & (wall[:, 0] < right) & (wall[:, 2] < _HEAD))]
    return wall
