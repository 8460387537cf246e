"""What a bedroom has, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def bed(s: Sculpt, w: float, d: float, h: float) -> None:
    """Head behind, foot to the front; a mattress, a spread, a pillow for each sleeper."""
    deck = 0.28
    s.box((0, -0.03, 0.6 * deck), (w, d - 0.06, 0.6 * deck), "wood")
    for x in (-1.0, 1.0):
        for y in (-1, 1):
            s.box((x * (w / 2 - 0.04), y * (d / 2 - 0.06), 0.06), (0.07, 0.07, 0.12), "wood")
    s.soft((0, -0.02, 0.39), (w - 0.04, d - 0.1, 0.24), "white", power=0.2)
    s.soft((0, -0.24, 0.41), (w + 0.02, d - 0.62, 0.27), power=0.2)
    s.box((0, d / 2 - 0.03, h / 2), (w, 0.05, h), "wood")
    sleepers = 2 if w > 1.3 else 1
    for i in range(sleepers):
        x = (i + 0.5 - sleepers / 2) * w / sleepers
        s.soft((x, d / 2 - 0.3, 0.56), (0.8 * w / sleepers, 0.4, 0.16), "paper", power=0.5)


def crib(s: Sculpt, w: float, d: float, h: float) -> None:
    """Bars around a mattress."""
    s.soft((0, 0, 0.42 * h), (w - 0.06, d - 0.06, 0.12), "paper", power=0.3)
    s.box((0, 0, 0.33 * h), (w, d, 0.04))
    for z in (0.33, 0.98):
        for side in (-1, 1):
            s.box((0, side * (d / 2 - 0.015), z * h), (w, 0.03, 0.04))
            s.box((side * (w / 2 - 0.015), 0, z * h), (0.03, d, 0.04))
    for i in range(9):
        for side in (-1, 1):
            s.box((side * (w / 2 - 0.015), (i / 8 - 0.5) * (d - 0.06), 0.66 * h), (0.016, 0.016, 0.64 * h))
    for x in (-1, 1):
        for y in (-1, 1):
            s.box((x * (w / 2 - 0.02), y * (d / 2 - 0.02), h / 2), (0.04, 0.04, h))


def pillow(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.5)


def blanket(s: Sculpt, w: float, d: float, h: float) -> None:
    """Folded three times."""
    for i in range(3):
        s.soft((0.01 * i, 0.006 * i, h * (i + 0.5) / 3), (w - 0.02 * i, d, h / 3), power=0.25)


def clothes(s: Sculpt, w: float, d: float, h: float) -> None:
    """A pile of folded shirts."""
    finishes = ("main", "white", "gray", "main", "blue")
    for i, finish in enumerate(finishes):
        s.soft((0.008 * (i % 3 - 1), 0, h * (i + 0.5) / 5), (w - 0.02, d, h / 5), finish, power=0.25)


def teddy_bear(s: Sculpt, w: float, d: float, h: float) -> None:
    """Sits, arms out."""
    s.soft((0, 0, 0.32 * h), (0.56 * w, 0.6 * d, 0.5 * h), power=1)
    s.soft((0, -0.05 * d, 0.72 * h), (0.5 * w, 0.56 * d, 0.4 * h), power=1)
    s.soft((0, -0.33 * d, 0.66 * h), (0.2 * w, 0.2 * d, 0.15 * h), "cream", power=1)
    s.soft((0, -0.43 * d, 0.69 * h), (0.07 * w, 0.06 * d, 0.05 * h), "black", power=1)
    for x in (-1, 1):
        s.soft((x * 0.2 * w, 0, 0.92 * h), (0.18 * w, 0.14 * d, 0.16 * h), power=1)
        s.soft((x * 0.1 * w, -0.31 * d, 0.78 * h), (0.04 * w, 0.05 * d, 0.04 * h), "black", power=1)
        s.soft((x * 0.36 * w, -0.1 * d, 0.42 * h), (0.28 * w, 0.3 * d, 0.2 * h), power=1)
        s.soft((x * 0.24 * w, -0.28 * d, 0.1 * h), (0.24 * w, 0.44 * d, 0.2 * h), power=1)


def slippers(s: Sculpt, w: float, d: float, h: float) -> None:
    """A pair, toes to the front."""
    for x in (-1, 1):
        s.soft((x * 0.26 * w, 0, 0.15 * h), (0.42 * w, d, 0.3 * h), power=0.6)
        s.soft((x * 0.26 * w, -0.2 * d, 0.5 * h), (0.4 * w, 0.55 * d, h), power=0.8)
        s.soft((x * 0.26 * w, 0.16 * d, 0.3 * h), (0.3 * w, 0.5 * d, 0.06 * h), "cream", power=0.7)


def shoes(s: Sculpt, w: float, d: float, h: float) -> None:
    """A pair of laced shoes, toes to the front."""
    for x in (-1, 1):
        s.soft((x * 0.26 * w, 0, 0.09 * h), (0.42 * w, d, 0.18 * h), "white", power=0.5)
        s.soft((x * 0.26 * w, -0.1 * d, 0.35 * h), (0.4 * w, 0.78 * d, 0.5 * h), power=0.7)
        s.soft((x * 0.26 * w, 0.25 * d, 0.55 * h), (0.38 * w, 0.46 * d, 0.9 * h), power=0.6)
        for y in (-0.22, -0.1, 0.02):
            s.box((x * 0.26 * w, y * d, 0.62 * h + 0.12 * h * (y + 0.22)), (0.2 * w, 0.012, 0.012), "white")


def hat(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A brim and a crown with a band."""
    s.turned(((0, 0), (0.5 * w, 0), (0.5 * w, 0.06 * h), (0.3 * w, 0.1 * h)))
    s.turned(((0.3 * w, 0.08 * h), (0.3 * w, 0.3 * h)), finish="black")
    s.turned(((0.295 * w, 0.3 * h), (0.28 * w, 0.75 * h), (0.2 * w, h), (0, 0.96 * h)), smooth=True)


def doll(s: Sculpt, w: float, d: float, h: float) -> None:
    """Stands in a dress."""
    s.turned(((0, 0.1 * h), (0.42 * w, 0.1 * h), (0.16 * w, 0.6 * h), (0, 0.64 * h)), smooth=False)
    s.soft((0, 0, 0.8 * h), (0.36 * w, 0.8 * d, 0.32 * h), "skin", power=1)
    s.soft((0, 0.12 * d, 0.86 * h), (0.4 * w, 0.75 * d, 0.28 * h), "brown", power=1)
    for x in (-1, 1):
        s.tube(((x * 0.1 * w, 0, 0.6 * h), (x * 0.48 * w, 0, 0.42 * h)), 0.06 * w, "skin")
        s.cylinder((x * 0.12 * w, 0, 0), 0.06 * w, 0.16 * h, "skin", sides=10)


def toy_car(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its bonnet to the front."""
    s.soft((0, 0, 0.42 * h), (w, d, 0.46 * h), power=0.3)
    s.soft((0, 0.05 * d, 0.75 * h), (0.86 * w, 0.5 * d, 0.5 * h), "glass", power=0.4)
    for x in (-1, 1):
        for y in (-0.3, 0.3):
            s.cylinder((x * 0.42 * w - 0.06 * w, y * d, 0.22 * h), 0.22 * h, 0.12 * w, "black", "x")


def ball(s: Sculpt, w: float, d: float, h: float) -> None:
    """Round."""
    s.soft((0, 0, h / 2), (w, d, h), power=1)


RECIPES: dict[str, Recipe] = {
    "bed": Recipe(bed, "blue", ((1.6, 2.1, 0.95), (0.95, 2.05, 0.9), (1.8, 2.15, 1.0)), 0.55),
    "crib": Recipe(crib, "white", ((0.7, 1.25, 0.95),), None),
    "pillow": Recipe(pillow, "paper", ((0.65, 0.42, 0.14), (0.5, 0.4, 0.13)), None),
    "blanket": Recipe(blanket, "checked", ((0.5, 0.4, 0.15), (0.42, 0.34, 0.12)), None),
    "clothes": Recipe(clothes, "green", ((0.3, 0.38, 0.16),), None),
    "teddy bear": Recipe(teddy_bear, "crust", ((0.3, 0.26, 0.36), (0.22, 0.2, 0.26)), None),
    "slipper": Recipe(slippers, "blue", ((0.24, 0.27, 0.08),), None),
    "shoe": Recipe(shoes, "red", ((0.24, 0.29, 0.12),), None),
    "hat": Recipe(hat, "brown", ((0.34, 0.36, 0.13),), None),
    "doll": Recipe(doll, "pink", ((0.2, 0.09, 0.34),), None),
    "toy car": Recipe(toy_car, "red", ((0.11, 0.24, 0.09),), None),
    "ball": Recipe(ball, "orange", ((0.22, 0.22, 0.22),), None),
}
