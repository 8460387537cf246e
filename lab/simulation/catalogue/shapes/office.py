"""What stands on and around desks, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def laptop(s: Sculpt, w: float, d: float, h: float) -> None:
    """Open, its screen leaning back."""
    s.box((0, 0, 0.035 * h), (w, d, 0.07 * h))
    s.box((0, 0.1 * d, 0.072 * h), (0.86 * w, 0.5 * d, 0.012 * h), "keys")
    s.box((0, -0.33 * d, 0.072 * h), (0.3 * w, 0.22 * d, 0.01 * h), "dark")
    s.box((0, 0.48 * d, 0.53 * h), (w, 0.03 * d, 0.94 * h))
    s.box((0, 0.463 * d, 0.53 * h), (0.93 * w, 0.004, 0.84 * h), "blue")


def monitor(s: Sculpt, w: float, d: float, h: float) -> None:
    """A screen on a foot."""
    s.cylinder((0, 0, 0), d / 2, 0.02)
    s.box((0, 0.06, 0.2 * h), (0.06, 0.03, 0.4 * h))
    s.box((0, 0.02, 0.62 * h), (w, 0.05, 0.76 * h))
    s.box((0, -0.007, 0.62 * h), (0.95 * w, 0.004, 0.7 * h), "screen")


def computer(s: Sculpt, w: float, d: float, h: float) -> None:
    """A tower."""
    s.box((0, 0, h / 2), (w, d, h))
    for z in (0.88, 0.78):
        s.box((0, -d / 2 - 0.001, z * h), (0.8 * w, 0.004, 0.06 * h), "gray")
    s.cylinder((0, -d / 2 - 0.005, 0.6 * h), 0.012, 0.006, "steel", "y", sides=12)


def keyboard(s: Sculpt, w: float, d: float, h: float) -> None:
    """A slab of keys."""
    s.box((0, 0, 0.35 * h), (w, d, 0.7 * h))
    s.box((0, 0, 0.8 * h), (0.96 * w, 0.85 * d, 0.4 * h), "keys")


def mouse(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its buttons to the front."""
    s.soft((0, 0, 0.45 * h), (w, d, 0.9 * h), power=0.8)
    s.box((0, -0.25 * d, 0.85 * h), (0.1 * w, 0.2 * d, 0.3 * h), "gray")


def tablet(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies, its screen up."""
    s.soft((0, 0, 0.45 * h), (w, d, 0.9 * h), power=0.15)
    s.box((0, 0, 0.93 * h), (0.88 * w, 0.86 * d, 0.14 * h), "screen")


def telephone(s: Sculpt, w: float, d: float, h: float) -> None:
    """A desk phone, its receiver on the left."""
    s.box((0, 0, 0.3 * h), (w, d, 0.6 * h))
    s.box((0.18 * w, -0.12 * d, 0.62 * h), (0.5 * w, 0.6 * d, 0.06 * h), "keys", whole=True)
    s.box((0.18 * w, 0.33 * d, 0.65 * h), (0.5 * w, 0.2 * d, 0.12 * h), "glass")
    s.soft((-0.32 * w, 0, 0.78 * h), (0.26 * w, 0.98 * d, 0.3 * h), power=0.4)


def printer(s: Sculpt, w: float, d: float, h: float) -> None:
    """Paper in a tray to the front."""
    s.soft((0, 0.08 * d, 0.5 * h), (w, 0.84 * d, h), power=0.15)
    s.box((0, -0.34 * d, 0.2 * h), (0.6 * w, 0.3 * d, 0.05 * h), "dark")
    s.box((0, -0.36 * d, 0.25 * h), (0.5 * w, 0.26 * d, 0.03 * h), "paper")
    s.box((0, -0.335 * d, 0.4 * h), (0.66 * w, 0.02 * d, 0.22 * h), "black")
    s.box((0.3 * w, -0.34 * d, 0.8 * h), (0.26 * w, 0.02 * d, 0.2 * h), "screen")


def headphones(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lie on their cups."""
    for x in (-1, 1):
        s.soft((x * 0.4 * w, -0.2 * d, 0.5 * h), (0.2 * w, 0.5 * d, h), power=0.6)
    arc = ((-0.42, -0.1), (-0.4, 0.25), (-0.2, 0.44), (0, 0.48), (0.2, 0.44), (0.4, 0.25), (0.42, -0.1))
    s.tube([(x * w, y * d, 0.5 * h) for x, y in arc], 0.016)


def camera(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its lens to the front."""
    s.soft((0, 0.2 * d, 0.42 * h), (w, 0.55 * d, 0.84 * h), power=0.25)
    s.box((0, 0.2 * d, 0.9 * h), (0.3 * w, 0.4 * d, 0.2 * h))
    s.turned(((0, 0), (0.24 * w, 0), (0.24 * w, 0.6 * d)), (0, -d / 2, 0.42 * h), "dark", "y")
    s.turned(((0, -0.002), (0.18 * w, -0.002)), (0, -d / 2, 0.42 * h), "glass", "y")


def desk_lamp(s: Sculpt, w: float, d: float, h: float) -> None:
    """A jointed arm, its head to the front."""
    s.cylinder((0, 0.25 * d, 0), 0.4 * w, 0.02)
    s.tube(
        ((0, 0.25 * d, 0.02), (0, 0.42 * d, 0.55 * h), (0, 0.0, 0.94 * h), (0, -0.22 * d, 0.88 * h)), 0.011
    )
    s.turned(((0.5 * w, 0), (0.2 * w, 0.2 * h), (0, 0.22 * h)), (0, -0.32 * d, 0.76 * h))
    s.soft((0, -0.32 * d, 0.79 * h), (0.4 * w, 0.4 * w, 0.08 * h), "paper", power=1)


def whiteboard(s: Sculpt, w: float, d: float, h: float) -> None:
    """Hangs on the wall, a ledge below."""
    s.box((0, 0.2 * d, h / 2), (w, 0.3 * d, h), "steel")
    s.box((0, 0.0, h / 2), (0.96 * w, 0.3 * d, 0.94 * h))
    s.box((0, -0.3 * d, 0.03 * h), (0.6 * w, 0.4 * d, 0.03 * h), "steel")
    s.box((0.1 * w, -0.3 * d, 0.06 * h), (0.12, 0.02, 0.02), "red")


def book(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies flat, its back on the left."""
    s.box((0.02 * w, 0, h / 2), (0.94 * w, 0.96 * d, 0.76 * h), "paper")
    for z in (0.06, 0.94):
        s.box((0, 0, z * h), (w, d, 0.12 * h))
    s.box((-0.49 * w, 0, h / 2), (0.02 * w, d, h))
    s.box((0.05 * w, 0.15 * d, 1.001 * h), (0.5 * w, 0.12 * d, 0.004 * h), "cream")


def newspaper(s: Sculpt, w: float, d: float, h: float) -> None:
    """Folded."""
    s.soft((0, 0, h / 2), (w, d, h), power=0.15)
    s.box((0, 0.35 * d, 0.98 * h), (0.8 * w, 0.12 * d, 0.05 * h), "black")
    for i in range(6):
        s.box((-0.2 * w, (0.2 - 0.1 * i) * d, 0.98 * h), (0.36 * w, 0.04 * d, 0.05 * h), "gray")
        s.box((0.22 * w, (0.2 - 0.1 * i) * d, 0.98 * h), (0.36 * w, 0.04 * d, 0.05 * h), "gray")


def scissors(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lie half open, blades to the front."""
    for x in (-1, 1):
        s.tube(
            ((x * 0.2 * w, -0.48 * d, h / 2), (0, 0, h / 2), (-x * 0.25 * w, 0.2 * d, h / 2)),
            0.25 * h,
            "steel",
        )
        ring = ((0.0, 0.2), (0.22, 0.3), (0.2, 0.45), (0.0, 0.48), (-0.16, 0.42), (-0.12, 0.28), (0.0, 0.2))
        s.tube([(-x * (0.25 + k) * w, y * d, h / 2) for k, y in ring], 0.4 * h)


def stapler(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its mouth to the front."""
    s.box((0, 0, 0.1 * h), (w, d, 0.2 * h), "dark")
    s.soft((0, 0.03 * d, 0.7 * h), (0.9 * w, 0.94 * d, 0.6 * h), power=0.3)
    s.box((0, 0.4 * d, 0.4 * h), (0.7 * w, 0.16 * d, 0.6 * h), "steel")


def pen_holder(s: Sculpt, w: float, d: float, h: float) -> None:
    """Four pens in a beaker."""
    s.turned(((0, 0), (0.45 * w, 0), (0.45 * w, 0.6 * h), (0.4 * w, 0.6 * h), (0.4 * w, 0.04 * h)))
    for x, y, finish in (
        (0.25, 0.1, "red"),
        (-0.25, 0.1, "blue"),
        (0.0, -0.25, "black"),
        (0.05, 0.25, "yellow"),
    ):
        s.tube(((0, 0, 0.05 * h), (x * w * 1.4, y * d * 1.4, 0.98 * h)), 0.006, finish)


def globe(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A ball on a foot."""
    s.turned(
        ((0, 0), (0.3 * w, 0), (0.28 * w, 0.03 * h), (0.03 * w, 0.07 * h), (0.03 * w, 0.2 * h)), finish="wood"
    )
    s.soft((0, 0, 0.57 * h), (0.92 * w, 0.92 * w, 0.8 * h), power=1)
    for x, y, z in (
        (0.2, -0.36, 0.7),
        (-0.28, -0.3, 0.55),
        (0.1, 0.4, 0.6),
        (-0.1, -0.4, 0.4),
        (0.4, 0.1, 0.5),
    ):
        s.soft((x * w, y * w, z * h), (0.26 * w, 0.2 * w, 0.22 * h), "leaf", power=1)


RECIPES: dict[str, Recipe] = {
    "laptop": Recipe(laptop, "gray", ((0.34, 0.25, 0.24),), None),
    "monitor": Recipe(monitor, "black", ((0.54, 0.2, 0.42),), None),
    "computer": Recipe(computer, "dark", ((0.2, 0.42, 0.42),), 1.0),
    "keyboard": Recipe(keyboard, "dark", ((0.44, 0.14, 0.025),), None),
    "mouse": Recipe(mouse, "dark", ((0.062, 0.11, 0.036),), None),
    "tablet": Recipe(tablet, "dark", ((0.18, 0.25, 0.01),), None),
    "cell phone": Recipe(tablet, "dark", ((0.072, 0.148, 0.01),), None),
    "telephone": Recipe(telephone, "dark", ((0.2, 0.2, 0.09),), None),
    "printer": Recipe(printer, "white", ((0.44, 0.4, 0.2),), None),
    "headphones": Recipe(headphones, "black", ((0.18, 0.2, 0.07),), None),
    "camera": Recipe(camera, "black", ((0.13, 0.12, 0.1),), None),
    "desk lamp": Recipe(desk_lamp, "white", ((0.17, 0.4, 0.45),), None),
    "whiteboard": Recipe(whiteboard, "white", ((1.2, 0.06, 0.9),), None),
    "book": Recipe(book, "red", ((0.16, 0.23, 0.03), (0.13, 0.2, 0.022), (0.21, 0.28, 0.025)), 1.0),
    "newspaper": Recipe(newspaper, "paper", ((0.3, 0.22, 0.015),), None),
    "scissors": Recipe(scissors, "red", ((0.08, 0.19, 0.012),), None),
    "stapler": Recipe(stapler, "red", ((0.04, 0.14, 0.05),), None),
    "pen holder": Recipe(pen_holder, "black", ((0.09, 0.09, 0.18),), None),
    "globe": Recipe(globe, "blue", ((0.26, 0.26, 0.34),), None),
}
