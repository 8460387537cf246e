"""Curves of a result over a swept setting (needs matplotlib)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ovip.errors import NotConfigured

_SIZE = (6.4, 3.8)  # inches
_DPI = 130


def draw_curves(
    path: Path,
    x: Sequence[float],
    curves: Mapping[str, Sequence[float]],
    x_label: str,
    y_label: str,
    mark: float | None = None,
    title: str = "",
) -> Path:
    """Writes a PNG of each named curve `y` over `x`; `mark` draws a line at the chosen x. Returns `path`."""
    figure, axes = new_figure(_SIZE)
    for name, y in curves.items():
        axes.plot(x, y, marker="o", markersize=3, linewidth=1.5, label=name)
    if mark is not None:
        axes.axvline(mark, color="0.4", linestyle="--", linewidth=1, label=f"chosen: {mark:g}")
    axes.set(xlabel=x_label, ylabel=y_label, title=title)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    return save_figure(figure, path)


def new_figure(size: tuple[float, float], **axes: Any) -> tuple[Any, Any]:
    """A matplotlib figure of `size` inches and its axes; NotConfigured where matplotlib is missing."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise NotConfigured("figures need matplotlib: pip install 'ovip-sg[lab]'") from error
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(**axes)


def save_figure(figure: Any, path: Path) -> Path:
    """Writes the figure as PNG, without a date in it, and returns `path`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})
    return path
