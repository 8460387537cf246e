"""What a bathroom has, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def toilet(s: Sculpt, w: float, d: float, h: float) -> None:
    """A bowl with its lid down, a cistern behind."""
    seat = 0.53 * h
    s.soft((0, -0.12 * d, 0.5 * seat), (0.62 * w, 0.62 * d, seat), power=0.5)
    s.soft((0, -0.14 * d, 0.82 * seat), (0.95 * w, 0.7 * d, 0.36 * seat), power=0.7)
    s.soft((0, -0.13 * d, seat), (0.97 * w, 0.72 * d, 0.05), "paper", power=0.7)
    s.box((0, 0.36 * d, 0.76 * h), (w, 0.26 * d, 0.46 * h))
    s.box((0, 0.36 * d, 0.3 * h), (0.5 * w, 0.26 * d, 0.6 * h))
    s.cylinder((0, 0.36 * d, 0.99 * h), 0.03, 0.01 * h, "steel")


def washbasin(s: Sculpt, w: float, d: float, h: float) -> None:
    """A basin on a pedestal, its tap behind."""
    rim = 0.86 * h
    s.turned(((0, 0), (0.2 * w, 0), (0.12 * w, 0.1 * h), (0.12 * w, 0.7 * h)), (0, 0.15 * d, 0))
    s.soft((0, 0, rim - 0.08), (w, d, 0.17), power=0.45)
    s.soft((0, -0.08 * d, rim - 0.03), (0.78 * w, 0.66 * d, 0.09), "gray", power=0.8)
    tap(s, (0, 0.36 * d, rim), h - rim, 0.22 * d)


def tap(s: Sculpt, foot: tuple[float, float, float], h: float, reach: float) -> None:
    """A bent spout reaching to the front."""
    x, y, z = foot
    path = ((x, y, z), (x, y, z + 0.8 * h), (x, y - 0.3 * reach, z + h), (x, y - reach, z + 0.85 * h))
    s.tube(path, 0.013, "steel")


def bathtub(s: Sculpt, w: float, d: float, h: float) -> None:
    """Long from left to right, empty."""
    wall = 0.07
    s.box((0, 0, 0.08), (w, d, 0.16))
    for side in (-1, 1):
        s.box((0, side * (d - wall) / 2, h / 2), (w, wall, h))
        s.box((side * (w - wall) / 2, 0, h / 2), (wall, d, h))
    s.soft((0, 0, 0.16), (w - wall, d - wall, 0.14), power=0.35)
    s.tube(((-w / 2 + 0.05, 0, h), (-w / 2 + 0.05, 0, h + 0.1), (-w / 2 + 0.2, 0, h + 0.1)), 0.015, "steel")


def shower(s: Sculpt, w: float, d: float, h: float) -> None:
    """A tray, two panes to the front and right, a head on a pole."""
    s.box((0, 0, 0.04), (w, d, 0.08))
    s.box((0, -d / 2 + 0.006, h / 2), (w, 0.012, h), "glass")
    s.box((w / 2 - 0.006, 0, h / 2), (0.012, d, h), "glass")
    for x, y in ((-1, -1), (1, -1), (1, 1)):
        s.box((x * (w / 2 - 0.012), y * (d / 2 - 0.012), h / 2), (0.024, 0.024, h), "steel")
    path = ((0, d / 2 - 0.03, 0.5 * h), (0, d / 2 - 0.03, 0.97 * h), (0, d / 2 - 0.25, 0.97 * h))
    s.tube(path, 0.012, "steel")
    s.cylinder((0, d / 2 - 0.25, 0.94 * h), 0.09, 0.02, "steel")


def towel(s: Sculpt, w: float, d: float, h: float) -> None:
    """Hangs, doubled, its fold above."""
    for y in (-1, 1):
        s.box(
            (0, y * 0.3 * d, 0.49 * h + (0.02 * h if y > 0 else 0)),
            (w, 0.38 * d, 0.96 * h - (y > 0) * 0.1 * h),
        )
    s.cylinder((-w / 2, 0, h - d / 2), d / 2, w, axis="x", sides=12)
    for z in (0.08, 0.12):
        s.box((0, -0.5 * d, z * h), (1.001 * w, 0.06 * d, 0.018 * h), "cream")


def towel_rack(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two bars on the wall."""
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.012), 0, h / 2), (0.024, d, h))
    for y, z in ((-0.4, 0.85), (-0.1, 0.3)):
        s.cylinder((-w / 2, y * d, z * h), 0.008, w, axis="x", sides=10)


def soap(s: Sculpt, w: float, d: float, h: float) -> None:
    """A bar on a dish."""
    s.turned(
        ((0, 0), (0.36 * w, 0), (0.5 * w, 0.4 * h), (0.46 * w, 0.4 * h), (0.3 * w, 0.2 * h)), finish="paper"
    )
    s.soft((0, 0, 0.62 * h), (0.72 * w, 0.62 * d, 0.76 * h), power=0.5)


def soap_dispenser(s: Sculpt, w: float, d: float, h: float) -> None:
    """A bottle with a pump, its spout to the front."""
    r = 0.38 * w
    s.turned(((0, 0), (r, 0), (r, 0.62 * h), (0.35 * r, 0.72 * h)), smooth=False)
    s.cylinder((0, 0, 0.7 * h), 0.3 * r, 0.22 * h, "steel", sides=10)
    s.tube(((0, 0.1 * d, 0.95 * h), (0, -0.2 * d, 0.97 * h), (0, -0.45 * d, 0.9 * h)), 0.05 * h, "steel")


def toothbrush(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Two brushes in a beaker."""
    r = 0.45 * w
    s.turned(((0, 0), (0.85 * r, 0), (r, 0.5 * h), (0.9 * r, 0.5 * h), (0.78 * r, 0.04 * h)), finish="glass")
    for side, finish in ((-1, "main"), (1, "blue")):
        top = (side * 0.4 * w, 0, 0.98 * h)
        s.tube(((0, 0, 0.05 * h), top), 0.006, finish)
        s.box((top[0], -0.012, 0.94 * h), (0.012, 0.02, 0.1 * h), "white")


def toilet_paper(s: Sculpt, w: float, d: float, h: float) -> None:
    """A roll on a holder on the wall."""
    r = 0.42 * d
    s.box((0, 0.48 * d, h / 2), (w, 0.04 * d, h), "steel")
    s.box((-w / 2 + 0.004, 0.2 * d, h / 2), (0.008, 0.6 * d, 0.12 * h), "steel")
    s.cylinder((-w / 2, -0.08 * d, h / 2), 0.2 * r, w, "steel", "x", sides=12)
    s.cylinder((-0.42 * w, -0.08 * d, h / 2), r, 0.86 * w, "main", "x", sides=24)


def toilet_brush(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A brush in its pot."""
    s.turned(((0, 0), (0.5 * w, 0), (0.42 * w, 0.35 * h), (0, 0.36 * h)))
    s.cylinder((0, 0, 0.34 * h), 0.012, 0.66 * h, "steel", sides=10)


def bath_mat(s: Sculpt, w: float, d: float, h: float) -> None:
    """A soft mat."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.15)


def sponge(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two layers."""
    s.soft((0, 0, 0.4 * h), (w, d, 0.8 * h), power=0.3)
    s.box((0, 0, 0.88 * h), (0.95 * w, 0.94 * d, 0.24 * h), "green")


def scale(s: Sculpt, w: float, d: float, h: float) -> None:
    """A plate with a display at its far end."""
    s.soft((0, 0, 0.45 * h), (w, d, 0.9 * h), power=0.25)
    s.box((0, 0.32 * d, 0.92 * h), (0.36 * w, 0.16 * d, 0.16 * h), "screen")


RECIPES: dict[str, Recipe] = {
    "toilet": Recipe(toilet, "white", ((0.38, 0.68, 0.78),), None),
    "washbasin": Recipe(washbasin, "white", ((0.6, 0.46, 0.98), (0.5, 0.42, 0.96)), None),
    "bathtub": Recipe(bathtub, "white", ((1.7, 0.75, 0.62),), None),
    "shower": Recipe(shower, "white", ((0.9, 0.9, 2.0),), None),
    "towel": Recipe(towel, "plain", ((0.4, 0.06, 0.55), (0.3, 0.05, 0.45)), None),
    "towel rack": Recipe(towel_rack, "steel", ((0.6, 0.12, 0.12),), None),
    "soap": Recipe(soap, "pink", ((0.12, 0.12, 0.04),), None),
    "soap dispenser": Recipe(soap_dispenser, "green", ((0.08, 0.09, 0.18),), None),
    "toothbrush": Recipe(toothbrush, "red", ((0.09, 0.08, 0.2),), None),
    "toilet paper": Recipe(toilet_paper, "paper", ((0.13, 0.13, 0.12),), None),
    "toilet brush": Recipe(toilet_brush, "white", ((0.1, 0.1, 0.38),), None),
    "bath mat": Recipe(bath_mat, "blue", ((0.7, 0.45, 0.02),), None),
    "sponge": Recipe(sponge, "yellow", ((0.11, 0.07, 0.04),), None),
    "scale": Recipe(scale, "white", ((0.3, 0.3, 0.03),), None),
}
