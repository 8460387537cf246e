"""Frames a second of the home renderer at 640x480: shaded, and depth with ids."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence

import numpy as np

from lab.bench.rows import Row, spread
from lab.simulation.generate import make_home
from lab.simulation.home import Home
from lab.simulation.renderer import Renderer
from lab.simulation.tour import walk_through
from lab.simulation.world import HOME_CAMERA
from ovip.scene.types import F64


def measure_rendering(frames: int = 12, home: Home | None = None) -> list[Row]:
    """A row for each way to render, over `frames` frames of a walk through a generated home (seed 0) or through `home`.

    The first frame warms up and does not count.
    """
    home = home or make_home(0)
    renderer = Renderer(home, HOME_CAMERA)
    poses = walk_through(home, frames=frames + 1)
    ways: dict[str, Callable[[F64], object]] = {
        "shaded": renderer.render,
        "depth and ids": renderer.depth_and_ids,
    }
    return [_row(name, render, poses, home) for name, render in ways.items()]


def _row(name: str, render: Callable[[F64], object], poses: Sequence[F64], home: Home) -> Row:
    samples = []
    for pose in poses:
        began = time.perf_counter()
        render(pose)
        samples.append((time.perf_counter() - began) * 1e3)
    return {
        "what": name,
        "home": home.name,
        "triangles": len(home.mesh.triangles),
        "frames": len(samples) - 1,
        "cores": os.cpu_count() or 1,
        "frames_per_second": round(1e3 / float(np.mean(samples[1:])), 2),
        **spread(samples[1:]),
    }
