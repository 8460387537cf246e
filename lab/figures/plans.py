"""Floor plans cut into regions, side by side, and silhouettes over K (need matplotlib)."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from lab.figures.curves import new_figure, save_figure
from ovip.scene.types import F64, I32, Bools

_FUNCTION_COLORS = {
    "kitchen": "#f6b26b",
    "dining area": "#ffe08a",
    "living room": "#a8d5a2",
    "bedroom": "#9fc5e8",
    "bathroom": "#8fd3d1",
    "office": "#c5b3e6",
    "study": "#c5b3e6",
    "hallway": "#d9d2c5",
    "entryway": "#d8b49c",
    "gym": "#ee9a9a",
    "balcony": "#cfe8b5",
    "laundry": "#b4c7dc",
    "playroom": "#f4b8d4",
    "garage": "#bdbdbd",
    "storage": "#cdbba7",
    "unknown": "#e6e6e6",
}
_WALL, _OUTSIDE, _INK, _DOOR, _DOT = "#3b3f46", "#fbfaf7", "#22252a", "#a0673a", "#5a4632"
_GOLDEN = 0.618033988749895
_SMALLEST_NAMED = 1.2  # square metres
_PANEL_WIDTH = 5.2  # inches
_NARROWEST = 2.6


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """One storey cut up. labels: `(R, C)`, 0 = none, else 1 + index into `names`; rows grow with y.

    title: above it; note: below it. names: of the regions, "" = draw none; a known function gives its colour.
    under: what stands under each name, in the same order; none of them where it is empty.
    """

    title: str
    labels: I32
    names: tuple[str, ...]
    note: str = ""
    under: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Backdrop:
    """What all plans of a storey share. origin: world x, y of the outer corner of cell (0, 0); resolution: metres.

    walls: `(R, C)`. dots: `(N, 2)` world x, y of objects. doors: `(M, 6)` boxes, metres.
    """

    origin: tuple[float, float]
    resolution: float
    walls: Bools
    dots: F64 = field(default_factory=lambda: np.zeros((0, 2)))
    doors: F64 = field(default_factory=lambda: np.zeros((0, 6)))


def draw_partition(
    path: Path, title: str, backdrop: Backdrop, plans: Sequence[Plan], columns: int = 3
) -> Path:
    """Writes a PNG of the plans, so many to a row, at one scale. Returns `path`; NotConfigured without matplotlib."""
    window = _window(backdrop, plans)
    rows = -(-len(plans) // columns)
    height, width = (side.stop - side.start for side in window)
    panel = max(_NARROWEST, _PANEL_WIDTH * min(1.2, height / max(width, 1))) + 0.5
    figure, grid = new_figure(
        (_PANEL_WIDTH * columns, panel * rows + 0.5), nrows=rows, ncols=columns, squeeze=False
    )
    figure.patch.set_facecolor("white")
    for axes in grid.ravel():
        axes.set_axis_off()
    for axes, plan in zip(grid.ravel(), plans, strict=False):
        _draw(axes, backdrop, plan, window)
    _scale_bar(grid.ravel()[0], backdrop, window)
    figure.suptitle(title, fontsize=15, color=_INK, fontweight="bold")
    return save_figure(figure, path)


@dataclass(frozen=True, slots=True)
class KCurve:
    """One home's auto-K: silhouette and accuracy by K, the K that was chosen, and the true number of areas."""

    name: str
    silhouettes: Mapping[int, float]
    acc: Mapping[int, float]
    chosen: int | None
    areas: int


def draw_silhouettes(path: Path, title: str, curves: Sequence[KCurve]) -> Path:
    """Writes a PNG of each home's silhouette and accuracy over K. Returns `path`; NotConfigured without matplotlib.

    A ring marks the chosen K, a cross the true number of areas.
    """
    figure, (left, right) = new_figure((12.5, 4.4), ncols=2)
    for number, curve in enumerate(curves):
        _draw_curve(left, curve.name, curve.silhouettes, curve, number)
        _draw_curve(right, curve.name, curve.acc, curve, number)
    left.set(xlabel="K", ylabel="mean silhouette")
    right.set(xlabel="K (ring: chosen by silhouette; cross: true number of areas)", ylabel="acc")
    right.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.suptitle(title, fontsize=13, color=_INK)
    return save_figure(figure, path)


def _draw_curve(axes: Any, name: str, values: Mapping[int, float], curve: KCurve, number: int) -> None:
    k, color = sorted(values), _tone(number)
    axes.plot(k, [values[tried] for tried in k], marker="o", markersize=3, color=color, label=name)
    for mark, at in (("o", curve.chosen), ("x", curve.areas)):
        if at is not None and at in values:
            axes.plot(
                [at],
                [values[at]],
                marker=mark,
                markersize=10,
                fillstyle="none",
                color=color,
                markeredgewidth=1.8,
            )
    axes.grid(alpha=0.3)


def _window(backdrop: Backdrop, plans: Sequence[Plan]) -> tuple[slice, slice]:
    """The part of the grid that anything lies in, with a little room around."""
    drawn = backdrop.walls.copy()
    for plan in plans:
        drawn |= plan.labels > 0
    if not drawn.any():
        return slice(0, drawn.shape[0]), slice(0, drawn.shape[1])
    (window,) = ndimage.find_objects(drawn.astype(np.int32))
    rows, columns = (
        slice(max(0, side.start - 4), min(size, side.stop + 4))
        for side, size in zip(window, drawn.shape, strict=True)
    )
    return rows, columns


def _draw(axes: Any, backdrop: Backdrop, plan: Plan, window: tuple[slice, slice]) -> None:
    from matplotlib import patheffects
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Rectangle

    colors = np.array([to_rgb(_OUTSIDE), *(to_rgb(color) for color in _colors(plan.names))])
    image = colors[plan.labels]
    image[_borders(plan.labels)] *= 0.72
    image[backdrop.walls] = to_rgb(_WALL)
    x0, x1, y0, y1 = _extent(backdrop, window)
    axes.imshow(image[window], origin="lower", extent=(x0, x1, y0, y1), interpolation="nearest")
    for box in backdrop.doors:
        size = np.maximum(box[3:5] - box[:2], 0.08)
        axes.add_patch(Rectangle(box[:2], *size, facecolor=_DOOR, edgecolor="none", alpha=0.85))
    axes.scatter(*backdrop.dots.T, s=5, color=_DOT, alpha=0.7, linewidths=0)
    halo = [patheffects.withStroke(linewidth=2.6, foreground="white", alpha=0.85)]
    for name, place in _names(plan, backdrop):
        axes.text(*place, name, ha="center", va="center", fontsize=8.5, color=_INK, path_effects=halo)
    axes.set_title(plan.title, fontsize=12, color=_INK)
    axes.text(
        0.5, -0.02, plan.note, transform=axes.transAxes, ha="center", va="top", fontsize=8.5, color="0.35"
    )
    axes.set(xlim=(x0, x1), ylim=(y0, y1))


def _extent(backdrop: Backdrop, window: tuple[slice, slice]) -> tuple[float, float, float, float]:
    rows, columns = window
    x = [backdrop.origin[0] + edge * backdrop.resolution for edge in (columns.start, columns.stop)]
    y = [backdrop.origin[1] + edge * backdrop.resolution for edge in (rows.start, rows.stop)]
    return x[0], x[1], y[0], y[1]


def _colors(names: Sequence[str]) -> list[Any]:
    """A function's own colour, a shade off for every further region of it; others by number."""
    seen: dict[str, int] = {}
    colors: list[Any] = []
    for number, name in enumerate(names):
        again = seen.get(name, 0)
        seen[name] = again + 1
        known = _FUNCTION_COLORS.get(name)
        colors.append(_shaded(known, again) if known else _tone(number))
    return colors


def _shaded(color: str, again: int) -> tuple[float, float, float]:
    red, green, blue = (int(color[at : at + 2], 16) / 255 for at in (1, 3, 5))
    hue, light, vivid = colorsys.rgb_to_hls(red, green, blue)
    return colorsys.hls_to_rgb((hue + 0.02 * again) % 1, max(0.5, light - 0.055 * again), vivid)


def _tone(number: int) -> tuple[float, float, float]:
    return colorsys.hls_to_rgb(number * _GOLDEN % 1, 0.74, 0.55)


def _borders(labels: I32) -> Bools:
    """Cells beside a cell of another region."""
    across = np.zeros(labels.shape, bool)
    across[:-1] |= (labels[:-1] != labels[1:]) & (labels[:-1] > 0) & (labels[1:] > 0)
    across[:, :-1] |= (labels[:, :-1] != labels[:, 1:]) & (labels[:, :-1] > 0) & (labels[:, 1:] > 0)
    return across


def _names(plan: Plan, backdrop: Backdrop) -> list[tuple[str, F64]]:
    """Each large region's name, with what stands under it, and the middle of its widest place, world x, y."""
    placed = []
    under = plan.under or ("",) * len(plan.names)
    for number, (name, below) in enumerate(zip(plan.names, under, strict=True), start=1):
        cells = plan.labels == number
        if name and cells.sum() * backdrop.resolution**2 >= _SMALLEST_NAMED:
            depth = ndimage.distance_transform_edt(np.pad(cells, 1))[1:-1, 1:-1]
            row, column = np.unravel_index(int(depth.argmax()), cells.shape)
            place = (np.array([column, row]) + 0.5) * backdrop.resolution + np.asarray(backdrop.origin)
            placed.append((f"{name}\n{below}" if below else name, place))
    return placed


def _scale_bar(axes: Any, backdrop: Backdrop, window: tuple[slice, slice]) -> None:
    """2 m, under the lower left corner."""
    x0, x1, y0, y1 = _extent(backdrop, window)
    below = y0 - 0.025 * (y1 - y0)
    axes.plot([x0, x0 + 2.0], [below, below], color=_INK, linewidth=2, clip_on=False, solid_capstyle="butt")
    axes.text(x0 + 2.0 + 0.01 * (x1 - x0), below, "2 m", va="center", fontsize=8, color=_INK)
