"""What is eaten and drunk from, cooked in and cut with, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def mug(s: Sculpt, w: float, d: float, h: float) -> None:
    """Straight, its handle on its right."""
    r = d / 2
    x = -(w - d) / 2
    s.turned(((0, 0), (0.94 * r, 0), (r, 0.06 * h), (r, h), (0.9 * r, h), (0.88 * r, 0.1 * h)), (x, 0, 0))
    s.turned(((0.9 * r, 0.8 * h), (0, 0.8 * h)), (x, 0, 0), "brown")
    arc = ((0.92, 0.82), (0.92 + 0.5, 0.8), (0.92 + 0.62, 0.5), (0.92 + 0.48, 0.25), (0.92, 0.2))
    scale = (w / 2 - x) / (1.54 * r + 0.06 * h)
    s.tube([(x + k * r * scale, 0, z * h) for k, z in arc], 0.06 * h)


def cup(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A tea cup on its saucer."""
    s.turned(
        ((0, 0), (0.3 * w, 0), (0.5 * w, 0.2 * h), (0.48 * w, 0.24 * h), (0.25 * w, 0.1 * h)), smooth=False
    )
    bowl = (
        (0.14 * w, 0.12 * h),
        (0.2 * w, 0.3 * h),
        (0.31 * w, h),
        (0.28 * w, h),
        (0.17 * w, 0.3 * h),
        (0, 0.25 * h),
    )
    s.turned(bowl)
    s.turned(((0.27 * w, 0.8 * h), (0, 0.8 * h)), finish="brown")
    s.tube([(x * w, 0, z * h) for x, z in ((0.27, 0.85), (0.42, 0.8), (0.4, 0.5), (0.22, 0.42))], 0.05 * h)


def glass(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A tumbler."""
    r = w / 2
    s.turned(((0, 0), (0.82 * r, 0), (r, h), (0.93 * r, h), (0.77 * r, 0.1 * h), (0, 0.1 * h)))


def wine_glass(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A bowl on a stem."""
    r = w / 2
    foot = ((0, 0), (0.85 * r, 0), (0.8 * r, 0.02 * h), (0.1 * r, 0.06 * h), (0.1 * r, 0.45 * h))
    s.turned(
        (*foot, (0.75 * r, 0.56 * h), (r, 0.72 * h), (0.82 * r, h), (0.78 * r, h), (0.9 * r, 0.72 * h)),
        smooth=True,
    )


def plate(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Flat, its rim raised."""
    r = w / 2
    s.turned(
        ((0, 0), (0.6 * r, 0), (r, 0.85 * h), (r, h), (0.95 * r, h), (0.62 * r, 0.35 * h), (0, 0.35 * h)),
        sides=32,
    )


def bowl(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Open above."""
    r = w / 2
    out = ((0, 0), (0.42 * r, 0), (0.75 * r, 0.35 * h), (r, h))
    s.turned(
        (*out, (0.94 * r, h), (0.68 * r, 0.38 * h), (0.35 * r, 0.12 * h), (0, 0.12 * h)),
        smooth=True,
        sides=28,
    )


def fruit_bowl(s: Sculpt, w: float, d: float, h: float) -> None:
    """A bowl with apples, oranges and a lemon."""
    bowl(s, w, d, 0.6 * h)
    fruits = ((-0.2, -0.1, 0.5, "red"), (0.2, -0.14, 0.5, "orange"), (0.0, 0.2, 0.5, "green"))
    for x, y, z, finish in (*fruits, (0.02, 0.0, 0.8, "yellow")):
        s.soft((x * w, y * d, z * h), (0.3 * w, 0.3 * d, 0.4 * h), finish, power=1)


def bottle(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A body with a label, a neck and a cap."""
    r = w / 2
    s.turned(
        (
            (0, 0),
            (0.95 * r, 0),
            (r, 0.03 * h),
            (r, 0.58 * h),
            (0.86 * r, 0.66 * h),
            (0.36 * r, 0.76 * h),
            (0.34 * r, 0.94 * h),
        )
    )
    s.turned(((1.015 * r, 0.2 * h), (1.015 * r, 0.48 * h)), finish="paper")
    s.cylinder((0, 0, 0.92 * h), 0.4 * r, 0.08 * h, "dark", sides=14)


def jar(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Straight, with a lid and a label."""
    r = w / 2
    s.turned(((0, 0), (0.94 * r, 0), (r, 0.05 * h), (r, 0.74 * h), (0.85 * r, 0.84 * h)))
    s.turned(((1.012 * r, 0.2 * h), (1.012 * r, 0.6 * h)), finish="paper")
    s.cylinder((0, 0, 0.84 * h), 0.9 * r, 0.16 * h, "brass")


def pan(s: Sculpt, w: float, d: float, h: float) -> None:
    """Low, its handle to the front."""
    r = w / 2
    y = d / 2 - r
    s.turned(
        ((0, 0), (0.82 * r, 0), (r, 0.8 * h), (0.96 * r, 0.8 * h), (0.78 * r, 0.15 * h), (0, 0.15 * h)),
        (0, y, 0),
        sides=28,
    )
    s.tube(
        ((0, y - 0.9 * r, 0.7 * h), (0, y - 1.2 * r, 0.9 * h), (0, -d / 2, 0.9 * h)), 0.1 * h + 0.004, "black"
    )


def pot(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A lid with a knob, two handles."""
    r = 0.4 * w
    s.turned(((0, 0), (0.97 * r, 0), (r, 0.04 * h), (r, 0.78 * h)), sides=28)
    s.turned(((1.03 * r, 0.77 * h), (1.03 * r, 0.8 * h), (0.3 * r, 0.9 * h), (0, 0.9 * h)), sides=28)
    s.turned(((0.05 * r, 0.88 * h), (0.18 * r, h), (0, h)), finish="black")
    for x in (-1, 1):
        arc = ((0.95, -0.3), (1.2, -0.25), (1.2, 0.25), (0.95, 0.3))
        s.tube([(x * k * r, y * r, 0.66 * h) for k, y in arc], 0.012, "black")


def teapot(s: Sculpt, w: float, d: float, h: float) -> None:
    """Round, its spout on its left, its handle on its right."""
    s.soft((0, 0, 0.42 * h), (0.58 * w, 0.95 * d, 0.84 * h), power=0.95)
    s.turned(((0.14 * w, 0.82 * h), (0.05 * w, 0.9 * h), (0.06 * w, h), (0, h)), smooth=True)
    s.tube([(x * w, 0, z * h) for x, z in ((-0.24, 0.35), (-0.38, 0.5), (-0.47, 0.8))], 0.07 * h)
    s.tube([(x * w, 0, z * h) for x, z in ((0.22, 0.68), (0.42, 0.68), (0.46, 0.4), (0.25, 0.22))], 0.045 * h)


def knife_block(s: Sculpt, w: float, d: float, h: float) -> None:
    """A leaning block, handles above."""
    s.box((0, 0.08 * d, 0.33 * h), (w, 0.8 * d, 0.66 * h))
    for i, y in enumerate((-0.22, -0.05, 0.12, 0.3)):
        for x in (-0.25, 0.25):
            s.box((x * w, y * d, (0.8 + 0.04 * i) * h), (0.2 * w, 0.1 * d, (0.3 + 0.04 * i) * h), "black")


def cutting_board(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, a dark groove around it."""
    s.box((0, 0, 0.46 * h), (w, d, 0.92 * h))
    s.box((0, 0, 0.94 * h), (0.9 * w, 0.86 * d, 0.05 * h), "brown")
    s.box((0, 0, 0.96 * h), (0.87 * w, 0.82 * d, 0.08 * h))


def knife(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, its blade to the front."""
    s.soft((0, 0.29 * d, h / 2), (0.7 * w, 0.4 * d, h), "black", power=0.4)
    s.box((0, -0.2 * d, h / 2), (w, 0.6 * d, 0.3 * h), "steel")


def fork(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, four tines to the front."""
    s.soft((0, 0.2 * d, h / 2), (0.45 * w, 0.6 * d, 0.6 * h), power=0.5)
    s.box((0, -0.18 * d, h / 2), (w, 0.2 * d, 0.5 * h))
    for i in range(4):
        s.box(((i - 1.5) * 0.28 * w, -0.39 * d, h / 2), (0.14 * w, 0.22 * d, 0.6 * h))


def spoon(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, its bowl to the front."""
    s.soft((0, 0.17 * d, 0.6 * h), (0.3 * w, 0.66 * d, 0.4 * h), power=0.5)
    s.soft((0, -0.34 * d, 0.5 * h), (w, 0.32 * d, h), power=1)


def spice_rack(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two boards of little jars."""
    s.box((0, 0.45 * d, h / 2), (w, 0.1 * d, h))
    for row, z in enumerate((0.02, 0.5)):
        s.box((0, 0, z * h), (w, d, 0.04 * h))
        for i in range(4):
            x = (i - 1.5) * w / 4.4
            s.cylinder(
                (x, -0.1 * d, (z + 0.02) * h),
                0.09 * w,
                0.26 * h,
                ("red", "green", "yellow", "brown")[(i + row) % 4],
            )
            s.cylinder((x, -0.1 * d, (z + 0.28) * h), 0.092 * w, 0.06 * h, "black")


def paper_towel(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A roll on a standing holder."""
    s.cylinder((0, 0, 0), w / 2, 0.05 * h, "wood", sides=28)
    s.cylinder((0, 0, 0.05 * h), 0.42 * w, 0.8 * h, sides=28)
    s.cylinder((0, 0, 0.85 * h), 0.05 * w, 0.15 * h, "wood")


def salt_shaker(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Glass with a steel cap."""
    r = w / 2
    s.turned(((0, 0), (r, 0), (0.75 * r, 0.7 * h)))
    s.turned(((0.8 * r, 0.68 * h), (0.7 * r, 0.92 * h), (0.3 * r, h), (0, h)), finish="steel", smooth=True)


def bread(s: Sculpt, w: float, d: float, h: float) -> None:
    """A loaf with cuts."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.7)
    for x in (-0.2, 0.0, 0.2):
        s.soft((x * w, 0, 0.94 * h), (0.04 * w, 0.6 * d, 0.1 * h), "cream", power=0.8)


def cake(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two layers, cream, cherries, on a plate."""
    s.cylinder((0, 0, 0), w / 2, 0.05 * h, "white", sides=28)
    s.cylinder((0, 0, 0.05 * h), 0.42 * w, 0.35 * h, "brown", sides=28)
    s.cylinder((0, 0, 0.4 * h), 0.43 * w, 0.12 * h, sides=28)
    s.cylinder((0, 0, 0.52 * h), 0.42 * w, 0.33 * h, "brown", sides=28)
    s.cylinder((0, 0, 0.8 * h), 0.43 * w, 0.1 * h, sides=28)
    for x, y in ((0.3, 0), (-0.3, 0), (0, 0.3), (0, -0.3), (0.0, 0.0)):
        s.soft((x * w, y * d, 0.93 * h), (0.1 * w, 0.1 * d, 0.14 * h), "red", power=1)


RECIPES: dict[str, Recipe] = {
    "mug": Recipe(mug, "white", ((0.12, 0.085, 0.1), (0.115, 0.09, 0.09)), None),
    "cup": Recipe(cup, "white", ((0.15, 0.15, 0.07),), None),
    "glass": Recipe(glass, "glass", ((0.075, 0.075, 0.12), (0.07, 0.07, 0.15)), None),
    "wine glass": Recipe(wine_glass, "glass", ((0.08, 0.08, 0.2),), None),
    "plate": Recipe(plate, "white", ((0.26, 0.26, 0.022), (0.2, 0.2, 0.02)), None),
    "bowl": Recipe(bowl, "white", ((0.16, 0.16, 0.07), (0.24, 0.24, 0.1)), None),
    "fruit bowl": Recipe(fruit_bowl, "white", ((0.28, 0.28, 0.16),), None),
    "bottle": Recipe(bottle, "green", ((0.08, 0.08, 0.3), (0.07, 0.07, 0.24), (0.09, 0.09, 0.26)), None),
    "jar": Recipe(jar, "glass", ((0.09, 0.09, 0.12), (0.1, 0.1, 0.16)), None),
    "pan": Recipe(pan, "dark", ((0.26, 0.46, 0.06), (0.22, 0.4, 0.06)), None),
    "pot": Recipe(pot, "steel", ((0.3, 0.24, 0.18), (0.26, 0.21, 0.15)), None),
    "teapot": Recipe(teapot, "white", ((0.24, 0.15, 0.16),), None),
    "knife block": Recipe(knife_block, "wood", ((0.11, 0.18, 0.26),), None),
    "cutting board": Recipe(cutting_board, "wood", ((0.4, 0.27, 0.02),), 1.0),
    "knife": Recipe(knife, "steel", ((0.025, 0.24, 0.015),), None),
    "fork": Recipe(fork, "steel", ((0.025, 0.2, 0.012),), None),
    "spoon": Recipe(spoon, "steel", ((0.04, 0.2, 0.014),), None),
    "spice rack": Recipe(spice_rack, "wood", ((0.3, 0.09, 0.26),), None),
    "paper towel": Recipe(paper_towel, "paper", ((0.14, 0.14, 0.3),), None),
    "salt shaker": Recipe(salt_shaker, "glass", ((0.045, 0.045, 0.1),), None),
    "bread": Recipe(bread, "crust", ((0.26, 0.13, 0.11),), None),
    "cake": Recipe(cake, "paper", ((0.24, 0.24, 0.13),), None),
}
