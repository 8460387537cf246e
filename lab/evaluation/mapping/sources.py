"""Where places come from: a simulated home, the small house, a Replica scene, each as frames with ids and truth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lab.simulation.home import Home, surface_points
from lab.simulation.imperfect import SeenFrame, halved, rendered_frames, small_house_frames
from ovip.scene.types import F32, I64, Intrinsics

SMALL_HOUSE_STRIDE = 1
SPACING = 0.025  # metres between truth points


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """What a place is made from.

    points: `(P, 3)` metres on the true surface; ids: `(P,)` object each is of, 0 = none. classes: the class table,
    None = the labels that the home has. only_seen: leave out truth that no frame saw.
    """

    home: Home
    frames: Iterable[SeenFrame]
    points: F32
    ids: I64
    classes: tuple[str, ...] | None = None
    only_seen: bool = True


def simulated_source(seed: int, style: str | None, frames: int, camera: Intrinsics) -> Source:
    """The generated home of a seed, and a walk of so many frames through it seen by `camera`."""
    from lab.simulation.generate import make_home
    from lab.simulation.renderer import Renderer
    from lab.simulation.tour import walk_through

    home = make_home(seed, style)
    return _of_home(home, rendered_frames(Renderer(home, camera), walk_through(home, seed, frames)))


def small_house_source(root: Path) -> Source:
    """The small house in `root` and its recorded walk, every second frame at half the resolution."""
    from lab.simulation.small_house import load_small_house

    return _of_home(load_small_house(root), halved(small_house_frames(root, SMALL_HOUSE_STRIDE)))


def _of_home(home: Home, frames: Iterable[SeenFrame]) -> Source:
    points, ids = surface_points(home.mesh, SPACING)
    return Source(home, frames, points, ids.astype(np.int64))
