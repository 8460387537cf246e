"""Functional regions: KGSW against walls alone and object clusters, as rooms and as units of search (SPEC 7).

Truth are the functional areas of each home; the same figures against its walled rooms stand under "rooms".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.making import PlaceSpec
from lab.evaluation.processes import in_processes
from lab.evaluation.regions.floors import floor_place_of, place_specs
from lab.evaluation.regions.methods import METHODS
from lab.evaluation.regions.plans import StoreyPlans, storey_plans
from lab.evaluation.regions.rows import Ground, score_regions, seen_share
from lab.figures.plans import draw_silhouettes
from services.regions.domain.baselines.hovsg import hovsg_floors
from services.regions.domain.survey import survey

_OURS, _GEOMETRIC, _CLUSTERS = "KGSW", "SysNav", "auto-K"
_ENOUGH_SEEN = 0.6
_NOT_A_FIGURE = frozenset({"config", "scene", "style", "floors"})


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """One home's rows, a config each; its plans; and auto-K's silhouettes on its first storey."""

    rows: list[Row]
    plans: tuple[StoreyPlans, ...]
    silhouettes: dict[int, float]


def run(options: Options) -> Result:
    """Means over homes, a row a method. InvalidInput for a data set that is unknown or has no rooms."""
    outcomes = in_processes(partial(_at, queries=options.queries), place_specs(options), options.workers)
    scenes = [row for outcome in outcomes for row in outcome.rows]
    return Result(
        rows=mean_rows(scenes),
        scenes=scenes,
        figures=_draw(outcomes, options.figures) if options.figures else (),
        notes=(
            "functions by the bundled table, without text features for words that it lacks",
            "one storey is compared with its own; a home's figures are over all its regions",
            *_unseen(scenes),
            _floors_found([outcome.rows[0]["floors"] for outcome in outcomes]),
        ),
    )


def mean_rows(scenes: Sequence[Row]) -> list[Row]:
    """A row per "config": every figure's mean over homes that have it, the accuracy's spread over them, and HydP of
    the homes with one floor and of those with more."""
    rows = []
    for config in dict.fromkeys(row["config"] for row in scenes):
        mine = [row for row in scenes if row["config"] == config]
        row = {"config": config, **_mean(mine), "acc_std": float(np.std([each["acc"] for each in mine]))}
        for name, several in (("HydP_one_floor", False), ("HydP_more_floors", True)):
            some = [each["HydP"] for each in mine if (each["floors"]["true"] > 1) is several]
            row[name] = float(np.mean(some)) if some else None
        rows.append(row)
    return rows


def _at(spec: PlaceSpec, queries: int) -> Outcome:
    place = floor_place_of(spec)
    surveyed = survey(place.evidence)
    ground = Ground.of(place, surveyed, queries)
    cuts = {name: method(place, surveyed) for name, method in METHODS.items()}
    named = {"scene": place.truth.name, "style": place.truth.style, "seen": seen_share(ground)}
    floors = {
        "true": len(place.truth.storeys),
        "found": len(surveyed),
        "found_hovsg": len(hovsg_floors(place.evidence)),
    }
    rows = {name: score_regions(ground, cut, cuts[_GEOMETRIC]) for name, cut in cuts.items()}
    return Outcome(
        [{"config": name, **named, **row, "floors": floors} for name, row in rows.items()],
        storey_plans(ground, cuts, rows),
        cuts[_CLUSTERS][0].silhouettes if surveyed else {},
    )


def _unseen(scenes: Sequence[Row]) -> tuple[str, ...]:
    """Names the homes that the walk hardly saw: no method can be right there."""
    homes = {row["scene"]: row["seen"] for row in scenes}
    poor = [f"{name} {share:.0%}" for name, share in homes.items() if share < _ENOUGH_SEEN]
    return (f"less than {_ENOUGH_SEEN:.0%} of the floor seen: {', '.join(poor)}",) if poor else ()


def _floors_found(floors: Sequence[dict[str, int]]) -> str:
    """How often the number of floors was right, by our way and by HOV-SG's."""
    ours, hovsg = (sum(each[way] == each["true"] for each in floors) for way in ("found", "found_hovsg"))
    return f"floors counted right in {ours} of {len(floors)} homes, by HOV-SG's histogram in {hovsg}"


def _mean(rows: Sequence[Row]) -> Row:
    columns = dict.fromkeys(column for row in rows for column in row if column not in _NOT_A_FIGURE)
    means: Row = {}
    for column in columns:
        values = [row[column] for row in rows if row.get(column) is not None]
        nested = [value for value in values if isinstance(value, dict)]
        means[column] = _mean(nested) if nested else float(np.mean(values)) if values else None
    return means


def _draw(outcomes: Sequence[Outcome], folder: Path) -> tuple[Path, ...]:
    """The plans of the homes where our accuracy is best and worst, and every home's silhouettes."""
    accuracy = [next(row["acc"] for row in outcome.rows if row["config"] == _OURS) for outcome in outcomes]
    if not accuracy:
        return ()
    chosen = {"best": int(np.argmax(accuracy)), "worst": int(np.argmin(accuracy))}
    if chosen["best"] == chosen["worst"]:
        chosen.pop("worst")
    drawn = [
        page.draw(folder / f"regions-{name}{f'-storey-{number}' if number else ''}.png")
        for name, of in chosen.items()
        for number, page in enumerate(outcomes[of].plans)
    ]
    curves = {outcome.rows[0]["scene"]: outcome.silhouettes for outcome in outcomes}
    return (*drawn, draw_silhouettes(folder / "regions-silhouettes.png", "auto-K: silhouette over K", curves))
