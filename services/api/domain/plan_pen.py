"""Draws the parts of a floor plan, some times larger than they are shown, so that edges come out smooth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from ovip.scene.types import F64, Bools
from services.api.domain.lettering import Ink


class Pen:
    """Draws in world metres, y up, on a picture of `size` pixels whose upper left corner is at `corner`."""

    def __init__(
        self, size: tuple[int, int], corner: tuple[float, float], scale: float, finer: int, paper: Ink
    ) -> None:
        """scale: pixels a metre as shown; finer: how many times larger all is drawn."""
        self._size = size
        self._corner = corner
        self._finer = finer
        self._scale = scale * finer
        self._picture = Image.new("RGB", (size[0] * finer, size[1] * finer), paper)
        self._draw = ImageDraw.Draw(self._picture, "RGBA")

    def picture(self) -> Image.Image:
        """What was drawn, at the size it is shown in."""
        return self._picture.reduce(self._finer) if self._finer > 1 else self._picture

    def area(self, ring: F64, fill: Ink) -> None:
        """The inside of a ring `(N, 2)`."""
        self._draw.polygon(self._pixels(ring), fill=fill)

    def patch(self, ring: F64, fill: Ink, alpha: int, outline: Ink) -> None:
        """A translucent area with a thin line around it."""
        points = self._pixels(ring)
        self._draw.polygon(points, fill=(*fill, alpha))
        self.line(np.concatenate([ring, ring[:1]]), outline, 1.0)

    def cells(
        self, cells: Bools, corner: tuple[float, float], resolution: float, ink: Ink, alpha: int
    ) -> None:
        """Cells `(R, C)`, row 0 with the smallest y and `corner` their lowest x, y, with their stairs smoothed away."""
        at, size = self._place(cells, corner, resolution)
        grey = Image.fromarray(cells[::-1].astype(np.uint8) * 255).resize(size, Image.Resampling.BILINEAR)
        mask = grey.point([alpha if value > 127 else 0 for value in range(256)])
        self._picture.paste(ink, at, mask)

    def hatch(
        self, cells: Bools, corner: tuple[float, float], resolution: float, ink: Ink, gap: float
    ) -> None:
        """Thin slanted lines over cells, `gap` pixels apart as shown."""
        if not cells.any():
            return
        at, size = self._place(cells, corner, resolution)
        lines = Image.new("L", size, 0)
        draw = ImageDraw.Draw(lines)
        step = max(2, round(gap * self._finer))
        for start in range(-size[1], size[0], step):
            draw.line([(start, size[1]), (start + size[1], 0)], fill=255, width=self._finer)
        inside = Image.fromarray(cells[::-1].astype(np.uint8) * 255).resize(size, Image.Resampling.NEAREST)
        lines.paste(0, mask=inside.point([255 - value for value in range(256)]))
        self._picture.paste(ink, at, lines)

    def line(self, points: F64, ink: Ink, width: float) -> None:
        """Straight pieces through `(N, 2)`; width: pixels as shown."""
        self._draw.line(
            self._pixels(points), fill=ink, width=max(1, round(width * self._finer)), joint="curve"
        )

    def dashes(self, points: F64, ink: Ink, width: float, dash: float, gap: float) -> None:
        """A line through `(N, 2)` in dashes; lengths in pixels as shown."""
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        walked = np.concatenate([[0.0], np.cumsum(steps)])
        metre = self._finer / self._scale
        for start in np.arange(0.0, walked[-1], (dash + gap) * metre):
            stop = min(float(walked[-1]), start + dash * metre)
            between = walked[(walked > start) & (walked < stop)]
            at = np.array([start, *between, stop])
            piece = np.stack([np.interp(at, walked, points[:, axis]) for axis in (0, 1)], axis=1)
            self.line(piece, ink, width)

    def arrow(self, points: F64, ink: Ink, width: float) -> None:
        """A line of two points with a head at the second."""
        self.line(points, ink, width)
        along = points[1] - points[0]
        along = along / max(float(np.linalg.norm(along)), 1e-9)
        side = np.array([-along[1], along[0]])
        head = 9 * self._finer / self._scale
        self.area(
            np.stack(
                [
                    points[1],
                    points[1] - head * along + 0.5 * head * side,
                    points[1] - head * along - 0.5 * head * side,
                ]
            ),
            ink,
        )

    def _place(
        self, cells: Bools, corner: tuple[float, float], resolution: float
    ) -> tuple[tuple[int, int], tuple[int, int]]:
        """The upper left pixel of cells, and their width and height in pixels."""
        rows, columns = cells.shape
        x, y = self._pixels(np.array([[corner[0], corner[1] + rows * resolution]]))[0]
        side = resolution * self._scale
        return (round(x), round(y)), (max(1, round(columns * side)), max(1, round(rows * side)))

    def _pixels(self, points: F64) -> Sequence[tuple[float, float]]:
        x = (points[:, 0] - self._corner[0]) * self._scale
        y = (self._corner[1] - points[:, 1]) * self._scale
        return list(zip(x.tolist(), y.tolist(), strict=True))
