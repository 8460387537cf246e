"""What people sit on, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import MAIN, Sculpt


def legs(s: Sculpt, w: float, d: float, h: float, thick: float, finish: str) -> None:
    """Four square legs at the corners, from the floor to `h`."""
    for x in (-1, 1):
        for y in (-1, 1):
            at = (x * (w / 2 - thick / 2), y * (d / 2 - thick / 2), h / 2)
            s.box(at, (thick, thick, h), finish)


def chair(s: Sculpt, w: float, d: float, h: float) -> None:
    """Seat at half height, a back of two slats."""
    seat = 0.5 * h
    legs(s, w, d, seat, 0.04, MAIN)
    s.box((0, 0, seat), (w, d, 0.035))
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.02), d / 2 - 0.02, (seat + h) / 2), (0.04, 0.04, h - seat))
    for z in (0.72, 0.94):
        s.box((0, d / 2 - 0.02, z * h), (w - 0.04, 0.025, 0.11 * h))


def stool(s: Sculpt, w: float, d: float, h: float) -> None:
    """A round seat on four legs with a ring."""
    s.cylinder((0, 0, h - 0.035), w / 2, 0.035)
    legs(s, 0.8 * w, 0.8 * d, h - 0.03, 0.035, "wood")
    s.box((0, 0, 0.3 * h), (0.75 * w, 0.02, 0.02), "wood")
    s.box((0, 0, 0.3 * h), (0.02, 0.75 * d, 0.02), "wood")


def sofa(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two arms, a back, one seat cushion and one back cushion for every 0.7 m."""
    arm, seat = 0.17, 0.5 * h
    s.box((0, 0, 0.06 + 0.14 * h), (w, d, 0.28 * h))
    legs(s, w - 0.1, d - 0.1, 0.07, 0.05, "wood")
    s.soft((0, d / 2 - 0.11, 0.55 * h), (w, 0.22, 0.9 * h), power=0.25)
    for x in (-1.0, 1.0):
        s.soft((x * (w - arm) / 2, 0, 0.4 * h), (arm, d, 0.62 * h), power=0.25)
    places = max(1, round((w - 2 * arm) / 0.7))
    wide = (w - 2 * arm) / places
    for i in range(places):
        x = -w / 2 + arm + wide * (i + 0.5)
        s.soft((x, -0.06, seat - 0.07), (wide, d - 0.26, 0.18), power=0.25)
        s.soft((x, d / 2 - 0.27, 0.72 * h), (wide, 0.18, 0.42 * h), power=0.35)


def ottoman(s: Sculpt, w: float, d: float, h: float) -> None:
    """An upholstered block on short legs."""
    legs(s, w - 0.06, d - 0.06, 0.08, 0.04, "wood")
    s.soft((0, 0, 0.08 + (h - 0.08) / 2), (w, d, h - 0.08), power=0.2)


def bench(s: Sculpt, w: float, d: float, h: float) -> None:
    """A plank on two cheeks."""
    s.box((0, 0, h - 0.02), (w, d, 0.04))
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.12), 0, h / 2 - 0.02), (0.05, d * 0.9, h - 0.04))
    s.box((0, 0, 0.4 * h), (w - 0.26, 0.03, 0.06))


def office_chair(s: Sculpt, w: float, d: float, h: float) -> None:
    """A swivel chair on five castors, with arms."""
    from math import cos, pi, sin

    seat = 0.5 * h
    for i in range(5):
        x, y = 0.46 * w * cos(i * 2 * pi / 5 + 0.3), 0.46 * d * sin(i * 2 * pi / 5 + 0.3)
        s.tube(((0, 0, 0.1), (x, y, 0.07)), 0.018, "dark")
        s.soft((x, y, 0.03), (0.06, 0.06, 0.06), "black", power=1)
    s.cylinder((0, 0, 0.07), 0.028, seat - 0.1, "steel")
    s.soft((0, -0.02, seat - 0.03), (0.78 * w, 0.76 * d, 0.1), power=0.4)
    s.soft((0, 0.36 * d, (seat + h) / 2 + 0.03), (0.72 * w, 0.09, h - seat - 0.06), power=0.4)
    for x in (-1, 1):
        arm = x * 0.43 * w
        s.tube(((x * 0.3 * w, 0, seat - 0.05), (arm, 0, seat - 0.04), (arm, 0, seat + 0.17)), 0.015, "dark")
        s.soft((arm, -0.02, seat + 0.18), (0.06, 0.42 * d, 0.035), "dark", power=0.4)


RECIPES: dict[str, Recipe] = {
    "chair": Recipe(chair, "wood", ((0.44, 0.48, 0.88), (0.42, 0.44, 0.94), (0.48, 0.52, 0.82)), 0.52),
    "stool": Recipe(stool, "wood", ((0.36, 0.36, 0.46), (0.38, 0.38, 0.68)), 1.0),
    "sofa": Recipe(sofa, "gray", ((2.05, 0.9, 0.82), (1.6, 0.86, 0.8), (2.4, 0.95, 0.84)), 0.52),
    "armchair": Recipe(sofa, "brown", ((0.88, 0.86, 0.86), (0.8, 0.82, 0.92)), 0.52),
    "ottoman": Recipe(ottoman, "gray", ((0.6, 0.6, 0.42), (0.8, 0.5, 0.4)), 1.0),
    "bench": Recipe(bench, "wood", ((1.2, 0.36, 0.45),), 1.0),
    "office chair": Recipe(office_chair, "dark", ((0.62, 0.62, 1.02), (0.6, 0.6, 0.92)), None),
}
