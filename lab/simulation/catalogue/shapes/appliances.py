"""Machines of kitchen and laundry, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt
from lab.simulation.catalogue.shapes.bathroom import tap
from lab.simulation.catalogue.shapes.storage import kitchen_cabinet


def refrigerator(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two doors with handles."""
    s.box((0, 0.03, h / 2), (w, d - 0.06, h))
    for low, high in ((0.03, 0.62), (0.63, 1.0)):
        s.box((0, -d / 2 + 0.045, (low + high) / 2 * h), (w, 0.03, (high - low) * h))
    for z, length in ((0.45, 0.4), (0.76, 0.25)):
        s.box((-0.4 * w, -d / 2 + 0.012, z * h), (0.025, 0.025, length), "steel")


def oven_front(s: Sculpt, w: float, d: float, h: float, z: float) -> None:
    """A glass door with a bar, and knobs above it, on a front that begins at height `z`."""
    s.box((0, -d / 2 - 0.002, z + 0.4 * h), (0.86 * w, 0.02, 0.62 * h), "dark")
    s.box((0, -d / 2 - 0.013, z + 0.4 * h), (0.62 * w, 0.004, 0.4 * h), "screen")
    s.tube(((-0.4 * w, -d / 2 - 0.04, z + 0.76 * h), (0.4 * w, -d / 2 - 0.04, z + 0.76 * h)), 0.01, "steel")
    for x in (-0.36, -0.2, 0.2, 0.36):
        s.cylinder((x * w, -d / 2 - 0.025, z + 0.9 * h), 0.02, 0.025, "dark", "y", sides=12)


def oven(s: Sculpt, w: float, d: float, h: float) -> None:
    """A built-in oven."""
    s.box((0, 0, h / 2), (w, d, h))
    oven_front(s, w, d, h, 0.0)


def stove(s: Sculpt, w: float, d: float, h: float) -> None:
    """An oven under four plates."""
    s.box((0, 0, h / 2), (w, d, h))
    oven_front(s, w, d, 0.8 * h, 0.12 * h)
    for x in (-0.23, 0.23):
        for y, r in ((-0.22, 0.16), (0.22, 0.13)):
            s.cylinder((x * w, y * d, h), r * w, 0.008, "dark")


def microwave(s: Sculpt, w: float, d: float, h: float) -> None:
    """A glass door, keys on its right."""
    s.box((0, 0, h / 2), (w, d, h))
    s.box((-0.12 * w, -d / 2 - 0.002, h / 2), (0.68 * w, 0.012, 0.84 * h), "dark")
    s.box((-0.12 * w, -d / 2 - 0.009, h / 2), (0.5 * w, 0.003, 0.56 * h), "screen")
    s.box((0.37 * w, -d / 2 - 0.002, 0.42 * h), (0.18 * w, 0.01, 0.55 * h), "keys", whole=True)
    s.box((0.37 * w, -d / 2 - 0.002, 0.8 * h), (0.18 * w, 0.01, 0.12 * h), "screen")


def dishwasher(s: Sculpt, w: float, d: float, h: float) -> None:
    """A flat door, a panel above it."""
    s.box((0, 0.01, h / 2), (w, d - 0.02, h))
    s.box((0, -d / 2 + 0.012, 0.46 * h), (0.97 * w, 0.02, 0.76 * h))
    s.box((0, -d / 2 + 0.01, 0.92 * h), (0.97 * w, 0.02, 0.12 * h), "dark")
    s.box((0, -d / 2, 0.8 * h), (0.6 * w, 0.03, 0.02), "steel")
    s.box((0, 0, 0.03 * h), (0.94 * w, d - 0.08, 0.06 * h), "dark")


def washing_machine(s: Sculpt, w: float, d: float, h: float) -> None:
    """A round door, a panel above it."""
    s.box((0, 0, h / 2), (w, d, h))
    at = (0.0, -d / 2 - 0.05, 0.47 * h)
    s.turned(((0.24 * w, 0), (0.34 * w, 0.02), (0.36 * w, 0.05)), at, "steel", "y", sides=28)
    s.turned(((0.24 * w, 0.01), (0.12 * w, 0.0), (0, 0.0)), at, "screen", "y", sides=28)
    s.box((-0.3 * w, -d / 2 - 0.002, 0.91 * h), (0.3 * w, 0.01, 0.1 * h), "gray")
    s.cylinder((0.2 * w, -d / 2 - 0.03, 0.91 * h), 0.035, 0.03, "gray", "y")


def sink(s: Sculpt, w: float, d: float, h: float) -> None:
    """A basin in a kitchen cabinet, its tap behind."""
    deck = h - 0.26
    kitchen_cabinet(s, w, d, deck)
    s.box((0, -0.03 * d, deck + 0.002), (0.78 * w, 0.72 * d, 0.012), "steel")
    s.soft((0, -0.06 * d, deck), (0.66 * w, 0.56 * d, 0.03), "gray", power=0.3)
    tap(s, (0, 0.36 * d, deck), 0.26, 0.4 * d)


def range_hood(s: Sculpt, w: float, d: float, h: float) -> None:
    """A flat hood and its flue."""
    s.box((0, 0, 0.07 * h), (w, d, 0.14 * h))
    s.box((0, 0.1 * d, 0.2 * h), (0.7 * w, 0.7 * d, 0.16 * h))
    s.box((0, 0.25 * d, 0.6 * h), (0.4 * w, 0.5 * d, 0.8 * h))
    s.box((0, -d / 2 - 0.002, 0.07 * h), (0.3 * w, 0.004, 0.05 * h), "dark")


def toaster(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two slots above, a lever on its right."""
    s.soft((0, 0, 0.5 * h), (0.94 * w, d, 0.94 * h), power=0.3)
    s.box((0, 0, 0.05 * h), (0.9 * w, 0.9 * d, 0.1 * h), "dark")
    for y in (-0.17, 0.17):
        s.box((0, y * d, 0.965 * h), (0.7 * w, 0.12 * d, 0.02 * h), "black")
    s.box((0.48 * w, 0, 0.6 * h), (0.05 * w, 0.16 * d, 0.06 * h), "black")


def kettle(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A jug with a spout on its left, a handle on its right."""
    r = 0.33 * w
    s.turned(
        ((0, 0), (r, 0), (0.98 * r, 0.06 * h), (0.66 * r, 0.9 * h), (0, 0.94 * h)),
        (-0.06 * w, 0, 0),
        smooth=False,
    )
    s.soft((-0.06 * w, 0, 0.96 * h), (0.1 * w, 0.1 * w, 0.08 * h), "black", power=1)
    s.turned(((1.03 * r, 0), (1.03 * r, 0.06 * h), (0, 0.06 * h)), (-0.06 * w, 0, 0), "black")
    s.tube(((-0.28 * w, 0, 0.62 * h), (-0.38 * w, 0, 0.8 * h), (-0.46 * w, 0, 0.86 * h)), 0.02, "main")
    arc = ((0.16 * w, 0.85), (0.42 * w, 0.88), (0.46 * w, 0.6), (0.32 * w, 0.22))
    s.tube([(x, 0, z * h) for x, z in arc], 0.014, "black")


def coffee_maker(s: Sculpt, w: float, d: float, h: float) -> None:
    """A glass pot under a filter, the tank behind."""
    s.box((0, 0.3 * d, h / 2), (w, 0.4 * d, h))
    s.box((0, 0, 0.05 * h), (w, d, 0.1 * h))
    s.box((0, -0.05 * d, 0.86 * h), (w, 0.9 * d, 0.28 * h))
    r = 0.36 * w
    pot = ((0, 0), (0.9 * r, 0), (r, 0.2 * h), (0.6 * r, 0.5 * h), (0.7 * r, 0.54 * h))
    s.turned(pot, (0, -0.15 * d, 0.11 * h), "brown", smooth=True)
    s.tube([(0, y * d, z * h) for y, z in ((-0.38, 0.58), (-0.48, 0.5), (-0.46, 0.3))], 0.01, "black")


def blender(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A jug on a motor."""
    s.turned(((0, 0), (0.45 * w, 0), (0.34 * w, 0.34 * h), (0, 0.36 * h)))
    s.turned(((0.22 * w, 0.36 * h), (0.36 * w, 0.92 * h)), finish="glass")
    s.turned(((0.38 * w, 0.91 * h), (0.38 * w, 0.96 * h), (0.12 * w, h), (0, h)), finish="black")
    s.tube(
        [(x * w, 0, z * h) for x, z in ((0.33, 0.86), (0.5, 0.82), (0.48, 0.5), (0.26, 0.46))], 0.01, "black"
    )
    s.cylinder((0, -0.4 * w - 0.01, 0.15 * h), 0.03, 0.04, "black", "y", sides=12)


def mixer(s: Sculpt, w: float, d: float, h: float) -> None:
    """A stand mixer, its bowl to the front."""
    s.soft((0, 0, 0.06 * h), (w, d, 0.12 * h), power=0.3)
    s.soft((0, 0.32 * d, 0.45 * h), (0.5 * w, 0.3 * d, 0.8 * h), power=0.4)
    s.soft((0, -0.02 * d, 0.84 * h), (0.55 * w, d * 0.95, 0.3 * h), power=0.6)
    r = 0.42 * w
    bowl = ((0, 0.12 * h), (0.5 * r, 0.12 * h), (r, 0.5 * h), (0.94 * r, 0.5 * h))
    s.turned(bowl, (0, -0.16 * d, 0), "steel", smooth=True)
    s.cylinder((0, -0.16 * d, 0.4 * h), 0.015, 0.35 * h, "steel", sides=8)


def fan(s: Sculpt, w: float, d: float, h: float) -> None:
    """A table fan in its cage."""
    s.turned(
        ((0, 0), (0.3 * w, 0), (0.28 * w, 0.04 * h), (0.05 * w, 0.08 * h), (0.05 * w, 0.5 * h)), smooth=False
    )
    s.turned(
        ((0, 0.6 * d), (0.12 * w, 0.55 * d), (0.1 * w, 0.1 * d), (0, 0)), (0, -0.2 * d, 0.66 * h), axis="y"
    )
    for x, z in ((0.2, 0), (-0.2, 0), (0, 0.2), (0, -0.2)):
        s.soft(
            (x * w, -0.1 * d, 0.66 * h + z * w),
            (0.22 * w + abs(x) * 0.6 * w, 0.03, 0.22 * w + abs(z) * 0.6 * w),
            "glass",
            1,
        )
    ring = [
        (0.5, 0.0),
        (0.354, 0.354),
        (0.0, 0.5),
        (-0.354, 0.354),
        (-0.5, 0.0),
        (-0.354, -0.354),
        (0.0, -0.5),
        (0.354, -0.354),
        (0.5, 0.0),
    ]
    s.tube([(x * 0.97 * w, -0.2 * d, 0.66 * h + z * 0.68 * h) for x, z in ring], 0.008)


def iron(s: Sculpt, w: float, d: float, h: float) -> None:
    """Stands on its sole, its point to the front."""
    s.soft((0, 0, 0.05 * h), (w, d, 0.1 * h), "steel", power=0.7)
    s.soft((0, 0.05 * d, 0.28 * h), (0.85 * w, 0.8 * d, 0.4 * h), power=0.6)
    s.tube([(0, y * d, z * h) for y, z in ((-0.2, 0.4), (-0.15, 0.85), (0.25, 0.92), (0.35, 0.35))], 0.018)


RECIPES: dict[str, Recipe] = {
    "refrigerator": Recipe(refrigerator, "white", ((0.6, 0.65, 1.8), (0.7, 0.7, 1.9)), None),
    "oven": Recipe(oven, "steel", ((0.6, 0.55, 0.6),), 1.0),
    "stove": Recipe(stove, "white", ((0.6, 0.62, 0.88),), 1.0),
    "microwave": Recipe(microwave, "white", ((0.48, 0.36, 0.28),), 1.0),
    "dishwasher": Recipe(dishwasher, "white", ((0.6, 0.6, 0.86),), 1.0),
    "washing machine": Recipe(washing_machine, "white", ((0.6, 0.6, 0.85),), 1.0),
    "dryer": Recipe(washing_machine, "white", ((0.6, 0.62, 0.85),), 1.0),
    "sink": Recipe(sink, "white", ((0.8, 0.6, 1.14), (1.0, 0.6, 1.14)), None),
    "range hood": Recipe(range_hood, "steel", ((0.6, 0.45, 0.55),), None),
    "toaster": Recipe(toaster, "steel", ((0.28, 0.17, 0.19),), None),
    "kettle": Recipe(kettle, "steel", ((0.24, 0.16, 0.23),), None),
    "coffee maker": Recipe(coffee_maker, "black", ((0.2, 0.25, 0.32),), None),
    "blender": Recipe(blender, "steel", ((0.19, 0.18, 0.38),), None),
    "mixer": Recipe(mixer, "red", ((0.22, 0.34, 0.34),), None),
    "fan": Recipe(fan, "white", ((0.32, 0.22, 0.46),), None),
    "iron": Recipe(iron, "blue", ((0.12, 0.27, 0.15),), None),
}
