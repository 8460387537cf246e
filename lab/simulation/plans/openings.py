"""Cuts doors and windows into walls, so that every room is reached and every room to the outside has light."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lab.simulation.plans.layout import OUTSIDE, Layout, Stair
from lab.simulation.plans.rectilinear import clipped
from lab.simulation.plans.walls import Opening, OpeningKind, Wall, leaf_box

DOOR_TOP = 2.0
_CORNER = 0.12  # wall left standing beside a door, metres
_PASSAGE = 0.9  # floor before a doorway that no leaf may reach into, metres
_DEAD_ENDS = ("bathroom", "storage", "laundry", "balcony")  # nobody walks through them
_COSTS = {
    frozenset(("kitchen", "dining area")): 0.8,
    frozenset(("living room", "dining area")): 0.8,
    frozenset(("living room", "kitchen")): 1.6,
    frozenset(("living room", "balcony")): 0.1,
    frozenset(("bedroom", "bathroom")): 3.0,
    frozenset(("kitchen", "laundry")): 2.5,
    frozenset(("kitchen", "storage")): 2.5,
}
_HUBS = ("hallway", "entryway")


@dataclass(frozen=True, slots=True)
class OpeningParams:
    """Metres and shares. widths: of doorways. leaf_chance: that a doorway has an open leaf. sill: under windows."""

    widths: tuple[float, float] = (0.8, 0.9)
    leaf_chance: float = 0.6
    second_door_chance: float = 0.5
    sill: float = 0.95


def with_openings(
    layout: Layout,
    walls: Sequence[Wall],
    functions: Mapping[int, tuple[str, ...]],
    rng: np.random.Generator,
    entrance: bool,
    params: OpeningParams | None = None,
) -> tuple[Wall, ...]:
    """The walls with doorways that join all rooms of a storey, windows, and where wanted an entrance.

    functions: of each room. ValueError where some room has no wall to put a door in.
    """
    chosen = params or OpeningParams()
    cut = dict(enumerate(walls))
    for index in _door_walls(layout, walls, functions, rng, chosen):
        cut[index] = _with_doorway(cut[index], layout, rng, chosen)
    if entrance:
        index = _entrance_wall(layout, walls, functions)
        cut[index] = _with_entrance(cut[index], layout, chosen)
    for index in cut:
        cut[index] = _with_leaves(index, cut, layout, functions, rng, chosen)
    return tuple(_with_windows(wall, functions, rng, chosen) for wall in cut.values())


def _door_walls(
    layout: Layout,
    walls: Sequence[Wall],
    functions: Mapping[int, tuple[str, ...]],
    rng: np.random.Generator,
    params: OpeningParams,
) -> list[int]:
    """A cheapest tree over the rooms, and some second doors between day rooms."""
    needed = params.widths[1] + 2 * _CORNER
    able = [
        (_cost(functions, wall) + 0.3 * float(rng.random()), index)
        for index, wall in enumerate(walls)
        if OUTSIDE not in wall.sides and any(high - low >= needed for low, high in free_runs(wall, layout))
    ]
    group = {room: room for room in functions}
    chosen = []
    for cost, index in sorted(able):
        a, b = (group[room] for room in walls[index].sides)
        second = cost < 1.2 and rng.random() < params.second_door_chance
        if a != b or second:
            chosen.append(index)
            group = {room: a if of == b else of for room, of in group.items()}
    if len(set(group.values())) > 1:
        raise ValueError("some room has no wall with place for a door")
    return chosen


def _cost(functions: Mapping[int, tuple[str, ...]], wall: Wall) -> float:
    a, b = (functions[room] for room in wall.sides)
    named = [_COSTS[pair] for x in a for y in b if (pair := frozenset((x, y))) in _COSTS]
    if any(hub in a or hub in b for hub in _HUBS):
        return 1.5 if "balcony" not in (*a, *b) else 4.0
    if len(a) > 1 or len(b) > 1:
        return 1.5
    if named:
        return min(named)
    return 9.0 if any(function in _DEAD_ENDS for function in (*a, *b)) else 5.0


def free_runs(wall: Wall, layout: Layout) -> list[tuple[float, float]]:
    """Stretches of a wall, low to high, that no flight of stairs and none of its openings take up."""
    taken = [(opening.low - _CORNER, opening.high + _CORNER) for opening in wall.openings]
    taken += [
        _along(wall, stair) for stair in (layout.rising, layout.arriving) if stair and _touches(wall, stair)
    ]
    runs = []
    start = wall.inner[0]
    for low, high in sorted(taken):
        if min(low, wall.inner[1]) > start:
            runs.append((start, min(low, wall.inner[1])))
        start = max(start, high)
    if wall.inner[1] > start:
        runs.append((start, wall.inner[1]))
    return runs


def _touches(wall: Wall, stair: Stair) -> bool:
    across = (stair.rect[1], stair.rect[3]) if wall.axis == 0 else (stair.rect[0], stair.rect[2])
    return across[0] - 0.3 <= wall.at <= across[1] + 0.3


def _along(wall: Wall, stair: Stair) -> tuple[float, float]:
    low, high = (stair.rect[0], stair.rect[2]) if wall.axis == 0 else (stair.rect[1], stair.rect[3])
    return low - 0.02, high + 0.02


def _with_doorway(
    wall: Wall,
    layout: Layout,
    rng: np.random.Generator,
    params: OpeningParams,
) -> Wall:
    width = round(float(rng.uniform(*params.widths)), 2)
    runs = [run for run in free_runs(wall, layout) if run[1] - run[0] >= width + 2 * _CORNER]
    low, high = runs[int(rng.integers(len(runs)))]
    spare = high - low - width - 2 * _CORNER
    # doors stand near corners, which leaves walls whole for furniture
    share = float(rng.choice([0.0, 1.0, 0.5], p=[0.45, 0.45, 0.1]))
    start = round(low + _CORNER + share * spare + (0.5 - share) * 2 * min(0.1, spare / 2), 3)
    door = Opening(OpeningKind.DOORWAY, start, round(start + width, 3), 0.0, DOOR_TOP, 0, share < 0.5)
    return replace(wall, openings=(*wall.openings, door))


def _with_leaves(
    index: int,
    walls: Mapping[int, Wall],
    layout: Layout,
    functions: Mapping[int, tuple[str, ...]],
    rng: np.random.Generator,
    params: OpeningParams,
) -> Wall:
    """Doorways with open leaves where those are in nobody's way."""
    wall = walls[index]
    if OUTSIDE in wall.sides:
        return wall
    hung = []
    for opening in wall.openings:
        leaf = replace(opening, leaf_side=_leaf_side(wall, functions))
        wanted = opening.kind is OpeningKind.DOORWAY and leaf.leaf_side and rng.random() < params.leaf_chance
        hung.append(leaf if wanted and _out_of_the_way(wall, leaf, walls, layout) else opening)
    return replace(wall, openings=tuple(hung))


def _out_of_the_way(wall: Wall, leaf: Opening, walls: Mapping[int, Wall], layout: Layout) -> bool:
    box = leaf_box(wall, leaf)
    taken = [stair.rect for stair in (layout.rising, layout.arriving) if stair]
    for other in walls.values():
        for opening in other.openings:
            own = other.axis == wall.axis and other.at == wall.at and opening.low == leaf.low
            if not own and opening.kind is not OpeningKind.WINDOW:
                reach = other.thickness / 2 + _PASSAGE
                taken.append(other.rect_between(opening.low, opening.high, reach))
            if opening.leaf_side:
                taken.append(leaf_box(other, opening))
    return all(clipped(box, rect) is None for rect in taken)


def _leaf_side(wall: Wall, functions: Mapping[int, tuple[str, ...]]) -> int:
    """Leaves open into rooms, not into the hall; a balcony's opening has none."""
    lower, higher = (functions[room] for room in wall.sides)
    if "balcony" in (*lower, *higher):
        return 0
    return 1 if any(hub in lower for hub in _HUBS) or len(lower) > len(higher) else -1


def _entrance_wall(layout: Layout, walls: Sequence[Wall], functions: Mapping[int, tuple[str, ...]]) -> int:
    """The outer wall that an entrance fits best: of a hall, else of a living room."""

    def rank(index: int) -> tuple[int, float, int]:
        wall = walls[index]
        own = functions[max(wall.sides)]
        of_hub = any(hub in own for hub in _HUBS)
        longest = max((high - low for low, high in free_runs(wall, layout)), default=0.0)
        return (
            0 if longest < 1.2 else 2 if of_hub else int("living room" in own),
            -longest if of_hub else 0.0,
            index,
        )

    outer = [
        i
        for i, wall in enumerate(walls)
        if OUTSIDE in wall.sides and "balcony" not in functions[max(wall.sides)]
    ]
    return max(outer, key=rank)


def _with_entrance(wall: Wall, layout: Layout, params: OpeningParams) -> Wall:
    width = params.widths[1]
    low, high = max(free_runs(wall, layout), key=lambda run: run[1] - run[0])
    start = round((low + high - width) / 2, 3)
    if high - low > 3.0:
        start = round(low + 0.3, 3)
    door = Opening(OpeningKind.ENTRANCE, start, round(start + width, 3), 0.0, DOOR_TOP)
    return replace(wall, openings=(*wall.openings, door))


def _with_windows(
    wall: Wall, functions: Mapping[int, tuple[str, ...]], rng: np.random.Generator, params: OpeningParams
) -> Wall:
    if OUTSIDE not in wall.sides or "balcony" in functions[max(wall.sides)]:
        return wall
    length = wall.inner[1] - wall.inner[0]
    if wall.openings or length < 1.3:
        return wall
    small = functions[max(wall.sides)][0] in ("bathroom", "laundry", "storage")
    width = 0.6 if small else round(min(float(rng.uniform(1.1, 1.7)), length - 0.7), 2)
    count = 2 if length > 5.5 else 1
    middles = wall.inner[0] + length * (np.arange(count) + 0.5) / count
    sill = 1.3 if small else params.sill
    top = min(2.1, wall.height - 0.25)
    panes = tuple(
        Opening(OpeningKind.WINDOW, round(float(m) - width / 2, 3), round(float(m) + width / 2, 3), sill, top)
        for m in middles
    )
    return replace(wall, openings=panes)
