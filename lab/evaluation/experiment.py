"""What an experiment is asked, and what it answers: `ovip eval NAME`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Row = dict[str, Any]
"""One line of a result: plain values by column; the honest figures beside the quirky ones under "strict"."""

TEST_SEED = 1000
"""First seed of the homes that figures are reported on; calibration uses seeds below it, and only those."""


@dataclass(frozen=True, slots=True)
class Options:
    """homes: how many simulated homes, with seeds `seed`, `seed + 1`, ...

    dataset: None = simulated homes, else "replica" or "small_house" in folder `root`. figures: folder to draw
    into, None = draw nothing. workers: processes to use. queries: most queries per scene, 0 = the experiment's own
    number.
    """

    homes: int = 3
    seed: int = TEST_SEED
    dataset: str | None = None
    root: Path | None = None
    figures: Path | None = None
    workers: int = 2
    queries: int = 0


@dataclass(frozen=True, slots=True)
class Result:
    """rows: one per configuration or method, named by "config"; scenes: the same per scene, named by "scene" too.

    figures: pictures drawn. notes: what a reader must know of how the figures came about.
    """

    rows: list[Row]
    scenes: list[Row]
    figures: tuple[Path, ...] = ()
    notes: tuple[str, ...] = ()


Experiment = Callable[[Options], Result]
