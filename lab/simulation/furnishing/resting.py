"""What rests on what: the surfaces of wares, and where on them another ware has room."""

from __future__ import annotations

import numpy as np

from lab.simulation.furnishing.surfaces import Surface, boards, hollow, top_surface
from lab.simulation.furnishing.wares import Ware
from ovip.scene.types import F64

_GIVE = {
    "sofa": 0.06,
    "armchair": 0.06,
    "bed": 0.06,
    "chair": 0.06,
    "ottoman": 0.06,
    "stove": 0.05,
    "washbasin": 0.03,
}


class Surfaces:
    """The surfaces of models, read off them once."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, str], tuple[object, tuple[Surface, ...]]] = {}

    def of(self, ware: Ware, where: str) -> tuple[Surface, ...]:
        """where: "top", "boards" or "hollow"."""
        key = (id(ware.model), where)
        if key not in self._known:
            self._known[key] = (ware.model, self._read(ware, where))
        return self._known[key][1]

    def _read(self, ware: Ware, where: str) -> tuple[Surface, ...]:
        if where == "boards":
            return boards(ware.model)
        if where == "hollow":
            return (hollow(ware.model),)
        top = top_surface(ware.model, give_of(ware))
        return (top,) if top else ()


def give_of(ware: Ware) -> float:
    """How uneven its surface may be, metres."""
    return _GIVE.get(ware.label, 0.012)


def resting_spots(surface: Surface, ware: Ware, carrier: Ware, turn: float, where: str) -> tuple[F64, F64]:
    """Where on a surface there is room for a ware, and how high its foot is there; in the carrier's frame."""
    c, s = abs(np.cos(turn)), abs(np.sin(turn))
    width, depth = c * ware.width + s * ware.depth, s * ware.width + c * ware.depth
    if where != "hollow":
        return surface.spots(width, depth, ware.height, give_of(carrier) if where == "top" else 0.006)
    # what is round or soft goes deeper than its box; and not over the rim
    spots, feet = surface.spots(0.6 * width, 0.6 * depth, ware.height, 9.0)
    inside = feet < carrier.height - 0.01
    return spots[inside], feet[inside]
