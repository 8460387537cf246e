"""Tables and desks, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt
from lab.simulation.catalogue.shapes.seating import legs


def table(s: Sculpt, w: float, d: float, h: float) -> None:
    """A top on a frame and four legs."""
    s.box((0, 0, h - 0.02), (w, d, 0.04))
    legs(s, w - 0.06, d - 0.06, h - 0.03, 0.06, "wood")
    for y in (-1, 1):
        s.box((0, y * (d / 2 - 0.07), h - 0.08), (w - 0.16, 0.025, 0.08), "wood")


def any_table(s: Sculpt, w: float, d: float, h: float) -> None:
    """Round where it is as deep as wide."""
    (round_table if abs(w - d) < 0.02 else table)(s, w, d, h)


def round_table(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A round top on one foot."""
    s.cylinder((0, 0, h - 0.035), w / 2, 0.035, sides=36)
    s.turned(
        ((0, 0), (0.26 * w, 0), (0.24 * w, 0.025), (0.04, 0.07), (0.035, h - 0.03)),
        finish="wood",
        smooth=True,
    )


def coffee_table(s: Sculpt, w: float, d: float, h: float) -> None:
    """A low table with a shelf under its top."""
    s.box((0, 0, h - 0.02), (w, d, 0.04))
    s.box((0, 0, 0.3 * h), (w - 0.1, d - 0.1, 0.02), "wood")
    legs(s, w - 0.04, d - 0.04, h - 0.03, 0.05, "wood")


def desk(s: Sculpt, w: float, d: float, h: float) -> None:
    """A top, three drawers on the right, a cheek on the left, a panel behind."""
    s.box((0, 0, h - 0.015), (w, d, 0.03))
    s.box((-w / 2 + 0.02, 0, h / 2 - 0.015), (0.03, d - 0.04, h - 0.03))
    s.box((w / 2 - 0.22, 0, h / 2 - 0.015), (0.42, d - 0.06, h - 0.05))
    s.box((0, d / 2 - 0.04, 0.65 * h), (w - 0.06, 0.02, 0.5 * h))
    for i in range(3):
        z = 0.06 + (h - 0.1) * (i + 0.5) / 3
        s.box((w / 2 - 0.22, -d / 2 + 0.025, z), (0.39, 0.02, (h - 0.14) / 3), "wood")
        s.box((w / 2 - 0.22, -d / 2 + 0.01, z), (0.12, 0.015, 0.015), "steel")


RECIPES: dict[str, Recipe] = {
    "table": Recipe(any_table, "wood", ((1.2, 0.75, 0.74), (1.1, 1.1, 0.74), (0.7, 0.7, 0.72)), 1.0),
    "dining table": Recipe(table, "wood", ((1.6, 0.9, 0.75), (1.8, 0.95, 0.75), (1.4, 0.85, 0.74)), 1.0),
    "coffee table": Recipe(coffee_table, "wood", ((1.1, 0.6, 0.42), (0.9, 0.5, 0.45)), 1.0),
    "desk": Recipe(desk, "wood", ((1.4, 0.7, 0.74), (1.2, 0.6, 0.74)), 1.0),
}
