"""The lights of a home: lamps under the ceiling of every area, and daylight from its windows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lab.simulation.home import Area, Home, HomeObject, Storey, inside_polygon
from ovip.scene.types import F64

LAMP_COLOR = (1.0, 0.90, 0.76)
DAYLIGHT_COLOR = (0.80, 0.91, 1.0)
AREA_PER_LAMP = 9.0  # square metres
_BELOW_CEILING = 0.30
_HEAD_ROOM = 1.6  # metres above the floor where the way up to the ceiling begins
_GRID = 0.2
_REACH_IN = 0.35  # metres that a window's light stands in from its pane


@dataclass(frozen=True, slots=True)
class Light:
    """A small light. position: metres. color: linear RGB. power: candela-like, in units of white paper at 1 m.

    normal: the way a window faces, None for a lamp. radius: metres, how soft its shadows are.
    """

    position: tuple[float, float, float]
    color: tuple[float, float, float]
    power: float
    radius: float
    normal: tuple[float, float, float] | None = None


def home_lights(home: Home, ceiling_above: Callable[[F64], F64]) -> tuple[Light, ...]:
    """Lamps of every area and daylight of every window.

    ceiling_above: what is the height of the first surface above `(N, 3)` points -> `(N,)`, infinity for none.
    """
    storeys = {storey.floor: storey for storey in home.storeys}
    lamps = [light for area in home.areas for light in _lamps(area, storeys[area.floor], ceiling_above)]
    windows = [thing for thing in home.objects if thing.label == "window"]
    return (*lamps, *(light for thing in windows if (light := _daylight(home, thing)) is not None))


def _lamps(area: Area, storey: Storey, ceiling_above: Callable[[F64], F64]) -> list[Light]:
    places = _spread(area)
    starts = np.column_stack([places, np.full(len(places), storey.z + _HEAD_ROOM)])
    top = np.minimum(ceiling_above(starts), storey.ceiling_z) - _BELOW_CEILING
    z = np.maximum(top, storey.z + _HEAD_ROOM)
    return [
        Light((float(x), float(y), float(h)), LAMP_COLOR, 1.5, 0.12)
        for (x, y), h in zip(places, z, strict=True)
    ]


def _spread(area: Area) -> F64:
    """Floor points `(N, 2)` of the area's lamps: its floor cut into equal pieces along its longer axis."""
    low, high = area.polygon.min(axis=0), area.polygon.max(axis=0)
    x, y = (np.arange(a + _GRID / 2, b, _GRID) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    points = points[inside_polygon(area.polygon, points)]
    if not len(points):
        return np.asarray(area.polygon.mean(axis=0, keepdims=True))
    count = max(1, round(len(points) * _GRID**2 / AREA_PER_LAMP))
    axis = int(np.argmax(high - low))
    pieces = np.array_split(points[np.argsort(points[:, axis], kind="stable")], count)
    return np.array([_innermost(piece) for piece in pieces if len(piece)])


def _innermost(points: F64) -> F64:
    """The point of a piece nearest to its middle, so that it lies inside whatever the piece's shape."""
    nearest: F64 = points[np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1))]
    return nearest


def _daylight(home: Home, window: HomeObject) -> Light | None:
    """The window's light, on the side where its home is; None where that is on neither side."""
    middle, size = (window.box[:3] + window.box[3:]) / 2, window.box[3:] - window.box[:3]
    across = np.zeros(3)
    across[int(np.argmin(size[:2]))] = 1.0
    for normal in (across, -across):
        if home.area_at(window.floor, (middle + (0.3 + _REACH_IN) * normal)[:2]) is not None:
            x, y, z = middle + _REACH_IN * normal
            power = 1.6 * float(np.sqrt(max(size[:2].max() * size[2], 0.05)))
            facing = (float(normal[0]), float(normal[1]), 0.0)
            return Light((float(x), float(y), float(z)), DAYLIGHT_COLOR, power, 0.3, facing)
    return None
