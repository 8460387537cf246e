"""Scene means: a row per configuration from rows per scene, as the paper's tables average."""

from __future__ import annotations

from collections.abc import Sequence

from lab.evaluation.experiment import Row

COUNTS = frozenset({"objects", "gt_objects", "swallowed_classes", "detections", "frames"})
"""Columns that are added up over scenes; every other number is averaged."""

_NAMES = frozenset({"config", "scene"})


def scene_means(scenes: Sequence[Row]) -> list[Row]:
    """A row per "config", in order of first appearance: the mean of each column over the scenes that have it.

    A scene without a value (None: it has no swallowed class) does not count; None where no scene has one. Nested
    "strict" rows are averaged alike.
    """
    configs = dict.fromkeys(row["config"] for row in scenes)
    return [
        {"config": config, **_mean([row for row in scenes if row["config"] == config])} for config in configs
    ]


def _mean(rows: Sequence[Row]) -> Row:
    columns = dict.fromkeys(column for row in rows for column in row if column not in _NAMES)
    return {column: _mean_of(column, [row.get(column) for row in rows]) for column in columns}


def _mean_of(column: str, values: Sequence[Row | float | None]) -> Row | float | None:
    nested = [value for value in values if isinstance(value, dict)]
    if nested:
        return _mean(nested)
    numbers = [value for value in values if isinstance(value, int | float)]
    if not numbers:
        return None
    return sum(numbers) if column in COUNTS else sum(numbers) / len(numbers)
