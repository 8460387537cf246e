"""Runs a scoring of places over whatever `ovip eval` was pointed at: places in parallel, then scene means."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.making import PlaceSpec, place_of, specs_of
from lab.evaluation.mapping.places import Place
from lab.evaluation.processes import in_processes
from lab.evaluation.rows import scene_means

T = TypeVar("T")


def score_places(score: Callable[[Place], list[Row]], options: Options) -> Result:
    """`score`'s rows of every place asked for, each with its "scene", and their means by "config".

    InvalidInput where the options name no such data set or folder.
    """
    scenes = [row for rows in over_places(score, options) for row in rows]
    return Result(rows=scene_means(scenes), scenes=scenes)


def over_places(task: Callable[[Place], T], options: Options) -> list[T]:
    """`task` of every place asked for, in order, in `options.workers` processes."""
    return in_processes(partial(_at_place, task), specs_of(options), options.workers)


def _at_place(task: Callable[[Place], T], spec: PlaceSpec) -> T:
    return task(place_of(spec))
