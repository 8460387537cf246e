"""What a home's structure is finished with: paint on the walls, wood, tiles or carpet on the floors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from lab.simulation.home import Material
from ovip.scene.types import F64

_PIXELS = 256
_PAINTS = (
    (236, 232, 222), (226, 230, 232), (240, 236, 214), (222, 231, 218),
    (238, 226, 218), (218, 224, 232), (232, 228, 226), (242, 240, 236),
)  # fmt: skip
_WOODS = ((176, 138, 98), (150, 108, 70), (196, 164, 124), (120, 84, 58))
_TILES = ((214, 208, 198), (190, 196, 198), (226, 224, 220), (168, 160, 150))
_CARPETS = ((150, 146, 140), (134, 142, 156), (172, 160, 144), (142, 152, 138))
_WET = ("kitchen", "bathroom", "laundry", "balcony", "storage")


@dataclass(frozen=True, slots=True, eq=False)
class Finishes:
    """What the surfaces of one home look like. grain: metres that a floor's picture spans."""

    paints: tuple[Material, ...]
    wood: Material
    tiles: Material
    carpet: Material
    white: Material
    leaf: Material
    glass: Material
    grain: float = 1.2

    def paint(self, room: int) -> Material:
        """The walls of a room."""
        return self.paints[room % len(self.paints)]

    def floor(self, function: str, room: int) -> Material:
        """The floor of a room: tiles where it gets wet, carpet in some others, wood in the rest."""
        if function in _WET:
            return self.tiles
        return self.carpet if function in ("bedroom", "playroom", "gym") and room % 2 else self.wood


def finishes(rng: np.random.Generator) -> Finishes:
    """Those of one home, by chance."""
    order = rng.permutation(len(_PAINTS))
    leaf = ((236, 234, 228), (148, 104, 66), (176, 134, 88))[int(rng.integers(3))]
    return Finishes(
        paints=tuple(_plain(_PAINTS[i]) for i in order),
        wood=_pictured(_planks, _choose(rng, _WOODS), rng),
        tiles=_pictured(_tiled, _choose(rng, _TILES), rng),
        carpet=_pictured(_woven, _choose(rng, _CARPETS), rng),
        white=_plain((244, 244, 242)),
        leaf=_plain(leaf),
        glass=_plain((206, 224, 236)),
    )


def _choose(rng: np.random.Generator, colors: tuple[tuple[int, int, int], ...]) -> tuple[int, int, int]:
    return colors[int(rng.integers(len(colors)))]


def _plain(color: tuple[int, int, int]) -> Material:
    return Material(np.array(color, np.uint8))


def _pictured(
    shade: Callable[[np.random.Generator], F64], color: tuple[int, int, int], rng: np.random.Generator
) -> Material:
    picture = np.clip(np.array(color)[None, None] * shade(rng)[:, :, None], 0, 255).astype(np.uint8)
    return Material(np.array(color, np.uint8), picture)


def _planks(rng: np.random.Generator) -> F64:
    """Eight boards, each of its own shade, with grain along them."""
    grain = cv2.GaussianBlur(rng.normal(0, 1, (_PIXELS, _PIXELS)), (0, 0), sigmaX=14, sigmaY=0.8)
    wide = _PIXELS // 8
    shade = 1 + 0.5 * grain + np.repeat(rng.uniform(-0.09, 0.09, 8), wide)[:, None]
    shade[::wide] *= 0.72
    for board in range(8):
        shade[board * wide : (board + 1) * wide, int(rng.integers(_PIXELS))] *= 0.75
    return np.asarray(shade, np.float64)


def _tiled(rng: np.random.Generator) -> F64:
    """Four by four tiles with joints between them."""
    wide = _PIXELS // 4
    shade = 1 + np.kron(rng.uniform(-0.035, 0.035, (4, 4)), np.ones((wide, wide)))
    shade += 0.15 * cv2.GaussianBlur(rng.normal(0, 1, shade.shape), (0, 0), sigmaX=3)
    for line in (0, 1):
        shade[line::wide] = shade[:, line::wide] = 0.78
    return np.asarray(shade, np.float64)


def _woven(rng: np.random.Generator) -> F64:
    return np.asarray(1 + 0.07 * rng.normal(0, 1, (_PIXELS, _PIXELS)), np.float64)
