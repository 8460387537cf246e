"""What each step of a partition takes: its functions timed where they are called, the outermost step counting."""

from __future__ import annotations

import contextlib
import functools
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

from services.regions.domain import assembly, functions, partition, survey

STEPS: tuple[tuple[str, ModuleType, str], ...] = (
    ("floors", survey, "find_storeys"),
    ("free_space", survey, "find_free_space"),
    ("functions", functions, "functions_of"),
    ("clearance", partition, "clearance_of"),
    ("cores", partition, "find_cores"),
    ("first_watershed", partition, "flood"),
    ("snapping", partition, "nearest_cells"),
    ("groups", partition, "seed_groups"),
    ("markers", partition, "place_markers"),
    ("final_watershed", partition, "grow"),
    ("merging", partition, "merged"),
    ("ids", assembly, "keep_ids"),
    ("back_projection", assembly, "labels_at"),
    ("outlines", assembly, "trace_outlines"),
    ("edges", assembly, "find_openings"),
    ("stairs", assembly, "find_stairs"),
    ("frontiers", assembly, "find_frontiers"),
    ("seen_by", assembly, "seen_by"),
)
"""Each step's name, and the name that its function is called by in a module."""


class Stopwatch:
    """Seconds by step. A step inside another step is the outer one's."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self._running = False

    def timing(self, step: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, its time put down as a step's."""

        @functools.wraps(function)
        def timed(*args: Any, **more: Any) -> Any:
            if self._running:
                return function(*args, **more)
            self._running, began = True, time.perf_counter()
            try:
                return function(*args, **more)
            finally:
                self._running = False
                self.seconds[step] += time.perf_counter() - began

        return timed


@contextlib.contextmanager
def stopwatch() -> Iterator[Stopwatch]:
    """Times every step that is taken inside the block."""
    watch = Stopwatch()
    plain = [(module, name, getattr(module, name)) for _, module, name in STEPS]
    try:
        for (step, _, _), (module, name, function) in zip(STEPS, plain, strict=True):
            setattr(module, name, watch.timing(step, function))
        yield watch
    finally:
        for module, name, function in plain:
            setattr(module, name, function)
