"""A mapped scene as a picture: every object in its own colour, from above and from a corner (needs matplotlib)."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lab.figures.curves import new_figure, save_figure
from ovip.scene.types import F32, F64, I64, U8

_PIXEL = 0.02  # metres on the plan
_VIEW_PIXELS = (1500, 1000)  # width, height of the view from the corner
_ELEVATION, _AZIMUTH = np.radians(38.0), np.radians(235.0)
_GOLDEN = 0.618033988749895


@dataclass(frozen=True, slots=True, eq=False)
class MapLayer:
    """What is drawn of one storey. clouds: `(N, 3)` metres of each object; labels: their words.

    outlines: names and open rings `(M, 2)` of areas, drawn under the objects.
    """

    name: str
    clouds: Sequence[F32]
    labels: Sequence[str]
    outlines: Sequence[tuple[str, F64]] = ()


def draw_map(path: Path, layers: Sequence[MapLayer], title: str = "") -> Path:
    """Writes a PNG with a row a storey: its plan with labels, and a view of it. Returns `path`.

    Larger objects get their label first; a label that would lie on another is left out.
    """
    figure, grid = new_figure((15, 6.2 * len(layers)), nrows=len(layers), ncols=2, squeeze=False)
    for axes, layer in zip(grid, layers, strict=True):
        _plan(axes[0], layer)
        _corner_view(axes[1], layer)
    figure.suptitle(title, fontsize=11)
    return save_figure(figure, path)


def instance_colors(count: int) -> U8:
    """`(count, 3)` RGB colours that differ well from their neighbours in the list."""
    tones = [
        colorsys.hsv_to_rgb(i * _GOLDEN % 1, 0.55 + 0.4 * (i % 2), 0.95 - 0.25 * (i % 3))
        for i in range(count)
    ]
    return np.asarray(np.round(np.array(tones).reshape(count, 3) * 255), np.uint8)


def _plan(axes: Any, layer: MapLayer) -> None:
    for name, ring in layer.outlines:
        axes.fill(ring[:, 0], ring[:, 1], facecolor="0.96", edgecolor="0.6", linewidth=0.8)
        axes.text(
            *ring.mean(axis=0),
            name,
            color="0.65",
            fontsize=8,
            ha="center",
            va="center",
            style="italic",
            in_layout=False,
        )
    points, owner = _joined(layer.clouds)
    if len(points):
        low = points[:, :2].min(axis=0) - _PIXEL
        cells = ((points[:, :2] - low) / _PIXEL).astype(np.int64)
        width, height = cells.max(axis=0) + 1
        image = _splat(cells[:, 0], cells[:, 1], -points[:, 2], owner, (int(width), int(height)), 2)
        rgba = _colored(image, instance_colors(len(layer.clouds)))
        axes.imshow(
            rgba,
            origin="lower",
            extent=(low[0], low[0] + width * _PIXEL, low[1], low[1] + height * _PIXEL),
            interpolation="nearest",
            zorder=2,
        )
        _label(axes, [cloud[:, :2].mean(axis=0) for cloud in layer.clouds], layer, 0.35)
    axes.set(title=layer.name, xlabel="x, metres", ylabel="y, metres", aspect="equal")


def _corner_view(axes: Any, layer: MapLayer) -> None:
    axes.set_axis_off()
    points, owner = _joined(layer.clouds)
    if not len(points):
        return
    across, up, depth = _projected(points)
    scale = min(_VIEW_PIXELS[0] / np.ptp(across), _VIEW_PIXELS[1] / np.ptp(up)) * 0.98
    x, y = ((across - across.min()) * scale).astype(np.int64), ((up - up.min()) * scale).astype(np.int64)
    size = max(1, round(_PIXEL * scale))
    image = _splat(x, y, depth, owner, (int(x.max()) + size, int(y.max()) + size), size)
    axes.imshow(
        _colored(image, instance_colors(len(layer.clouds))), origin="lower", interpolation="antialiased"
    )
    starts = np.cumsum([0, *(len(cloud) for cloud in layer.clouds)])[:-1]
    middles = [
        np.array([np.mean(x[at : at + n]), np.mean(y[at : at + n])]) for at, n in _spans(starts, layer)
    ]
    _label(axes, middles, layer, 0.35 * scale)


def _spans(starts: I64, layer: MapLayer) -> list[tuple[int, int]]:
    return [(int(at), len(cloud)) for at, cloud in zip(starts, layer.clouds, strict=True)]


def _joined(clouds: Sequence[F32]) -> tuple[F32, I64]:
    """All points `(P, 3)` and the number of the cloud that each is of `(P,)`."""
    points = np.concatenate([*clouds, np.zeros((0, 3), np.float32)])
    return points, np.repeat(np.arange(len(clouds)), [len(cloud) for cloud in clouds])


def _projected(points: F32) -> tuple[F64, F64, F64]:
    """Parallel projection from above a corner: metres across, up, and away from the eye."""
    away = np.array([np.cos(_AZIMUTH) * np.cos(_ELEVATION), np.sin(_AZIMUTH) * np.cos(_ELEVATION)])
    forward = -np.array([*away, np.sin(_ELEVATION)])
    right = np.array([-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0.0])
    wide = points.astype(np.float64)
    return wide @ right, wide @ np.cross(right, forward), wide @ forward


def _splat(x: I64, y: I64, depth: F64 | F32, owner: I64, size: tuple[int, int], dot: int) -> I64:
    """Who is nearest the eye in each pixel `(height, width)`, -1 for nobody; each point covers `dot` x `dot`."""
    width, height = size
    image = np.full((height + dot, width + dot), -1, np.int64)
    order = np.argsort(-np.asarray(depth, np.float64), kind="stable")  # far first: the last write wins
    for dy in range(dot):
        for dx in range(dot):
            layer = np.full_like(image, -1)
            layer[y[order] + dy, x[order] + dx] = order
            nearer = (layer >= 0) & ((image < 0) | (depth[layer] < depth[image]))
            image = np.where(nearer, layer, image)
    return np.asarray(np.where(image >= 0, owner[image], -1)[:height, :width], np.int64)


def _colored(image: I64, colors: U8) -> U8:
    """RGBA `(H, W, 4)`; clear where nobody is."""
    rgba = np.zeros((*image.shape, 4), np.uint8)
    taken = image >= 0
    rgba[taken, :3] = colors[image[taken]]
    rgba[taken, 3] = 255
    return rgba


def _label(axes: Any, middles: Sequence[F64], layer: MapLayer, spacing: float) -> None:
    order = np.argsort([-len(cloud) for cloud in layer.clouds], kind="stable")
    taken: list[F64] = []
    for i in order:
        at = middles[int(i)]
        if all(
            abs(at[1] - other[1]) > spacing * 0.6 or abs(at[0] - other[0]) > 2.2 * spacing for other in taken
        ):
            taken.append(at)
            axes.text(
                *at,
                layer.labels[int(i)],
                fontsize=6,
                ha="center",
                va="center",
                zorder=3,
                in_layout=False,
                bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "alpha": 0.7, "linewidth": 0},
            )
