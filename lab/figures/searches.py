"""Active searches drawn on the floor: where a robot looked, joined in order, and what it found (needs matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lab.figures.curves import new_figure, save_figure
from ovip.scene.grid import FREE, FloorGrid
from ovip.scene.types import F64

_FLOOR, _WAY, _LOOK, _TRUTH, _FOUND = "#eceff1", "#8e24aa", "#5e35b1", "#2e7d32", "#e53935"
_PANEL_WIDTH = 4.4  # inches
_GLANCE = 0.35  # metres, length of the mark that shows a heading


@dataclass(frozen=True, slots=True, eq=False)
class DrawnSearch:
    """One search. looks: `(N, 3)` x, y metres and heading radians, in order. meant: `(M, 2)` what would answer it.

    found: `(2,)` what it gave, None for nothing.
    """

    title: str
    looks: F64
    meant: F64
    found: F64 | None = None


def draw_searches(path: Path, grid: FloorGrid, searches: Sequence[DrawnSearch]) -> Path:
    """One panel a search over the floor on which a robot can stand. NotConfigured where matplotlib is missing."""
    rows, columns = grid.occupancy.shape
    size = (_PANEL_WIDTH * len(searches), _PANEL_WIDTH * rows / columns + 0.4)
    figure, panels = new_figure(size, ncols=len(searches), squeeze=False)
    x = grid.origin[0] + (np.arange(columns) + 0.5) * grid.resolution
    y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution
    for axes, drawn in zip(panels[0], searches, strict=True):
        axes.contourf(x, y, (grid.occupancy == FREE).astype(float), [0.5, 1.0], colors=[_FLOOR])
        _draw(axes, drawn)
        axes.set_title(drawn.title, fontsize=9)
        axes.set_aspect("equal")
        axes.set_axis_off()
    return save_figure(figure, path)


def _draw(axes: Any, drawn: DrawnSearch) -> None:
    x, y, heading = drawn.looks.T
    glance = _GLANCE * np.stack([np.cos(heading), np.sin(heading)])
    axes.plot(x, y, color=_WAY, linewidth=1.0, alpha=0.6)
    axes.quiver(x, y, *glance, color=_LOOK, angles="xy", scale_units="xy", scale=1, width=0.004)
    axes.plot(*drawn.meant.T, "o", color=_TRUTH, markersize=9, fillstyle="none", markeredgewidth=2)
    if drawn.found is not None:
        axes.plot(*drawn.found, "x", color=_FOUND, markersize=8, markeredgewidth=2)
