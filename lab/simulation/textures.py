"""All textures of a mesh in one image, each at several sizes, so that a whole frame is looked up at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from lab.simulation.home import Material
from ovip.scene.types import F32, I32, U8

LARGEST = 512  # pixels of a texture's longer side
_MOST_PIXELS = 48_000_000
_WIDTH = 4096
_LEVELS = 8
_BORDER = 1  # pixels repeated round each tile, so that bilinear lookup wraps


@dataclass(frozen=True, slots=True, eq=False)
class TextureAtlas:
    """image: `(A, B, 3)` uint8 RGB. tiles: `(M, LEVELS, 4)` float32: x, y, width, height of each material.

    sizes: `(M,)` float32, square root of a material's pixels at level 0.
    """

    image: U8
    tiles: F32
    sizes: F32

    @classmethod
    def of(cls, materials: Sequence[Material]) -> TextureAtlas:
        """Packs the materials; an untextured one is a tile of its colour. Equal arrays are packed once."""
        largest = _largest_side(materials)
        unique: dict[int, list[U8]] = {}
        for material in materials:
            if material.texture is not None and id(material.texture) not in unique:
                unique[id(material.texture)] = _pyramid(_fitted(material.texture, largest))
        keys = [id(m.texture) if m.texture is not None else -1 - i for i, m in enumerate(materials)]
        unique |= {-1 - i: [m.color.reshape(1, 1, 3)] for i, m in enumerate(materials) if m.texture is None}
        image, placed = _packed(unique)
        tiles = np.array([placed[key] for key in keys], dtype=np.float32).reshape(-1, _LEVELS, 4)
        return cls(image, tiles, np.sqrt(tiles[:, 0, 2] * tiles[:, 0, 3]))

    def colors(self, material: I32, u: F32, v: F32, footprint: F32) -> U8:
        """sRGB `(H, W, 3)` at `(H, W)` texture coordinates (v up, repeating).

        footprint: `(H, W)`, how many pixels of level 0 a sample covers across; picks the level.
        """
        level = np.log2(np.maximum(footprint, 1)).astype(np.int32)
        np.minimum(level, _LEVELS - 1, out=level)
        tile = self.tiles.reshape(-1, 4).take(material * _LEVELS + level, axis=0)
        x = tile[..., 0] + (u - np.floor(u)) * tile[..., 2] - np.float32(0.5)
        y = tile[..., 1] + (np.ceil(v) - v) * tile[..., 3] - np.float32(0.5)
        return np.asarray(cv2.remap(self.image, x, y, cv2.INTER_LINEAR), dtype=np.uint8)


def _largest_side(materials: Sequence[Material]) -> int:
    """The largest side that keeps the whole atlas in bounds."""
    textures = {id(m.texture): m.texture.shape[:2] for m in materials if m.texture is not None}
    largest = LARGEST
    while largest > 16 and sum(_pixels(shape, largest) for shape in textures.values()) > _MOST_PIXELS:
        largest //= 2
    return largest


def _pixels(shape: tuple[int, ...], largest: int) -> float:
    scale = min(1.0, largest / max(shape))
    return 4 / 3 * shape[0] * shape[1] * scale**2


def _fitted(texture: U8, largest: int) -> U8:
    scale = min(1.0, largest / max(texture.shape[:2]))
    height, width = (max(1, round(side * scale)) for side in texture.shape[:2])
    return _resized(texture, width, height)


def _pyramid(texture: U8) -> list[U8]:
    """The texture and its halvings; the last one repeats where it is a pixel already."""
    levels = [texture]
    while len(levels) < _LEVELS and max(levels[-1].shape[:2]) > 1:
        height, width = (max(1, side // 2) for side in levels[-1].shape[:2])
        levels.append(_resized(levels[-1], width, height))
    return levels


def _resized(image: U8, width: int, height: int) -> U8:
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _packed(pyramids: dict[int, list[U8]]) -> tuple[U8, dict[int, list[tuple[int, int, int, int]]]]:
    """Rows of tiles, the tallest first -> the image, and per key x, y, width, height of each level."""
    tiles = [(key, level, tile) for key, levels in pyramids.items() for level, tile in enumerate(levels)]
    tiles.sort(key=lambda entry: -entry[2].shape[0])
    places: dict[tuple[int, int], tuple[int, int, int, int]] = {}
    x = y = row = 0
    for key, level, tile in tiles:
        height, width = tile.shape[:2]
        if x + width + 2 * _BORDER > _WIDTH:
            x, y, row = 0, y + row, 0
        places[key, level] = (x + _BORDER, y + _BORDER, width, height)
        x, row = x + width + 2 * _BORDER, max(row, height + 2 * _BORDER)
    image = np.zeros((y + row, _WIDTH, 3), dtype=np.uint8)
    for key, level, tile in tiles:
        left, top, width, height = places[key, level]
        around = np.pad(tile, ((_BORDER, _BORDER), (_BORDER, _BORDER), (0, 0)), mode="wrap")
        image[top - _BORDER : top + height + _BORDER, left - _BORDER : left + width + _BORDER] = around
    every = {
        key: [places[key, min(level, len(levels) - 1)] for level in range(_LEVELS)]
        for key, levels in pyramids.items()
    }
    return image, every
