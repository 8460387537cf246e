"""Regions as search units: how small the place is in which a target must be sought, known or guessed (SPEC 7).

Oracle: the region that holds the target. Routing: regions chosen without the target's position, by where an
object of that label was detected, or by function.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F64, I64, Bools

OPEN_SHARE = 0.3
"""A target is in the open where the geometric baseline's (SysNav's) region about it is more than this share of
the floor."""

NOWHERE = -1


@dataclass(frozen=True, slots=True, eq=False)
class Units:
    """K regions on S storeys. floor: `(K,)` storey of each. area, viewpoints, objects: `(K,)` amounts in each.

    whole_area, whole_viewpoints, whole_objects: `(S,)` amounts of each whole storey.
    """

    floor: I64
    area: F64
    viewpoints: F64
    objects: F64
    whole_area: F64
    whole_viewpoints: F64
    whole_objects: F64


@dataclass(frozen=True, slots=True)
class UnitScore:
    """Means over targets. containment: share that lie in a region; area, viewpoints, objects, open_area: shares of
    that region's floor (None where there is no such target).

    Unless strict, targets in no region are left out of the shares.
    """

    containment: float
    area: float | None
    viewpoints: float | None
    objects: float | None
    open_area: float | None

    @property
    def columns(self) -> dict[str, float | None]:
        """As a result's row names them."""
        return {
            "containment": self.containment,
            "area": self.area,
            "viewpoints": self.viewpoints,
            "objects": self.objects,
            "open_area": self.open_area,
        }


@dataclass(frozen=True, slots=True)
class RoutingScore:
    """Means over queries: success, area of the routed regions, and viewpoints to sweep, shares of the home."""

    success: float
    area: float
    cost: float

    @property
    def columns(self) -> dict[str, float]:
        """As a result's row names them."""
        return {"routing_success": self.success, "routing_area": self.area, "routing_cost": self.cost}


def oracle_units(units: Units, holder: I64, in_the_open: Bools) -> UnitScore:
    """The region that holds each of T targets, as the paper counts it.

    holder: `(T,)` region of each target, -1 = in none. in_the_open: `(T,)`, see `open_targets`.
    """
    held = holder != NOWHERE
    area = shares(units.area, units.whole_area, units.floor)
    return UnitScore(
        containment=_mean(held.astype(np.float64)) or 0.0,
        area=_mean(area[holder[held]]),
        viewpoints=_mean(shares(units.viewpoints, units.whole_viewpoints, units.floor)[holder[held]]),
        objects=_mean(shares(units.objects, units.whole_objects, units.floor)[holder[held]]),
        open_area=_mean(area[holder[held & in_the_open]]),
    )


def strict_units(units: Units, holder: I64, in_the_open: Bools) -> UnitScore:
    """The same where a target in no region costs its whole floor."""
    area, viewpoints, objects = (
        np.append(shares(part, whole, units.floor), 1.0)[holder]
        for part, whole in (
            (units.area, units.whole_area),
            (units.viewpoints, units.whole_viewpoints),
            (units.objects, units.whole_objects),
        )
    )
    return UnitScore(
        containment=_mean((holder != NOWHERE).astype(np.float64)) or 0.0,
        area=_mean(area),
        viewpoints=_mean(viewpoints),
        objects=_mean(objects),
        open_area=_mean(area[in_the_open]),
    )


def open_targets(units: Units, holder: I64) -> Bools:
    """Targets that the geometric baseline puts in a region of more than 30% of its floor -> `(T,)`."""
    share = np.append(shares(units.area, units.whole_area, units.floor), 0.0)
    in_the_open: Bools = share[holder] > OPEN_SHARE
    return in_the_open


def routing(units: Units, holder: I64, routes: Sequence[tuple[int, ...]]) -> RoutingScore:
    """How T queries fare that are sent to regions `routes[t]`; to the whole home where that is none.

    A query succeeds where its target lies in a routed region; then the routed regions' viewpoints are swept, and
    all of the home's otherwise.
    """
    area, viewpoints = (
        units.area / _whole(units.whole_area),
        units.viewpoints / _whole(units.whole_viewpoints),
    )
    success = np.array(
        [region in route for region, route in zip(holder.tolist(), routes, strict=True)], np.bool_
    )
    swept = np.array([viewpoints[list(route)].sum() for route in routes])
    routed = np.array([area[list(route)].sum() if route else 1.0 for route in routes])
    return RoutingScore(
        success=_mean(success.astype(np.float64)) or 0.0,
        area=1.0 if (mean := _mean(routed)) is None else mean,
        cost=1.0 if (mean := _mean(np.where(success, swept, 1.0))) is None else mean,
    )


def shares(part: F64, whole: F64, floor: I64) -> F64:
    """What share of its floor each region has -> `(K,)`; 0 of nothing."""
    return np.asarray(part / np.maximum(whole[floor], 1e-9), np.float64)


def _whole(amounts: F64) -> float:
    return max(float(amounts.sum()), 1e-9)


def _mean(values: F64) -> float | None:
    return float(values.mean()) if len(values) else None
