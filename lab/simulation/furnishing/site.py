"""A functional area being furnished: the few verbs that all rules are told in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lab.simulation.furnishing.footprints import Footprint
from lab.simulation.furnishing.placing import Carrier, Placed, Stead
from lab.simulation.furnishing.resting import Surfaces, resting_spots
from lab.simulation.furnishing.sides import Side, sides_of
from lab.simulation.furnishing.surfaces import Surface
from lab.simulation.furnishing.wares import Ware, Wares
from lab.simulation.home import Area, RelationKind, inside_polygon
from ovip.scene.types import F64

GAP = 0.02  # between furniture and the wall behind it, metres
_TRIES = 40


@dataclass(frozen=True, slots=True)
class Spot:
    """A place against a wall: along the side, the thing's middle."""

    side: Side
    along: float


class Site:
    """One area of a storey, with what is needed to furnish it."""

    def __init__(
        self,
        area: Area,
        stead: Stead,
        wares: Wares,
        surfaces: Surfaces,
        rng: np.random.Generator,
        fullness: float = 1.0,
    ) -> None:
        self.area, self.stead, self.wares, self.rng = area, stead, wares, rng
        self.sides = sides_of(area, stead.plan)
        self.room = next(room for room in stead.plan.rooms if room.room_id == area.room_id)
        self.ceiling = stead.plan.storey.ceiling_z - stead.plan.storey.z
        self._surfaces, self._fullness = surfaces, fullness

    def pick(self, label: str, **wishes: object) -> Ware | None:
        """A ware of a label for this area; see `Wares.pick`."""
        return self.wares.pick(label, self.area.area_id, **wishes)  # type: ignore[arg-type]

    def chance(self, share: float) -> bool:
        """True that often, in a home as full as most."""
        return bool(self.rng.random() < share * self._fullness)

    def spots(self, ware: Ware, sides: Iterable[Side] | None = None) -> list[Spot]:
        """Places against walls for a ware: corners, middles, and others by chance; in no order."""
        found = []
        for side in self.sides if sides is None else sides:
            low, high = side.low + ware.width / 2 + 0.01, side.high - ware.width / 2 - 0.01
            if high < low:
                continue
            places = [low, high, (low + high) / 2, *self.rng.uniform(low, high, max(2, int(side.length * 3)))]
            found += [Spot(side, float(at)) for at in places]
        return [found[i] for i in self.rng.permutation(len(found))]

    def against(self, ware: Ware, spot: Spot, gap: float = GAP) -> Placed:
        """How the ware would stand there, its back to the wall."""
        x, y = spot.side.point(spot.along, gap + ware.depth / 2)
        return Placed(ware, x, y, 0.0, spot.side.yaw, RelationKind.ON, Carrier.FLOOR)

    def stand(
        self,
        ware: Ware | None,
        access: float = 0.6,
        sides: Iterable[Side] | None = None,
        prefer: Callable[[Spot], float] | None = None,
    ) -> Placed | None:
        """Stands a ware against the wall where `prefer` is least; None where it fits nowhere.

        access: depth of the floor before it that stays free, metres.
        """
        if ware is None:
            return None
        spots = self.spots(ware, sides)
        for spot in sorted(spots, key=prefer) if prefer else spots:
            if spot.side.meets_opening(
                spot.along - ware.width / 2, spot.along + ware.width / 2, 0.0, ware.height - 0.3
            ):
                continue
            if placed := self.settle(self.against(ware, spot), access):
                return placed
        return None

    def settle(self, thing: Placed, access: float = 0.0, within: F64 | None = None) -> Placed | None:
        """Puts a thing on the floor just there, if it meets nothing, and leaves ways free.

        within: the polygon that it has to be in, None = the area.
        """
        box = thing.footprint
        if not inside_polygon(self.area.polygon if within is None else within, _drawn_in(box)).all():
            return None
        if not self.stead.fits(box, Carrier.FLOOR):
            return None
        zones = [front_zone(thing, access)] if access else []
        if zones and not self.stead.free_of_things(replace(zones[0], bottom=0.05, top=0.8)):
            return None
        if not self.stead.keeps_ways(box, zones):
            return None
        return self.stead.add(thing, zones)

    def beside(
        self, other: Placed, ware: Ware | None, right: int, gap: float = 0.04, access: float = 0.0
    ) -> Placed | None:
        """Stands a ware beside another thing, right (+1) or left (-1) of it, their backs in one line."""
        if ware is None:
            return None
        own = np.array(
            [right * ((other.ware.width + ware.width) / 2 + gap), (other.ware.depth - ware.depth) / 2]
        )
        x, y = other.world(own)
        return self.settle(Placed(ware, x, y, 0.0, other.yaw, RelationKind.ON, Carrier.FLOOR), access)

    def before(
        self, other: Placed, ware: Ware | None, gap: float, turn: float = 0.0, shift: float = 0.0
    ) -> Placed | None:
        """Stands a ware in front of another thing; turn: radians to how that one looks."""
        if ware is None:
            return None
        reach = ware.depth if abs(np.sin(turn)) < 0.7 else ware.width
        x, y = other.world(np.array([shift, -(other.ware.depth + reach) / 2 - gap]))
        return self.settle(Placed(ware, x, y, 0.0, other.yaw + turn, RelationKind.ON, Carrier.FLOOR))

    def stand_in_access(self, thing: Placed) -> None:
        """What the floor before a thing is kept free for may come now: a low table, a chair, a mat."""
        self.stead.release(thing)

    def lay_rug(self, ware: Ware | None, before: Placed | None, gap: float) -> Placed | None:
        """Lays a flat cloth in front of a thing, or in the middle of the area, under what stands there."""
        if ware is None:
            return None
        x, y = (
            self.area.polygon.mean(axis=0)
            if before is None
            else before.world(np.array([0.0, -(before.ware.depth + ware.depth) / 2 - gap]))
        )
        yaw = 0.0 if before is None else before.yaw
        thing = Placed(ware, float(x), float(y), 0.0, yaw, RelationKind.ON, Carrier.FLOOR)
        inside = inside_polygon(self.area.polygon, thing.footprint.corners()).all()
        return self.stead.add(thing) if inside and self.stead.fits(thing.footprint, Carrier.FLOOR) else None

    def middle(
        self, ware: Ware | None, margin: float, yaws: Sequence[float] = (0.0, np.pi / 2)
    ) -> Placed | None:
        """Stands a ware free in the area, with `margin` metres around it, as near to the middle as it goes."""
        if ware is None:
            return None
        low, high = self.area.polygon.min(axis=0), self.area.polygon.max(axis=0)
        grid = np.stack(np.meshgrid(np.arange(low[0], high[0], 0.15), np.arange(low[1], high[1], 0.15)), -1)
        points = grid.reshape(-1, 2)[inside_polygon(self.area.polygon, grid.reshape(-1, 2))]
        order = np.argsort(np.linalg.norm(points - (low + high) / 2, axis=1), kind="stable")
        for x, y in points[order]:
            for yaw in yaws:
                thing = Placed(ware, float(x), float(y), 0.0, float(yaw), RelationKind.ON, Carrier.FLOOR)
                wide = replace(
                    thing.footprint, width=ware.width + 2 * margin, depth=ware.depth + 2 * margin, bottom=0.05
                )
                if self.stead.free_of_things(wide) and (placed := self.settle(thing)):
                    return placed
        return None

    def put(
        self,
        ware: Ware | None,
        on: Placed | None,
        near: tuple[float, float] | None = None,
        yaw: float | None = None,
        where: str = "top",
        within: float = 9.0,
    ) -> Placed | None:
        """Puts a ware on (or in) another thing; None where there is no place left.

        near: which part of the surface, -1..1 along the carrier's x and y, its front at y = -1; within: metres
        from there. yaw: to the carrier's, by default turned a little by chance. where: "top", "boards", "hollow".
        """
        if ware is None or on is None:
            return None
        turns = [float(self.rng.uniform(-0.35, 0.35)), 0.0] if yaw is None else [yaw]
        surfaces = list(self._surfaces.of(on.ware, where))
        if where == "boards":
            surfaces = [surfaces[i] for i in self.rng.permutation(len(surfaces))]
        for turn in turns:
            for surface in surfaces:
                if thing := self._put_at(ware, on, surface, near, turn, where, within):
                    return self.stead.add(thing)
        return None

    def _put_at(
        self,
        ware: Ware,
        on: Placed,
        surface: Surface,
        near: tuple[float, float] | None,
        turn: float,
        where: str,
        within: float,
    ) -> Placed | None:
        spots, feet = resting_spots(surface, ware, on.ware, turn, where)
        order = self.rng.permutation(len(spots))
        if near is not None:
            goal = np.array(near) * np.array([on.ware.width, on.ware.depth]) / 2
            away = np.linalg.norm(spots - goal, axis=1)
            order = np.argsort(away, kind="stable")
            order = order[away[order] <= within]
        kind = RelationKind.IN if where != "top" else RelationKind.ON
        for index in order[:_TRIES] if near is None else order[: 4 * _TRIES : 4]:
            x, y = on.world(spots[index])
            foot = on.z + float(feet[index])
            thing = Placed(ware, float(x), float(y), foot, on.yaw + turn, kind, on)
            if self.stead.fits(thing.footprint, on):
                return thing
        return None

    def hang(
        self,
        ware: Ware | None,
        bottom: float,
        spots: Sequence[Spot] | None = None,
        clear: float = 0.0,
    ) -> Placed | None:
        """Hangs a ware on a wall, its lower edge at `bottom`; clear: metres before it that must be free now."""
        if ware is None:
            return None
        for spot in self.spots(ware) if spots is None else spots:
            side, top = spot.side, bottom + ware.height
            low, high = spot.along - ware.width / 2, spot.along + ware.width / 2
            if top > side.height or low < side.low or high > side.high:
                continue
            if side.meets_opening(low - 0.01, high + 0.01, bottom, top):
                continue
            x, y = side.point(spot.along, ware.depth / 2)
            thing = Placed(ware, x, y, bottom, side.yaw, RelationKind.ATTACHED, Carrier.WALL, side.wall)
            ahead = front_zone(thing, clear) if clear else None
            if self.stead.fits(thing.footprint, Carrier.WALL) and (
                ahead is None or self.stead.free_of_things(ahead)
            ):
                return self.stead.add(thing)
        return None

    def above(self, other: Placed, ware: Ware | None, bottom: float, shift: float = 0.0) -> Placed | None:
        """Hangs a ware on the wall behind a thing that stands against it."""
        if ware is None:
            return None
        x, y = other.world(np.array([shift, 0.0]))
        sides = [s for s in self.sides if abs(np.cos(s.yaw - other.yaw) - 1) < 1e-6]
        spots = [
            Spot(side, float(x if side.axis == 0 else y))
            for side in sides
            if abs((y if side.axis == 0 else x) - side.face) < other.ware.depth / 2 + 0.15
        ]
        return self.hang(ware, bottom, spots)

    def hang_on(self, ware: Ware | None, rack: Placed, shift: float) -> Placed | None:
        """Hangs a cloth over the front of a rack, from its upper edge down."""
        if ware is None:
            return None
        x, y = rack.world(np.array([shift, -(rack.ware.depth + ware.depth) / 2]))
        z = rack.z + rack.ware.height - ware.height
        thing = Placed(ware, float(x), float(y), z, rack.yaw, RelationKind.ATTACHED, rack)
        return self.stead.add(thing) if self.stead.fits(thing.footprint, rack) else None

    def overhead(self, ware: Ware | None) -> Placed | None:
        """Fixes a ware to the ceiling, in the middle of the area or near it."""
        if ware is None:
            return None
        low, high = self.area.polygon.min(axis=0), self.area.polygon.max(axis=0)
        for spread in (0.0, 0.1, 0.2, 0.3, 0.3, 0.4):
            x, y = (low + high) / 2 + self.rng.uniform(-spread, spread, 2) * (high - low)
            thing = Placed(
                ware,
                float(x),
                float(y),
                self.ceiling - ware.height,
                0.0,
                RelationKind.ATTACHED,
                Carrier.CEILING,
            )
            inside = inside_polygon(self.area.polygon, thing.footprint.corners()).all()
            if inside and self.stead.fits(thing.footprint, Carrier.CEILING):
                return self.stead.add(thing)
        return None


def front_zone(thing: Placed, depth: float) -> Footprint:
    """The floor before a thing, as wide as it is."""
    x, y = thing.world(np.array([0.0, -(thing.ware.depth + depth) / 2]))
    return Footprint(
        float(x), float(y), thing.ware.width, depth, thing.yaw, thing.z, thing.z + thing.ware.height
    )


def _drawn_in(box: Footprint) -> F64:
    return replace(box, width=max(box.width - 0.02, 0.01), depth=max(box.depth - 0.02, 0.01)).corners()
