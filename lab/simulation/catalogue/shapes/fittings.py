"""What is fixed to walls and ceilings, and what lies before doors, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def wall_plug(s: Sculpt, w: float, d: float, h: float) -> None:
    """A socket of two holes in a round recess."""
    s.box((0, 0.25 * d, h / 2), (w, 0.5 * d, h))
    s.cylinder((0, -0.4 * d, h / 2), 0.38 * h, 0.7 * d, "cream", "y", sides=24)
    for x in (-0.12, 0.12):
        s.cylinder((x * h, -0.5 * d, h / 2), 0.06 * h, 0.2 * d, "black", "y", sides=10)


def switch(s: Sculpt, w: float, d: float, h: float) -> None:
    """One rocker in a frame."""
    s.box((0, 0.2 * d, h / 2), (w, 0.6 * d, h))
    s.box((0, -0.2 * d, h / 2), (0.62 * w, 0.5 * d, 0.62 * h), "cream")
    s.box((0, -0.4 * d, 0.62 * h), (0.6 * w, 0.2 * d, 0.34 * h), "cream")


def smoke_detector(s: Sculpt, w: float, d: float, h: float) -> None:
    """A round lid on the wall with a lamp."""
    s.turned(
        ((0, 0), (0.36 * w, 0.0), (0.46 * w, 0.35 * d), (0.5 * w, d)), (0, -d / 2, h / 2), axis="y", sides=28
    )
    s.turned(((0.38 * w, 0.2 * d), (0.47 * w, 0.45 * d)), (0, -d / 2 - 0.002, h / 2), "gray", "y", sides=28)
    s.cylinder((0.18 * w, -d / 2 - 0.002, h / 2), 0.04 * w, 0.004, "red", "y", sides=10)


def radiator(s: Sculpt, w: float, d: float, h: float) -> None:
    """Ribs 6 cm wide between two pipes."""
    count = max(4, round(w / 0.06))
    for i in range(count):
        x = (i + 0.5) * w / count - w / 2
        s.soft((x, 0, h / 2), (0.8 * w / count, d, h), power=0.3)
    for z in (0.12, 0.88):
        s.cylinder((-w / 2, 0, z * h), 0.25 * d, w, axis="x", sides=10)


def air_conditioner(s: Sculpt, w: float, d: float, h: float) -> None:
    """A shell with a slit below."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.2)
    s.box((0, -0.42 * d, 0.12 * h), (0.9 * w, 0.16 * d, 0.06 * h), "dark")
    s.box((0.4 * w, -0.5 * d, 0.5 * h), (0.06 * w, 0.01, 0.06 * h), "green")


def wall_lamp(s: Sculpt, w: float, d: float, h: float) -> None:
    """A shade on an arm."""
    s.cylinder((0, 0.4 * d, 0.3 * h), 0.2 * w, 0.1 * d, "brass", "y")
    s.tube(((0, 0.4 * d, 0.3 * h), (0, -0.02 * d, 0.25 * h), (0, -0.1 * d, 0.45 * h)), 0.01, "brass")
    s.turned(((0.4 * w, 0.4 * h), (0.26 * w, h)), (0, -0.1 * d, 0))
    s.turned(((0.25 * w, h), (0.39 * w, 0.4 * h)), (0, -0.1 * d, 0), "paper")


def ceiling_lamp(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A shade on a cord."""
    s.cylinder((0, 0, 0.96 * h), 0.15 * w, 0.04 * h, "steel")
    s.cylinder((0, 0, 0.4 * h), 0.006, 0.58 * h, "black", sides=6)
    s.turned(((0.5 * w, 0), (0.42 * w, 0.2 * h), (0.1 * w, 0.45 * h), (0, 0.46 * h)), smooth=True)
    s.soft((0, 0, 0.08 * h), (0.3 * w, 0.3 * w, 0.2 * h), "paper", power=1)


def intercom(s: Sculpt, w: float, d: float, h: float) -> None:
    """A receiver on the left, a screen on the right."""
    s.box((0, 0.2 * d, h / 2), (w, 0.6 * d, h))
    s.soft((-0.28 * w, -0.25 * d, h / 2), (0.3 * w, 0.5 * d, 0.95 * h), power=0.3)
    s.box((0.2 * w, -0.12 * d, 0.68 * h), (0.42 * w, 0.06 * d, 0.36 * h), "screen")
    s.box((0.2 * w, -0.12 * d, 0.25 * h), (0.3 * w, 0.06 * d, 0.12 * h), "gray")


def security_camera(s: Sculpt, w: float, d: float, h: float) -> None:
    """A barrel on an arm, its lens to the front."""
    s.cylinder((0, 0.44 * d, 0.5 * h), 0.4 * w, 0.06 * d, axis="y")
    s.tube(((0, 0.46 * d, 0.5 * h), (0, 0.2 * d, 0.45 * h), (0, 0.1 * d, 0.6 * h)), 0.012)
    s.cylinder((0, -0.45 * d, 0.68 * h), 0.32 * h, 0.6 * d, axis="y")
    s.cylinder((0, -0.5 * d, 0.68 * h), 0.22 * h, 0.06 * d, "black", "y")


def coat_rack(s: Sculpt, w: float, d: float, h: float) -> None:
    """Hooks on a board."""
    s.box((0, 0.35 * d, h / 2), (w, 0.3 * d, h))
    for i in range(5):
        x = (i - 2) * w / 5.4
        s.tube(
            [(x, y * d, z * h) for y, z in ((0.3, 0.5), (-0.2, 0.4), (-0.45, 0.6), (-0.45, 0.9))],
            0.006,
            "steel",
        )


def fire_extinguisher(s: Sculpt, w: float, d: float, h: float) -> None:
    """A red bottle with a hose."""
    r = 0.42 * min(w, d)
    s.turned(((0, 0), (r, 0), (r, 0.7 * h), (0.7 * r, 0.8 * h), (0.2 * r, 0.84 * h), (0.2 * r, 0.9 * h)))
    s.box((0, 0, 0.93 * h), (0.2 * w, 0.6 * d, 0.1 * h), "black")
    s.tube(
        [(x * w, 0, z * h) for x, z in ((0.08, 0.9), (0.42, 0.8), (0.48, 0.5), (0.42, 0.25))], 0.012, "black"
    )
    s.turned(((1.02 * r, 0.3 * h), (1.02 * r, 0.5 * h)), finish="paper")


def water_heater(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A boiler with two pipes."""
    s.turned(
        ((0, 0.06 * h), (0.4 * w, 0.06 * h), (0.5 * w, 0.12 * h), (0.5 * w, 0.92 * h), (0.4 * w, h), (0, h)),
        sides=28,
    )
    for x in (-0.15, 0.15):
        s.cylinder((x * w, 0, 0), 0.012, 0.1 * h, "steel", sides=10)
    s.cylinder((0, -0.5 * w - 0.004, 0.2 * h), 0.04, 0.03, "dark", "y", sides=14)


def doormat(s: Sculpt, w: float, d: float, h: float) -> None:
    """Coarse, with a border."""
    s.box((0, 0, 0.45 * h), (w, d, 0.9 * h), "dark")
    s.box((0, 0, 0.55 * h), (0.92 * w, 0.88 * d, 0.9 * h))


RECIPES: dict[str, Recipe] = {
    "wall plug": Recipe(wall_plug, "white", ((0.085, 0.012, 0.085), (0.155, 0.012, 0.085)), None),
    "switch": Recipe(switch, "white", ((0.085, 0.014, 0.085),), None),
    "smoke detector": Recipe(smoke_detector, "white", ((0.11, 0.035, 0.11),), None),
    "radiator": Recipe(radiator, "white", ((0.9, 0.1, 0.6), (1.2, 0.1, 0.6)), None),
    "air conditioner": Recipe(air_conditioner, "white", ((0.88, 0.2, 0.28),), None),
    "wall lamp": Recipe(wall_lamp, "cream", ((0.2, 0.22, 0.28),), None),
    "ceiling lamp": Recipe(ceiling_lamp, "cream", ((0.4, 0.4, 0.5),), None),
    "intercom": Recipe(intercom, "white", ((0.18, 0.05, 0.22),), None),
    "security camera": Recipe(security_camera, "white", ((0.1, 0.24, 0.12),), None),
    "coat rack": Recipe(coat_rack, "wood", ((0.6, 0.09, 0.12),), None),
    "fire extinguisher": Recipe(fire_extinguisher, "red", ((0.18, 0.16, 0.5),), None),
    "water heater": Recipe(water_heater, "white", ((0.45, 0.46, 0.8),), None),
    "doormat": Recipe(doormat, "woven", ((0.6, 0.4, 0.015),), None),
}
