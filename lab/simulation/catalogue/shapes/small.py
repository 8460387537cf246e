"""Toys, play and sport, and what is used about the house, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def remote_control(s: Sculpt, w: float, d: float, h: float) -> None:
    """Buttons up."""
    s.soft((0, 0, 0.45 * h), (w, d, 0.9 * h), power=0.2)
    s.box((0, 0.05 * d, 0.9 * h), (0.7 * w, 0.62 * d, 0.2 * h), "keys")
    s.soft((0, 0.43 * d, 0.92 * h), (0.22 * w, 0.06 * d, 0.2 * h), "red", power=1)


def game_console(s: Sculpt, w: float, d: float, h: float) -> None:
    """A slot to the front."""
    s.box((0, 0, 0.25 * h), (0.96 * w, d, 0.44 * h))
    s.box((0, 0, 0.76 * h), (w, d, 0.48 * h))
    s.box((0, -d / 2 - 0.001, 0.5 * h), (0.9 * w, 0.004, 0.05 * h), "blue")


def game_controller(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two grips to the front, sticks up."""
    s.soft((0, 0.15 * d, 0.45 * h), (0.9 * w, 0.6 * d, 0.6 * h), power=0.5)
    for x in (-1.0, 1.0):
        s.soft((x * 0.36 * w, -0.12 * d, 0.42 * h), (0.28 * w, 0.76 * d, 0.7 * h), power=0.8)
        s.cylinder((x * 0.14 * w, 0.02 * d, 0.7 * h), 0.07 * w, 0.3 * h, "gray", sides=12)
    for x, y, finish in ((0.32, 0.3, "green"), (0.38, 0.2, "red"), (0.26, 0.2, "blue"), (0.32, 0.1, "pink")):
        s.cylinder((x * w, y * d, 0.72 * h), 0.03 * w, 0.12 * h, finish, sides=10)


def radio(s: Sculpt, w: float, d: float, h: float) -> None:
    """A speaker, a dial and an aerial."""
    s.soft((0, 0, 0.38 * h), (w, d, 0.76 * h), power=0.2)
    s.cylinder((-0.22 * w, -d / 2 - 0.002, 0.38 * h), 0.25 * h, 0.006, "dark", "y")
    s.box((0.22 * w, -d / 2, 0.52 * h), (0.4 * w, 0.008, 0.16 * h), "cream")
    s.cylinder((0.22 * w, -d / 2 - 0.012, 0.24 * h), 0.08 * h, 0.016, "steel", "y")
    s.tube(((-0.4 * w, 0, 0.72 * h), (0.1 * w, 0, 0.99 * h)), 0.004, "steel")


def umbrella(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Folded, stands on its tip."""
    s.turned(((0, 0), (0.08 * w, 0.08 * h), (0.5 * w, 0.62 * h), (0.1 * w, 0.74 * h)), smooth=False)
    s.tube([(x * w, 0, z * h) for x, z in ((0, 0.7), (0, 0.93), (0.2, 0.99), (0.42, 0.94))], 0.014, "wood")


def ladder(s: Sculpt, w: float, d: float, h: float) -> None:
    """A step ladder, its steps to the front."""
    for x in (-1, 1):
        s.tube(((x * 0.47 * w, -0.47 * d, 0), (x * 0.4 * w, 0, h)), 0.018)
        s.tube(((x * 0.47 * w, 0.47 * d, 0), (x * 0.4 * w, 0.05 * d, 0.96 * h)), 0.014)
    for i in range(4):
        t = (i + 1) / 4.4
        s.box((0, -0.47 * d * (1 - t), t * h), (0.86 * w, 0.1, 0.03), "gray")


def broom(s: Sculpt, w: float, d: float, h: float) -> None:
    """Stands on its bristles."""
    s.box((0, 0, 0.03 * h), (w, d, 0.06 * h), "cream")
    s.box((0, 0, 0.075 * h), (w, 0.7 * d, 0.03 * h))
    s.cylinder((0, 0, 0.08 * h), 0.013, 0.92 * h, "wood", sides=10)


def vacuum_cleaner(s: Sculpt, w: float, d: float, h: float) -> None:
    """A body on wheels, its hose to a floor head in front."""
    s.soft((0, 0.25 * d, 0.22 * h), (0.9 * w, 0.48 * d, 0.44 * h), power=0.6)
    for x in (-1, 1):
        s.cylinder((x * 0.44 * w - 0.02, 0.34 * d, 0.14 * h), 0.14 * h, 0.04, "black", "x")
    path = ((0, 0.1, 0.36), (0.2, 0.0, 0.8), (0.1, -0.15, 0.95), (0, -0.3, 0.5), (0, -0.44, 0.05))
    s.tube([(x * w, y * d, z * h) for x, y, z in path], 0.018, "dark")
    s.box((0, -0.46 * d, 0.04 * h), (w, 0.08 * d, 0.08 * h), "dark")


def ironing_board(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its point on the left, on crossed legs."""
    s.soft((0, 0, 0.985 * h), (w, d, 0.04 * h), power=0.4)
    for y in (-1, 1):
        s.tube(((-0.35 * w, y * 0.4 * d, 0), (0.3 * w, y * 0.2 * d, 0.96 * h)), 0.012, "steel")
        s.tube(((0.35 * w, y * 0.4 * d, 0), (-0.3 * w, y * 0.2 * d, 0.96 * h)), 0.012, "steel")


def drying_rack(s: Sculpt, w: float, d: float, h: float) -> None:
    """Bars on two frames."""
    for x in (-1, 1):
        s.tube(((x * 0.49 * w, -0.45 * d, 0), (x * 0.49 * w, 0.3 * d, h)), 0.01)
        s.tube(((x * 0.49 * w, 0.45 * d, 0), (x * 0.49 * w, -0.3 * d, h)), 0.01)
    for i in range(9):
        s.cylinder((-w / 2, (i / 8 - 0.5) * 0.6 * d, 0.96 * h), 0.004, w, axis="x", sides=6)
    s.box((0.1 * w, -0.1 * d, 0.72 * h), (0.4 * w, 0.01, 0.5 * h), "blue")


def dumbbell(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A bar between two discs."""
    for x in (-1, 1):
        s.cylinder((x * 0.36 * w - 0.12 * w, 0, h / 2), h / 2, 0.24 * w, axis="x", sides=16)
    s.cylinder((-0.3 * w, 0, h / 2), 0.14 * h, 0.6 * w, "steel", "x")


def yoga_mat(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Rolled up."""
    s.cylinder((-w / 2, 0, h / 2), h / 2, w, axis="x", sides=24)
    s.cylinder((-w / 2 - 0.001, 0, h / 2), 0.15 * h, w + 0.002, "dark", "x")


def exercise_bike(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its handlebar to the front."""
    for y in (-0.42, 0.42):
        s.box((0, y * d, 0.02), (w, 0.06, 0.04), "dark")
    s.tube(((0, -0.42 * d, 0.04), (0, 0.0, 0.25 * h), (0, 0.42 * d, 0.04)), 0.03)
    s.cylinder((-0.04, -0.15 * d, 0.3 * h), 0.2 * d, 0.08, "dark", "x", sides=28)
    s.tube(((0, -0.1 * d, 0.25 * h), (0, -0.3 * d, 0.95 * h)), 0.025)
    s.tube(((-0.4 * w, -0.36 * d, h), (0, -0.3 * d, 0.94 * h), (0.4 * w, -0.36 * d, h)), 0.014, "dark")
    s.tube(((0, 0.1 * d, 0.15 * h), (0, 0.25 * d, 0.7 * h)), 0.025)
    s.soft((0, 0.25 * d, 0.73 * h), (0.36 * w, 0.28 * d, 0.08 * h), "black", power=0.6)


def treadmill(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its belt runs to the front, the panel there."""
    s.box((0, 0.03 * d, 0.07 * h), (w, 0.94 * d, 0.14 * h))
    s.box((0, 0.05 * d, 0.15 * h), (0.7 * w, 0.86 * d, 0.02 * h), "black")
    for x in (-1, 1):
        s.tube(((x * 0.46 * w, -0.36 * d, 0.1 * h), (x * 0.46 * w, -0.44 * d, 0.9 * h)), 0.03, "dark")
        s.tube(((x * 0.46 * w, -0.42 * d, 0.78 * h), (x * 0.46 * w, -0.1 * d, 0.72 * h)), 0.02, "dark")
    s.box((0, -0.44 * d, 0.93 * h), (w, 0.08 * d, 0.14 * h), "dark")
    s.box((0, -0.395 * d, 0.95 * h), (0.4 * w, 0.01, 0.08 * h), "glass")


def bicycle(s: Sculpt, w: float, d: float, h: float) -> None:
    """Its front wheel to the front."""
    from math import cos, pi, sin

    r = 0.34 * h
    for y in (-0.5 * d + r + 0.02, 0.5 * d - r - 0.02):
        ring = [(0.0, y + r * cos(a * pi / 10), r + 0.02 + r * sin(a * pi / 10)) for a in range(21)]
        s.tube(ring, 0.018, "black")
        for a in range(0, 10, 2):
            dy, dz = r * cos(a * pi / 10), r * sin(a * pi / 10)
            s.tube(((0, y - dy, r + 0.02 - dz), (0, y + dy, r + 0.02 + dz)), 0.003, "steel", sides=4)
    back, front = 0.5 * d - r - 0.02, -0.5 * d + r + 0.02
    frame = (
        (back, r),
        (0.05 * d, 0.3 * h),
        (0.12 * d, 0.8 * h),
        (front + 0.1 * d, 0.78 * h),
        (0.05 * d, 0.3 * h),
    )
    s.tube([(0, y, z) for y, z in frame], 0.016)
    s.tube(((0, front, r), (0, front + 0.12 * d, 0.95 * h)), 0.016)
    s.tube(
        (
            (-0.5 * w, front + 0.2 * d, 0.97 * h),
            (0, front + 0.12 * d, 0.95 * h),
            (0.5 * w, front + 0.2 * d, 0.97 * h),
        ),
        0.013,
        "dark",
    )
    s.soft((0, 0.13 * d, 0.86 * h), (0.3 * w, 0.16 * d, 0.07 * h), "black", power=0.6)


def toolbox(s: Sculpt, w: float, d: float, h: float) -> None:
    """A lid and a handle."""
    s.box((0, 0, 0.36 * h), (w, d, 0.72 * h))
    s.box((0, 0, 0.76 * h), (0.96 * w, 0.9 * d, 0.12 * h), "dark")
    s.tube(
        [(x * w, 0, z * h) for x, z in ((-0.25, 0.8), (-0.22, 0.97), (0.22, 0.97), (0.25, 0.8))],
        0.012,
        "dark",
    )
    for x in (-0.3, 0.3):
        s.box((x * w, -d / 2 - 0.004, 0.62 * h), (0.04, 0.01, 0.06), "steel")


def hammer(s: Sculpt, w: float, d: float, h: float) -> None:
    """Lies, its head behind."""
    s.cylinder((-w / 2, 0.42 * d, h / 2), h / 2, w, "steel", "x", sides=12)
    s.soft((0, -0.05 * d, h / 2), (0.24 * w, 0.9 * d, 0.8 * h), power=0.4)


def drill(s: Sculpt, w: float, d: float, h: float) -> None:
    """Stands on its battery, its bit to the front."""
    s.soft((0, 0.1 * d, 0.84 * h), (w, 0.66 * d, 0.32 * h), power=0.5)
    s.soft((0, 0.22 * d, 0.45 * h), (0.6 * w, 0.22 * d, 0.7 * h), "dark", power=0.5)
    s.box((0, 0.15 * d, 0.07 * h), (w, 0.45 * d, 0.14 * h), "dark")
    s.cylinder((0, -0.34 * d, 0.84 * h), 0.22 * w, 0.14 * d, "black", "y")
    s.cylinder((0, -0.5 * d, 0.84 * h), 0.06 * w, 0.18 * d, "steel", "y", sides=8)


def tissue_box(s: Sculpt, w: float, d: float, h: float) -> None:
    """A tissue sticks out above."""
    s.box((0, 0, 0.37 * h), (w, d, 0.74 * h))
    s.soft((0, 0, 0.745 * h), (0.5 * w, 0.5 * d, 0.02 * h), "dark", power=1)
    s.soft((0, 0, 0.85 * h), (0.22 * w, 0.3 * d, 0.3 * h), "paper", power=1.6)


RECIPES: dict[str, Recipe] = {
    "remote control": Recipe(remote_control, "black", ((0.05, 0.18, 0.02), (0.045, 0.15, 0.018)), None),
    "game console": Recipe(game_console, "black", ((0.3, 0.28, 0.055),), None),
    "game controller": Recipe(game_controller, "black", ((0.16, 0.11, 0.06),), None),
    "tissue box": Recipe(tissue_box, "blue", ((0.23, 0.12, 0.12),), None),
    "radio": Recipe(radio, "red", ((0.28, 0.09, 0.22),), None),
    "umbrella": Recipe(umbrella, "blue", ((0.16, 0.16, 0.85),), None),
    "ladder": Recipe(ladder, "steel", ((0.5, 0.8, 1.2),), None),
    "broom": Recipe(broom, "red", ((0.32, 0.07, 1.4),), None),
    "vacuum cleaner": Recipe(vacuum_cleaner, "red", ((0.3, 0.8, 0.5),), None),
    "ironing board": Recipe(ironing_board, "striped", ((1.2, 0.38, 0.9),), 1.0),
    "drying rack": Recipe(drying_rack, "white", ((1.1, 0.55, 0.95),), None),
    "dumbbell": Recipe(dumbbell, "black", ((0.28, 0.13, 0.13),), None),
    "yoga mat": Recipe(yoga_mat, "purple", ((0.62, 0.13, 0.13),), None),
    "exercise bike": Recipe(exercise_bike, "white", ((0.5, 1.05, 1.25),), None),
    "treadmill": Recipe(treadmill, "gray", ((0.8, 1.7, 1.35),), None),
    "bicycle": Recipe(bicycle, "red", ((0.55, 1.65, 1.0),), None),
    "toolbox": Recipe(toolbox, "red", ((0.46, 0.22, 0.24),), None),
    "hammer": Recipe(hammer, "wood", ((0.12, 0.31, 0.03),), None),
    "drill": Recipe(drill, "yellow", ((0.08, 0.25, 0.22),), None),
}
