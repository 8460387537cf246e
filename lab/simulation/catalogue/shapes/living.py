"""What a living room has besides seats and tables, composed."""

from __future__ import annotations

from math import cos, sin

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def tv(s: Sculpt, w: float, d: float, h: float) -> None:
    """A screen on a foot."""
    s.box((0, 0, 0.01), (0.4 * w, d, 0.02))
    s.box((0, 0.1 * d, 0.05 * h), (0.08 * w, 0.05, 0.1 * h))
    s.box((0, 0, 0.54 * h), (w, 0.05, 0.92 * h))
    s.box((0, -0.0255, 0.545 * h), (0.96 * w, 0.003, 0.85 * h), "screen")


def speaker(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two cones in a box."""
    s.box((0, 0, h / 2), (w, d, h))
    for z, r in ((0.3, 0.38), (0.72, 0.24)):
        s.turned(((r * w, 0), (0.5 * r * w, 0.012), (0, 0.006)), (0, -d / 2 - 0.001, z * h), "gray", "y")


def floor_lamp(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A shade on a pole."""
    s.cylinder((0, 0, 0), 0.36 * w, 0.025, "dark")
    s.cylinder((0, 0, 0.02), 0.012, 0.85 * h, "steel", sides=10)
    shade(s, w, 0.8 * h, 0.2 * h)


def table_lamp(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A shade on a bellied foot."""
    foot = (
        (0, 0),
        (0.24 * w, 0),
        (0.24 * w, 0.04 * h),
        (0.1 * w, 0.1 * h),
        (0.2 * w, 0.3 * h),
        (0.06 * w, 0.52 * h),
    )
    s.turned(foot, finish="clay", smooth=True)
    s.cylinder((0, 0, 0.5 * h), 0.008, 0.2 * h, "brass", sides=8)
    shade(s, w, 0.55 * h, 0.45 * h)


def shade(s: Sculpt, w: float, z: float, h: float) -> None:
    """A lampshade, open below and above, its lower rim at height `z`."""
    s.turned(((0.5 * w, z), (0.34 * w, z + h)))
    s.turned(((0.33 * w, z + h), (0.49 * w, z)), finish="paper")
    s.soft((0, 0, z + 0.45 * h), (0.2 * w, 0.2 * w, 0.3 * h), "paper", power=1)


def rug(s: Sculpt, w: float, d: float, h: float) -> None:
    """A flat cloth with a border."""
    s.box((0, 0, 0.45 * h), (w, d, 0.9 * h), "brown")
    s.box((0, 0, 0.55 * h), (0.9 * w, 0.88 * d, 0.9 * h))


def curtain(s: Sculpt, w: float, d: float, h: float) -> None:
    """Folds on a rod."""
    s.waves((0, 0, 0.49 * h), (0.98 * w, 0.8 * d, 0.98 * h), max(4, round(w / 0.14)))
    s.cylinder((-w / 2, 0, h - 0.015), 0.014, w, "steel", "x", sides=10)


def cushion(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, thick in its middle."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.55)
    for x in (-1, 1):
        for y in (-1, 1):
            s.soft((x * 0.42 * w, y * 0.42 * d, h / 2), (0.16 * w, 0.16 * d, 0.35 * h), power=0.6)


def vase(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A belly, a neck and a rim."""
    r = w / 2
    belly = (
        (0, 0),
        (0.55, 0),
        (0.72, 0.1),
        (0.88, 0.22),
        (0.98, 0.34),
        (1, 0.44),
        (0.94, 0.56),
        (0.76, 0.68),
    )
    neck = ((0.54, 0.77), (0.43, 0.85), (0.45, 0.92), (0.62, 1), (0.52, 1), (0.36, 0.86))
    s.turned([(x * r, z * h) for x, z in (*belly, *neck)], smooth=True, sides=24)


def slim_vase(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A tall tapering body."""
    r = w / 2
    s.turned(
        ((0, 0), (0.6 * r, 0), (r, 0.85 * h), (0.94 * r, h), (0.84 * r, h), (0.8 * r, 0.8 * h)), smooth=True
    )


def vases(s: Sculpt, w: float, d: float, h: float) -> None:
    """Slim where it is more than twice as high as wide, else bellied."""
    (slim_vase if h > 2.4 * w else vase)(s, w, d, h)


def plant(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Bent leaves from a pot."""
    r = 0.24 * w
    pot = 0.3 * h
    s.turned(((0, 0), (0.75 * r, 0), (r, pot), (0.9 * r, pot), (0.88 * r, 0.9 * pot)))
    s.turned(((0.88 * r, 0.92 * pot), (0, 0.92 * pot)), finish="soil")
    for i in range(14):
        angle, reach = i * 2.4, (0.35 + 0.15 * (i % 3) / 2) * w
        rise = h * (0.98 - 0.11 * (i % 4))
        middle = (0.5 * reach * cos(angle), 0.5 * reach * sin(angle), 0.5 * (pot + rise) + 0.1 * h)
        end = (reach * cos(angle), reach * sin(angle), rise - 0.15 * h)
        s.tube(((0, 0, 0.9 * pot), middle, end), 0.004, "leaf", sides=4)
        s.soft(middle, (0.16 * w, 0.16 * w, 0.02 * h), "leaf", power=1)
        s.soft(end, (0.2 * w, 0.2 * w, 0.03 * h), "leaf", power=1)


def clock(s: Sculpt, w: float, d: float, h: float) -> None:
    """A round dial in a ring, facing front."""
    r = w / 2
    s.turned(
        ((0, d), (r, d), (r, 0), (0.9 * r, 0), (0.9 * r, 0.3 * d)), (0, -d / 2, h / 2), axis="y", sides=28
    )
    s.box((0, -0.18 * d, h / 2), (1.24 * r, 0.004, 1.24 * r), "clock", whole=True)
    s.turned(((0.9 * r, 0.32 * d), (0, 0.32 * d)), (0, -d / 2, h / 2), "paper", "y", sides=28)


def picture_frame(s: Sculpt, w: float, d: float, h: float) -> None:
    """A picture behind four bars."""
    bar = 0.09 * min(w, h)
    for side in (-1, 1):
        s.box((side * (w - bar) / 2, 0, h / 2), (bar, d, h))
        s.box((0, 0, h / 2 + side * (h - bar) / 2), (w, d, bar))
    s.box((0, 0.2 * d, h / 2), (w - bar, 0.5 * d, h - bar), "painting", whole=True)


def mirror(s: Sculpt, w: float, d: float, h: float) -> None:
    """Glass behind four bars."""
    bar = 0.04
    for side in (-1, 1):
        s.box((side * (w - bar) / 2, 0, h / 2), (bar, d, h))
        s.box((0, 0, h / 2 + side * (h - bar) / 2), (w, d, bar))
    s.box((0, 0.2 * d, h / 2), (w - bar, 0.5 * d, h - bar), "glass")


def candle(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A candle on a dish."""
    s.turned(((0, 0), (0.5 * w, 0), (0.5 * w, 0.08 * h), (0, 0.06 * h)), finish="brass")
    s.cylinder((0, 0, 0.06 * h), 0.28 * w, 0.84 * h)
    s.cylinder((0, 0, 0.9 * h), 0.015 * w + 0.001, 0.1 * h, "dark", sides=6)


def piano(s: Sculpt, w: float, d: float, h: float) -> None:
    """Upright, its keys to the front."""
    s.box((0, 0.2 * d, h / 2), (w, 0.6 * d, h))
    s.box((0, 0, 0.3 * h), (w, 0.55 * d, 0.6 * h))
    s.box((0, -0.25 * d, 0.55 * h), (w, 0.5 * d, 0.08 * h))
    s.box((0, -0.3 * d, 0.595 * h), (0.92 * w, 0.3 * d, 0.015), "white")
    for i in range(36):
        if i % 7 not in (2, 6):
            s.box((0.92 * w * ((i + 1) / 36 - 0.5), -0.24 * d, 0.61 * h), (0.011, 0.17 * d, 0.014), "black")
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.04), -0.4 * d, 0.26 * h), (0.06, 0.08, 0.52 * h))


def guitar(s: Sculpt, w: float, d: float, h: float) -> None:
    """Stands upright, strings to the front."""
    s.soft((0, 0, 0.17 * h), (w, 0.9 * d, 0.34 * h), power=0.8)
    s.soft((0, 0, 0.36 * h), (0.74 * w, 0.9 * d, 0.26 * h), power=0.8)
    s.turned(((0, 0), (0.14 * w, 0)), (0, -0.46 * d, 0.34 * h), "black", "y")
    s.box((0, -0.3 * d, 0.65 * h), (0.055, 0.03, 0.6 * h), "brown")
    s.box((0, -0.3 * d, 0.95 * h), (0.08, 0.03, 0.1 * h), "black")


def fireplace(s: Sculpt, w: float, d: float, h: float) -> None:
    """A mantel around a dark opening with logs."""
    s.box((0, 0.3 * d, 0.45 * h), (w, 0.4 * d, 0.9 * h), "dark")
    for x in (-1.0, 1.0):
        s.box((x * 0.39 * w, 0, 0.45 * h), (0.22 * w, 0.95 * d, 0.9 * h))
    s.box((0, 0, 0.8 * h), (w, 0.95 * d, 0.2 * h))
    s.box((0, 0, 0.95 * h), (w * 1.06, d, 0.1 * h))
    for x in (-0.08, 0.06):
        s.cylinder((x - 0.15, 0, 0.07), 0.05, 0.3, "wood", "x")


def aquarium(s: Sculpt, w: float, d: float, h: float) -> None:
    """Water, sand, two plants, between dark bars."""
    s.box((0, 0, 0.04 * h), (w, d, 0.08 * h), "dark")
    s.box((0, 0, 0.96 * h), (w, d, 0.08 * h), "dark")
    s.box((0, 0, 0.5 * h), (0.97 * w, 0.96 * d, 0.84 * h))
    s.box((0, -0.005 * d, 0.15 * h), (0.975 * w, 0.97 * d, 0.14 * h), "cream")
    for i in range(6):
        s.soft(
            ((i / 5 - 0.5) * 0.8 * w, -0.46 * d, 0.35 * h), (0.05 * w, 0.05 * d, 0.35 * h), "leaf", power=1
        )
    for x, z in ((-0.2, 0.6), (0.15, 0.7), (0.3, 0.5)):
        s.soft((x * w, -0.47 * d, z * h), (0.09 * w, 0.04 * d, 0.08 * h), "orange", power=1)


def sculpture(s: Sculpt, w: float, d: float, h: float) -> None:
    """A head on a plinth, its face to the front."""
    s.box((0, 0, 0.1 * h), (0.9 * w, 0.9 * d, 0.2 * h), "dark")
    s.turned(
        ((0.3 * w, 0.2 * h), (0.46 * w, 0.36 * h), (0.2 * w, 0.48 * h), (0.18 * w, 0.6 * h)), smooth=True
    )
    s.soft((0, 0, 0.78 * h), (0.62 * w, 0.76 * d, 0.44 * h), power=0.9)
    s.soft((0, -0.4 * d, 0.76 * h), (0.12 * w, 0.16 * d, 0.12 * h), power=1)


def blinds(s: Sculpt, w: float, d: float, h: float) -> None:
    """Slats under a rail."""
    s.box((0, 0, h - 0.02), (w, d, 0.04))
    count = max(8, round(h / 0.045))
    for i in range(count):
        s.box((0, 0, (i + 0.5) * (h - 0.04) / count), (0.97 * w, 0.7 * d, 0.006))
    for x in (-0.4, 0.4):
        s.box((x * w, 0, h / 2), (0.01, 0.01, h))


RECIPES: dict[str, Recipe] = {
    "tv": Recipe(tv, "black", ((1.1, 0.22, 0.68), (0.9, 0.2, 0.58)), None),
    "speaker": Recipe(speaker, "black", ((0.2, 0.24, 0.34),), None),
    "floor lamp": Recipe(floor_lamp, "cream", ((0.42, 0.42, 1.6), (0.36, 0.36, 1.5)), None),
    "lamp": Recipe(table_lamp, "cream", ((0.28, 0.28, 0.45), (0.22, 0.22, 0.36)), None),
    "rug": Recipe(rug, "red", ((2.0, 1.4, 0.012), (1.6, 1.1, 0.012), (1.2, 0.7, 0.012)), None),
    "curtain": Recipe(curtain, "cream", ((1.0, 0.1, 2.2), (1.4, 0.1, 2.2)), None),
    "cushion": Recipe(cushion, "blue", ((0.42, 0.42, 0.14), (0.5, 0.34, 0.14)), None),
    "vase": Recipe(vases, "blue", ((0.16, 0.16, 0.28), (0.1, 0.1, 0.3), (0.2, 0.2, 0.36)), None),
    "plant": Recipe(plant, "clay", ((0.5, 0.5, 0.9), (0.3, 0.3, 0.45)), None),
    "clock": Recipe(clock, "black", ((0.3, 0.05, 0.3), (0.12, 0.05, 0.12)), None),
    "picture frame": Recipe(
        picture_frame, "black", ((0.6, 0.03, 0.45), (0.35, 0.03, 0.45), (0.9, 0.03, 0.6)), None
    ),
    "mirror": Recipe(mirror, "wood", ((0.6, 0.03, 0.8), (0.5, 0.04, 1.4)), None),
    "candle": Recipe(candle, "cream", ((0.09, 0.09, 0.14), (0.1, 0.1, 0.26)), None),
    "piano": Recipe(piano, "black", ((1.45, 0.6, 1.2),), None),
    "guitar": Recipe(guitar, "crust", ((0.38, 0.12, 1.02),), None),
    "fireplace": Recipe(fireplace, "cream", ((1.2, 0.4, 1.1),), 1.0),
    "sculpture": Recipe(sculpture, "clay", ((0.16, 0.18, 0.34),), None),
    "blinds": Recipe(blinds, "cream", ((1.0, 0.06, 1.2),), None),
    "aquarium": Recipe(aquarium, "glass", ((0.7, 0.3, 0.45),), None),
}
