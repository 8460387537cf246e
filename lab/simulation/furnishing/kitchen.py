"""Kitchens and dining areas."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lab.simulation.furnishing.placing import Placed
from lab.simulation.furnishing.seating import chairs_around
from lab.simulation.furnishing.sides import Side
from lab.simulation.furnishing.site import Site, Spot
from lab.simulation.furnishing.wares import Ware

_UNIT = (1.05, 0.74, 1.25)  # the largest kitchen unit of a row, metres
_COUNTER = 0.88  # how high the units of a row are, metres
_CABINET, _SINK, _STOVE, _DISHES = "kitchen cabinet", "sink", "stove", "dishwasher"
_ROWS = (
    (_CABINET, _SINK, _CABINET, _STOVE, _CABINET, _DISHES),
    (_SINK, _DISHES, _CABINET, _STOVE, _CABINET),
    (_CABINET, _SINK, _CABINET, _STOVE),
    (_SINK, _CABINET, _STOVE),
    (_SINK, _STOVE),
)
"""Units side by side, tried in turn."""
_MORE = ((_CABINET, _CABINET, _CABINET), (_CABINET, _CABINET), (_CABINET,))
"""Units along another wall."""

_SMALL = (
    ("microwave", 0.8), ("toaster", 0.8), ("kettle", 0.8), ("coffee maker", 0.7), ("blender", 0.4),
    ("mixer", 0.3), ("knife block", 0.9), ("cutting board", 0.8), ("paper towel", 0.7), ("spice rack", 0.5),
    ("bottle", 1.0), ("bottle", 0.9), ("jar", 0.8), ("jar", 0.6), ("mug", 1.0), ("mug", 0.9), ("cup", 0.5),
    ("bowl", 0.8), ("plate", 0.8), ("fruit bowl", 0.6), ("bread", 0.5), ("salt shaker", 0.6), ("teapot", 0.5),
    ("tray", 0.3), ("radio", 0.25), ("glass", 0.7), ("glass", 0.5), ("knife", 0.5), ("plant", 0.3),
)  # fmt: skip


def furnish_kitchen(site: Site, eats_here: bool) -> None:
    """A row of units with sink and stove, a refrigerator, cupboards above; and what stands on it.

    eats_here: whether the home has no other place for a table.
    """
    units = _row(site, _ROWS)
    fridge = site.pick("refrigerator", most=(0.95, 0.95, 2.1), least=(0.4, 0.4, 1.1), colored=0.4)
    site.stand(fridge, 0.8, prefer=_near(units))
    if not any(unit.ware.label == "stove" and unit.ware.height > 0.5 for unit in units):
        site.stand(site.pick("oven", most=(0.7, 0.7, 1.2)), 0.7, prefer=_near(units))
    units += _row(site, _MORE)
    _cupboards(site, units)
    if site.chance(0.3):
        island = site.middle(site.pick("kitchen island", most=(1.3, 0.9, 1.0)), 0.9)
        units += [island] if island else []
    if eats_here:
        table = site.middle(site.pick("table", most=(1.3, 0.9, 0.85), least=(0.6, 0.5, 0.6)), 0.65)
        chairs_around(site, table, "chair", 4)
        site.put(site.pick("fruit bowl", most=(0.4, 0.4, 0.3)), table, near=(0, 0))
        site.put(site.pick("mug"), table, near=(0.6, -0.5))
    _on_counters(site, units)
    site.stand(site.pick("bin", most=(0.45, 0.45, 0.8)), 0.0)


def furnish_dining_area(site: Site) -> None:
    """A table with chairs around it, laid or with something in its middle; a sideboard."""
    table = _dining_table(site)
    chairs = chairs_around(site, table, "chair", 6)
    _lay(site, table, chairs)
    site.put(
        site.pick("vase" if site.chance(0.5) else "fruit bowl", most=(0.35, 0.35, 0.5)), table, near=(0, 0)
    )
    site.put(site.pick("candle", most=(0.15, 0.15, 0.4)), table, near=(0.3, 0.0))
    board = site.stand(site.pick("sideboard", most=(2.0, 0.55, 1.1), colored=0.4), 0.6)
    for label, count in (
        ("vase", 2),
        ("teapot", 1),
        ("bowl", 1),
        ("bottle", 2),
        ("wine glass", 3),
        ("candle", 1),
    ):
        for _ in range(int(site.rng.integers(0, count + 1))):
            site.put(site.pick(label, most=(0.4, 0.4, 0.5)), board)
    site.stand(site.pick("plant", most=(0.8, 0.8, 1.8), least=(0.2, 0.2, 0.6)), 0.0, prefer=corner_first)


def _dining_table(site: Site) -> Placed | None:
    """As large a one as leaves room for chairs."""
    for most, margin in (((2.0, 1.15, 0.85), 0.75), ((1.6, 1.0, 0.85), 0.7), ((1.3, 0.95, 0.85), 0.6)):
        for label in site.wares.has(("dining table", "table")):
            ware = site.pick(label, most=most, least=(0.75, 0.6, 0.6), colored=0.4)
            if table := site.middle(ware, margin):
                return table
    return None


def corner_first(spot: Spot) -> float:
    """How far from the nearest end of its wall a place is."""
    return min(spot.along - spot.side.low, spot.side.high - spot.along)


def _row(site: Site, rows: tuple[tuple[str, ...], ...]) -> list[Placed]:
    """The first of the rows that fits, along the longest stretch of wall that it fits."""
    for labels in rows:
        wares = [ware for label in labels if (ware := _unit(site, label))]
        for side in sorted(site.sides, key=lambda s: -s.length):
            for order in (wares, wares[::-1]):
                if row := _row_along(site, side, order):
                    return row
    return []


def _unit(site: Site, label: str) -> Ware | None:
    return site.pick(label, most=_UNIT, least=(0.25, 0.4, 0.6), colored=0.0)


def _row_along(site: Site, side: Side, wares: list[Ware]) -> list[Placed]:
    """All wares in a row from one end of a side, or from some way along it; nothing where they do not fit."""
    width = sum(ware.width for ware in wares)
    spare = side.length - width - 0.02
    if spare < 0:
        return []
    for start in (0.01, spare, spare / 2, spare / 4, spare * 3 / 4):
        at, row = side.low + start, list[Placed]()
        for ware in wares:
            spot = Spot(side, at + ware.width / 2)
            if _behind_is_wall(spot, ware) and (unit := site.settle(site.against(ware, spot), 0.75)):
                row.append(unit)
                at += ware.width + 0.001
            else:
                break
        if len(row) == len(wares):
            return row
        site.stead.take_back(row)
    return []


def _behind_is_wall(spot: Spot, ware: Ware) -> bool:
    """Taps may rise before a window, doors must stay free."""
    low, high = spot.along - ware.width / 2, spot.along + ware.width / 2
    return not spot.side.meets_opening(low, high, 0.0, min(ware.height, _COUNTER))


def _near(units: list[Placed]) -> Callable[[Spot], float]:
    """Close to the row."""

    def distance(spot: Spot) -> float:
        here = np.array(spot.side.point(spot.along, 0.3))
        return min((float(np.hypot(*(here - [u.x, u.y]))) for u in units), default=0.0)

    return distance


def _cupboards(site: Site, units: list[Placed]) -> None:
    """On the wall above the row, a hood above the stove."""
    for unit in units:
        if unit.ware.label == "stove":
            site.above(unit, site.pick("range hood", most=(0.95, 0.55, 0.7)), 1.65)
        elif unit.ware.label != "sink":
            cupboard = site.pick("cupboard", most=(unit.ware.width + 0.001, 0.42, 0.85), colored=0.0)
            site.above(unit, cupboard, 1.45)


def _on_counters(site: Site, units: list[Placed]) -> None:
    tops = [unit for unit in units if unit.ware.label in ("kitchen cabinet", "dishwasher", "kitchen island")]
    for unit in units:
        if unit.ware.label == "stove":
            site.put(site.pick("pot", most=(0.36, 0.36, 0.35)), unit, near=(0.45, 0.3), within=0.3)
            site.put(site.pick("pan", most=(0.36, 0.5, 0.3)), unit, near=(-0.45, -0.1), within=0.3)
        if unit.ware.label == "sink":
            for label in ("sponge", "soap dispenser"):
                ware = site.pick(label, most=(0.2, 0.2, 0.3))
                next((put for top in (unit, *tops) if (put := site.put(ware, top))), None)
    for label, share in _SMALL:
        if tops and site.chance(share):
            ware = site.pick(label, most=(0.5, 0.5, 0.5))
            for index in site.rng.permutation(len(tops))[:3]:
                bulky = ware is not None and ware.height > 0.2
                if placed := site.put(ware, tops[index], near=(0.0, 0.4) if bulky else None):
                    _fill(site, placed)
                    break


def _fill(site: Site, bowl: Placed) -> None:
    if bowl.ware.label == "bowl":
        site.put(site.pick("sponge", most=(0.11, 0.11, 0.08)), bowl, near=(0, 0), where="hollow", within=0.02)


def _lay(site: Site, table: Placed | None, chairs: list[Placed]) -> None:
    """Some seats are laid: plate, glass, fork and knife."""
    if table is None:
        return
    for chair in chairs:
        if not site.chance(0.6):
            continue
        c, s = np.cos(table.yaw), np.sin(table.yaw)
        offset = np.array([chair.x - table.x, chair.y - table.y])
        own = np.array([c * offset[0] + s * offset[1], -s * offset[0] + c * offset[1]])
        goal = own / np.array([table.ware.width, table.ware.depth]) * 2
        goal = goal / max(1.0, float(np.abs(goal).max())) * 0.68
        turn = chair.yaw - table.yaw + np.pi
        near = (float(goal[0]), float(goal[1]))
        site.put(site.pick("plate", most=(0.3, 0.3, 0.1)), table, near, turn, within=0.2)
        for label in ("glass", "fork", "knife"):
            site.put(site.pick(label, most=(0.3, 0.3, 0.3)), table, near, turn, within=0.35)
