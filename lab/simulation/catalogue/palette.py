"""The colours and the small tileable pictures that models are finished with; seeded, so always the same."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from lab.simulation.home import Material
from ovip.scene.types import F64, U8

Color = tuple[int, int, int]

COLORS: dict[str, Color] = {
    "white": (240, 239, 235),
    "black": (36, 36, 40),
    "gray": (146, 148, 152),
    "red": (196, 36, 36),
    "green": (46, 134, 66),
    "blue": (44, 82, 170),
    "yellow": (230, 190, 50),
    "orange": (228, 120, 40),
    "brown": (122, 80, 48),
    "pink": (228, 140, 164),
    "purple": (112, 64, 142),
}
"""The colours that attributes name."""

TINTS: dict[str, Color] = {
    **COLORS,
    "cream": (232, 222, 198),
    "steel": (178, 181, 186),
    "dark": (58, 58, 64),
    "screen": (24, 27, 34),
    "glass": (196, 212, 214),
    "brass": (176, 140, 70),
    "leaf": (58, 112, 52),
    "soil": (70, 50, 38),
    "clay": (176, 104, 72),
    "skin": (206, 160, 120),
    "paper": (246, 244, 238),
    "crust": (184, 128, 66),
}
"""Plain finishes of composed models, by name."""

PIXELS = 128


def material(name: str) -> Material:
    """A plain finish by its name, or one of the pictures ("wood", "floral", ...). KeyError for none."""
    if name in TINTS:
        return Material(np.array(TINTS[name], np.uint8))
    picture = _pictures(name)
    return Material(picture.mean(axis=(0, 1)).astype(np.uint8), picture)


def is_pattern(name: str) -> bool:
    """Whether an attribute names a picture, not a colour."""
    return name in _PICTURES


@cache
def _pictures(name: str) -> U8:
    rng = np.random.default_rng(sum(ord(c) * 31**i for i, c in enumerate(name)) % 2**32)
    return np.clip(_PICTURES[name](rng), 0, 255).astype(np.uint8)


def _plain(rng: np.random.Generator) -> F64:
    return _ground((236, 228, 210)) + rng.normal(0, 3, (PIXELS, PIXELS, 1))


def _striped(rng: np.random.Generator) -> F64:
    x = np.arange(PIXELS)[None, :, None] * 4 // PIXELS
    return np.where(x % 2 == 0, _ground((240, 238, 232)), _ground((40, 78, 160))) + rng.normal(
        0, 3, (PIXELS, 1, 1)
    )


def _checked(rng: np.random.Generator) -> F64:
    x = np.arange(PIXELS) * 4 // PIXELS % 2
    shade = (x[:, None] + x[None, :])[..., None] / 2
    cloth = (1 - shade) * _ground((244, 240, 234)) + shade * _ground((190, 34, 40))
    return cloth + rng.normal(0, 2, (PIXELS, PIXELS, 1))


def _dotted(rng: np.random.Generator) -> F64:
    cloth = _ground((150, 40, 70)) + rng.normal(0, 3, (PIXELS, PIXELS, 1))
    for center in ((0.25, 0.25), (0.75, 0.75), (0.25, 0.75), (0.75, 0.25)):
        cloth[_distance(center) < 0.11] = (246, 240, 236)
    return cloth


def _floral(rng: np.random.Generator) -> F64:
    """Flowers of five petals and leaves, scattered on cream."""
    cloth = _ground((240, 232, 214)) + rng.normal(0, 2, (PIXELS, PIXELS, 1))
    petals = ((206, 60, 92), (226, 120, 60), (150, 70, 160), (222, 92, 140))
    centers = [(0.22, 0.2), (0.7, 0.28), (0.45, 0.62), (0.9, 0.72), (0.12, 0.86)]
    for index, center in enumerate(centers):
        turn = rng.uniform(0, 2 * np.pi)
        for angle in (turn + 0.5, turn + 2.6):
            leaf = (center[0] + 0.17 * np.cos(angle), center[1] + 0.17 * np.sin(angle))
            cloth[_distance(leaf) < 0.05] = (84, 134, 74)
        for angle in turn + np.arange(5) * 2 * np.pi / 5:
            petal = (center[0] + 0.085 * np.cos(angle), center[1] + 0.085 * np.sin(angle))
            cloth[_distance(petal) < 0.062] = petals[index % len(petals)]
        cloth[_distance(center) < 0.045] = (244, 206, 70)
    return cloth


def _wood(rng: np.random.Generator) -> F64:
    rows = np.arange(PIXELS)[:, None] / PIXELS * 2 * np.pi
    columns = np.arange(PIXELS)[None, :] / PIXELS * 2 * np.pi
    grain = np.sin(9 * rows + 1.4 * np.sin(columns) + 0.8 * np.sin(2 * rows))
    fine = rng.normal(0, 1, (PIXELS, 1)) + 0.3 * rng.normal(0, 1, (PIXELS, PIXELS))
    return _ground((160, 112, 70)) * (1 + 0.10 * grain + 0.04 * fine)[..., None]


def _woven(rng: np.random.Generator) -> F64:
    step = np.arange(PIXELS) * 16 // PIXELS % 2
    weave = (step[:, None] ^ step[None, :]) * 0.3
    edge = np.abs(np.arange(PIXELS) * 16 / PIXELS % 1 - 0.5)[:, None] * 0.3
    noise = rng.normal(0, 0.03, (PIXELS, PIXELS))
    return _ground((190, 148, 96)) * (0.85 + weave - edge + noise)[..., None]


def _books(rng: np.random.Generator) -> F64:
    """Backs of books in a row, the wood behind showing above them."""
    row = np.tile(_ground((60, 44, 34)), 1)
    colors = [*COLORS.values(), (90, 60, 50), (40, 60, 70), (180, 170, 140)]
    at = 0
    while at < PIXELS:
        width, height = int(rng.integers(5, 13)), int(rng.integers(92, 122))
        row[PIXELS - height :, at : at + width] = colors[int(rng.integers(len(colors)))]
        row[PIXELS - height :, at : at + 1] *= 0.5
        row[PIXELS - 80 : PIXELS - 76, at + 1 : at + width - 1] *= 1.25
        at += width
    return row


def _quilted(rng: np.random.Generator) -> F64:
    x, y = np.meshgrid(np.arange(PIXELS), np.arange(PIXELS))
    seam = np.minimum((x + y) % 32, (x - y) % 32)[..., None]
    return _ground((225, 224, 226)) * np.where(seam < 2, 0.85, 1.0) + rng.normal(0, 2, (PIXELS, PIXELS, 1))


def _painting(rng: np.random.Generator) -> F64:
    """Hills under a sky with a sun: what hangs in picture frames."""
    y, x = np.mgrid[0:PIXELS, 0:PIXELS] / PIXELS
    sky = np.stack([150 + 80 * y, 180 + 40 * y, 225 - 30 * y], axis=-1)
    sky[(x - 0.7) ** 2 + (y - 0.25) ** 2 < 0.01] = (250, 220, 120)
    for level, color in ((0.5, (92, 130, 110)), (0.62, (70, 112, 62)), (0.78, (120, 96, 52))):
        line = level + 0.06 * np.sin(2 * np.pi * (x * rng.uniform(1, 2) + rng.uniform()))
        sky[y > line] = color
    return sky + rng.normal(0, 4, (PIXELS, PIXELS, 1))


def _clock(rng: np.random.Generator) -> F64:
    """A dial with twelve marks; the hands show ten past ten."""
    y, x = (np.mgrid[0:PIXELS, 0:PIXELS] + 0.5) / PIXELS - 0.5
    dial = _ground((246, 245, 240)) + rng.normal(0, 1, (PIXELS, PIXELS, 1))
    radius, angle = np.hypot(x, y), np.arctan2(x, -y) % (2 * np.pi)
    mark = np.abs((angle + np.pi / 12) % (np.pi / 6) - np.pi / 12) * radius < 0.010
    dial[mark & (radius > 0.38) & (radius < 0.46)] = 20
    for turn, length, width in ((-np.pi / 3, 0.24, 0.018), (np.pi / 3, 0.34, 0.012)):
        along, across = x * np.sin(turn) - y * np.cos(turn), x * np.cos(turn) + y * np.sin(turn)
        dial[(along > 0) & (along < length) & (np.abs(across) < width)] = 20
    return dial


def _keys(rng: np.random.Generator) -> F64:
    """Rows of keys or buttons, light on dark."""
    y, x = np.mgrid[0:PIXELS, 0:PIXELS] * 8 % PIXELS
    inside = (x > 20) & (x < 108) & (y > 20) & (y < 108)
    return np.where(inside[..., None], _ground((196, 196, 200)), _ground((40, 40, 46))) + rng.normal(
        0, 2, (PIXELS, PIXELS, 1)
    )


def _piano(rng: np.random.Generator) -> F64:
    """One octave, black keys at the top half."""
    x = np.arange(PIXELS)[None, :] / PIXELS
    y = np.arange(PIXELS)[:, None] / PIXELS
    row = _ground((248, 246, 240)) + rng.normal(0, 1, (PIXELS, PIXELS, 1))
    row[np.broadcast_to(x * 7 % 1 < 0.06, (PIXELS, PIXELS))] = 60
    for key in (1, 2, 4, 5, 6):
        row[(y < 0.6) & (np.abs(x - key / 7) < 0.04)] = 16
    return row


def _ground(color: Color) -> F64:
    return np.ones((PIXELS, PIXELS, 1)) * np.asarray(color, np.float64)


def _distance(center: tuple[float, float]) -> F64:
    """Of every pixel to a point, in pictures; pictures repeat."""
    y, x = (np.mgrid[0:PIXELS, 0:PIXELS] + 0.5) / PIXELS
    dx, dy = (x - center[0] + 0.5) % 1 - 0.5, (y - center[1] + 0.5) % 1 - 0.5
    distance: F64 = np.hypot(dx, dy)
    return distance


_PICTURES: dict[str, Callable[[np.random.Generator], F64]] = {
    "plain": _plain,
    "striped": _striped,
    "checked": _checked,
    "dotted": _dotted,
    "floral": _floral,
    "wood": _wood,
    "woven": _woven,
    "books": _books,
    "quilted": _quilted,
    "painting": _painting,
    "clock": _clock,
    "keys": _keys,
    "piano": _piano,
}
