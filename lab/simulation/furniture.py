"""What stands in the simulated home: each piece as a few solids, on the floor or on another piece."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from lab.simulation.solids import Finish, Shape, Solid

Color = tuple[int, int, int]

COLORS: dict[str, Color] = {
    "white": (244, 243, 240),
    "red": (205, 38, 36),
    "green": (52, 140, 70),
    "blue": (48, 84, 168),
    "yellow": (228, 188, 52),
    "orange": (228, 120, 40),
    "brown": (134, 88, 52),
    "black": (34, 34, 38),
    "gray": (150, 152, 156),
}


@dataclass(slots=True)
class Piece:
    """One thing being put together at `(x, y, z)`, turned by `yaw` about z: its front faces its own -y.

    Positions given to `box` and `cylinder` are its own: x right and y back seen from the front, z up from its
    foot.
    """

    object_id: int
    color: Color
    at: tuple[float, float, float]
    yaw: float = 0.0
    solids: list[Solid] = field(default_factory=list)

    def box(
        self,
        center: tuple[float, float, float],
        size: tuple[float, float, float],
        color: Color | None = None,
        finish: Finish = Finish.PLAIN,
    ) -> None:
        """Adds a box of full `size` (metres) around `center`."""
        half = (size[0] / 2, size[1] / 2, size[2] / 2)
        self._add(Shape.BOX, center, half, color, finish)

    def cylinder(
        self, center: tuple[float, float, float], radius: float, height: float, color: Color | None = None
    ) -> None:
        """Adds an upright cylinder around `center`."""
        self._add(Shape.CYLINDER, center, (radius, radius, height / 2), color, Finish.PLAIN)

    def _add(
        self,
        shape: Shape,
        center: tuple[float, float, float],
        half: tuple[float, float, float],
        color: Color | None,
        finish: Finish,
    ) -> None:
        c, s = float(np.cos(self.yaw)), float(np.sin(self.yaw))
        x, y, z = center
        world = (self.at[0] + c * x - s * y, self.at[1] + s * x + c * y, self.at[2] + z)
        yaw = self.yaw if shape is Shape.BOX else 0.0
        self.solids.append(Solid(shape, world, half, yaw, self.object_id, color or self.color, finish))


def table(piece: Piece) -> None:
    """1.5 x 0.85 m, 0.74 m high."""
    piece.box((0, 0, 0.72), (1.5, 0.85, 0.04), finish=Finish.WOOD)
    for x in (-0.68, 0.68):
        for y in (-0.36, 0.36):
            piece.box((x, y, 0.35), (0.06, 0.06, 0.70))


def chair(piece: Piece) -> None:
    """Seat at 0.45 m, back to 0.9 m."""
    piece.box((0, 0, 0.435), (0.42, 0.42, 0.03), finish=Finish.WOOD)
    piece.box((0, 0.195, 0.73), (0.42, 0.03, 0.34), finish=Finish.WOOD)
    for x in (-0.185, 0.185):
        piece.box((x, -0.185, 0.21), (0.04, 0.04, 0.42))
        piece.box((x, 0.19, 0.28), (0.04, 0.04, 0.56))


def sofa(piece: Piece) -> None:
    """2.0 m wide, seat at 0.42 m."""
    piece.box((0, 0, 0.21), (2.0, 0.88, 0.42), finish=Finish.FABRIC)
    piece.box((0, 0.34, 0.60), (2.0, 0.20, 0.36), finish=Finish.FABRIC)
    for x in (-0.9, 0.9):
        piece.box((x, -0.05, 0.51), (0.2, 0.78, 0.18), finish=Finish.FABRIC)


def tv_stand(piece: Piece) -> None:
    """1.5 m wide, 0.45 m high."""
    piece.box((0, 0, 0.225), (1.5, 0.42, 0.45), finish=Finish.WOOD)


def tv(piece: Piece) -> None:
    """A 1.15 m screen on a foot."""
    piece.box((0, 0, 0.01), (0.5, 0.22, 0.02))
    piece.box((0, 0.02, 0.06), (0.08, 0.05, 0.10))
    piece.box((0, 0, 0.43), (1.15, 0.05, 0.66))


def bed(piece: Piece) -> None:
    """1.5 x 2.0 m, foot to the front, headboard, two pillows, a blanket in the bed's colour."""
    white = COLORS["white"]
    piece.box((0, 0, 0.14), (1.5, 2.0, 0.28), COLORS["brown"], Finish.WOOD)
    piece.box((0, 0, 0.37), (1.46, 1.96, 0.18), white)
    piece.box((0, -0.30, 0.475), (1.5, 1.38, 0.03), finish=Finish.FABRIC)
    piece.box((0, 0.98, 0.50), (1.5, 0.06, 1.0), COLORS["brown"], Finish.WOOD)
    for x in (-0.36, 0.36):
        piece.box((x, 0.72, 0.52), (0.6, 0.38, 0.12), white)


def refrigerator(piece: Piece) -> None:
    """0.7 m wide, 1.8 m high, two doors with handles."""
    piece.box((0, 0.02, 0.90), (0.7, 0.64, 1.80))
    piece.box((0, -0.31, 0.55), (0.68, 0.02, 1.04))
    piece.box((0, -0.31, 1.44), (0.68, 0.02, 0.68))
    for z, length in ((0.75, 0.4), (1.34, 0.3)):
        piece.box((-0.28, -0.335, z), (0.03, 0.03, length), COLORS["gray"])


def oven(piece: Piece) -> None:
    """0.6 m wide, 0.9 m high, a glass door and four plates."""
    piece.box((0, 0, 0.45), (0.6, 0.58, 0.90))
    piece.box((0, -0.295, 0.42), (0.5, 0.01, 0.45), (70, 70, 76))
    piece.box((0, -0.31, 0.72), (0.46, 0.02, 0.02), COLORS["gray"])
    for x in (-0.14, 0.14):
        for y in (-0.12, 0.13):
            piece.cylinder((x, y, 0.903), 0.09, 0.006, (90, 40, 36))


def counter(piece: Piece) -> None:
    """1.9 m wide, 0.88 m high."""
    piece.box((0, 0.01, 0.42), (1.9, 0.56, 0.84), COLORS["brown"], Finish.WOOD)
    piece.box((0, 0, 0.86), (1.9, 0.6, 0.04))


def sink(piece: Piece) -> None:
    """A steel basin let into the counter, and its tap."""
    gray = COLORS["gray"]
    piece.box((0, 0, 0.01), (0.56, 0.44, 0.02), gray)
    piece.box((0, 0, 0.022), (0.46, 0.34, 0.005), (92, 95, 100))
    piece.cylinder((0, 0.19, 0.14), 0.018, 0.26, gray)
    piece.box((0, 0.10, 0.26), (0.025, 0.20, 0.025), gray)


def bookshelf(piece: Piece) -> None:
    """1.0 m wide, 1.25 m high, three rows of books."""
    for x in (-0.485, 0.485):
        piece.box((x, 0, 0.625), (0.03, 0.3, 1.25), finish=Finish.WOOD)
    piece.box((0, 0.14, 0.625), (0.94, 0.02, 1.25), finish=Finish.WOOD)
    for z in (0.04, 0.44, 0.84, 1.235):
        piece.box((0, 0, z), (0.94, 0.28, 0.03), finish=Finish.WOOD)
    for z, width in ((0.18, 0.86), (0.58, 0.74), (0.98, 0.80)):
        piece.box((width / 2 - 0.44, 0.02, z), (width, 0.2, 0.24), (255, 255, 255), Finish.BOOKS)


def nightstand(piece: Piece) -> None:
    """0.45 m wide, 0.5 m high."""
    piece.box((0, 0, 0.25), (0.45, 0.40, 0.50), finish=Finish.WOOD)
    piece.box((0, -0.205, 0.34), (0.12, 0.01, 0.02), COLORS["gray"])


def mug(piece: Piece) -> None:
    """9 cm across, 10 cm high, with a handle."""
    piece.cylinder((0, 0, 0.05), 0.045, 0.10)
    piece.box((0.06, 0, 0.05), (0.035, 0.014, 0.06))


def bottle(piece: Piece) -> None:
    """30 cm high."""
    piece.cylinder((0, 0, 0.10), 0.04, 0.20)
    piece.cylinder((0, 0, 0.24), 0.016, 0.10)
    piece.cylinder((0, 0, 0.295), 0.018, 0.02, COLORS["white"])


def book(piece: Piece) -> None:
    """Lies flat, 17 x 24 cm."""
    piece.box((0, 0, 0.0175), (0.17, 0.24, 0.035))


def laptop(piece: Piece) -> None:
    """Open, 34 cm wide, the screen at the back."""
    piece.box((0, 0, 0.01), (0.34, 0.24, 0.02))
    piece.box((0, 0.115, 0.125), (0.34, 0.012, 0.22))
    piece.box((0, 0.107, 0.125), (0.31, 0.006, 0.19), (60, 110, 170))


def remote(piece: Piece) -> None:
    """5 x 19 cm, buttons on top."""
    piece.box((0, 0, 0.0125), (0.05, 0.19, 0.025))
    piece.box((0, 0.03, 0.026), (0.034, 0.10, 0.004), COLORS["gray"])


def vase(piece: Piece) -> None:
    """30 cm high, a narrow neck and a wider rim."""
    piece.cylinder((0, 0, 0.09), 0.075, 0.18)
    piece.cylinder((0, 0, 0.22), 0.035, 0.08)
    piece.cylinder((0, 0, 0.28), 0.055, 0.04)


BUILDERS: dict[str, Callable[[Piece], None]] = {
    "table": table,
    "chair": chair,
    "sofa": sofa,
    "tv stand": tv_stand,
    "tv": tv,
    "bed": bed,
    "refrigerator": refrigerator,
    "oven": oven,
    "counter": counter,
    "sink": sink,
    "bookshelf": bookshelf,
    "nightstand": nightstand,
    "mug": mug,
    "bottle": bottle,
    "book": book,
    "laptop": laptop,
    "remote": remote,
    "vase": vase,
}
