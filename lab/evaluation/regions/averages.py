"""Means over homes: of each method, and of each method on each kind of home."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from lab.evaluation.experiment import Row

_NOT_A_FIGURE = frozenset({"config", "scene", "style", "floors"})
_OF_A_STYLE = ("HydP", "HydR", "acc", "AP", "containment", "area", "open_area")


def mean_rows(scenes: Sequence[Row]) -> list[Row]:
    """A row per "config": every figure's mean over homes that have it, and the same of the figures under "strict".

    acc_std: spread of accuracy over two or more homes; HydP_one_floor, HydP_more_floors: of the homes with so many.
    """
    return [{"config": config, **_summary(mine)} for config, mine in _by_config(scenes)]


def style_rows(scenes: Sequence[Row]) -> list[Row]:
    """A row per "config" and kind of home: how many there are, and the means of the main figures over them.

    A home is of each kind that its style names, and has one floor or more.
    """
    kinds = list(dict.fromkeys(kind for row in scenes for kind in kinds_of(row)))
    return [
        {"config": config, "kind": kind, "homes": len(some), **_main(some)}
        for config, mine in _by_config(scenes)
        for kind in kinds
        if (some := [row for row in mine if kind in kinds_of(row)])
    ]


def kinds_of(row: Row) -> tuple[str, ...]:
    """The kinds of home that a scene's row tells of: walled or open, compact or elongated, one floor or more."""
    words = str(row["style"]).split("-")
    named = [word for word in ("walled", "open", "compact", "elongated") if word in words]
    return (*named, "one floor" if row["floors"]["true"] == 1 else "more floors")


def _summary(mine: Sequence[Row]) -> Row:
    means = {**_mean(mine), **_spread(mine)}
    if "strict" in means:
        honest = [{**row["strict"], "floors": row["floors"]} for row in mine]
        means["strict"] |= _spread(honest)
    return means


def _spread(mine: Sequence[Row]) -> Row:
    spread: Row = {"acc_std": float(np.std([row["acc"] for row in mine])) if len(mine) > 1 else None}
    for name, several in (("HydP_one_floor", False), ("HydP_more_floors", True)):
        some = [
            row["HydP"]
            for row in mine
            if row.get("HydP") is not None and (row["floors"]["true"] > 1) is several
        ]
        spread[name] = float(np.mean(some)) if some else None
    return spread


def _main(some: Sequence[Row]) -> Row:
    means = _mean(some)
    strict = means.get("strict", {})
    return {
        **{column: means.get(column) for column in _OF_A_STYLE},
        **{f"strict_{column}": strict.get(column) for column in ("HydP", "acc", "AP")},
    }


def _mean(rows: Sequence[Row]) -> Row:
    columns = dict.fromkeys(column for row in rows for column in row if column not in _NOT_A_FIGURE)
    means: Row = {}
    for column in columns:
        values = [row[column] for row in rows if row.get(column) is not None]
        nested = [value for value in values if isinstance(value, dict)]
        means[column] = _mean(nested) if nested else float(np.mean(values)) if values else None
    return means


def _by_config(scenes: Sequence[Row]) -> Iterable[tuple[str, list[Row]]]:
    """Each config with its rows, in the order in which they first come."""
    for config in dict.fromkeys(row["config"] for row in scenes):
        yield config, [row for row in scenes if row["config"] == config]
