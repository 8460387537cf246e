"""Functional regions: KGSW against walls alone and object clusters, as rooms and as units of search (SPEC 7).

Truth are the functional areas of each home; the same figures against its walled rooms stand under "rooms".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.making import PlaceSpec
from lab.evaluation.processes import in_processes
from lab.evaluation.regions.averages import mean_rows, style_rows
from lab.evaluation.regions.diagnosis import Verdict, diagnose
from lab.evaluation.regions.expectations import BASELINES, OURS, expectations
from lab.evaluation.regions.floors import FloorPlace, floor_place_of, place_specs
from lab.evaluation.regions.methods import METHODS
from lab.evaluation.regions.plans import StoreyPlans, storey_plans
from lab.evaluation.regions.rows import Ground, score_regions, seen_share
from lab.evaluation.regions.sweep import Sweep, sweep
from lab.figures.plans import KCurve, draw_silhouettes
from services.regions.domain.baselines.hovsg import hovsg_floors
from services.regions.domain.survey import survey

_GEOMETRIC = "SysNav"
_ENOUGH_SEEN = 0.6
_WORST = 2


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """One home's rows, a config each; its plans; what went wrong with ours; and auto-K over every K."""

    rows: list[Row]
    plans: tuple[StoreyPlans, ...]
    diagnosis: Row
    sweep: Sweep

    @property
    def ours(self) -> Row:
        return next(row for row in self.rows if row["config"] == OURS)


@dataclass(frozen=True, slots=True)
class RegionsResult(Result):
    """styles: means over the homes of each kind. expectations: the paper's, met or missed. worst: the homes where ours
    is least right, by strict accuracy, and why. silhouettes: auto-K over every K, a home each.
    """

    styles: list[Row] = field(default_factory=list)
    expectations: list[Row] = field(default_factory=list)
    worst: list[Row] = field(default_factory=list)
    silhouettes: list[Row] = field(default_factory=list)


def run(options: Options) -> RegionsResult:
    """Means over homes, a row a method. InvalidInput for a data set that is unknown or has no rooms."""
    outcomes = in_processes(partial(_at, queries=options.queries), place_specs(options), options.workers)
    return result_of(outcomes, options.figures)


def result_of(outcomes: Sequence[Outcome], figures: Path | None = None) -> RegionsResult:
    """What the homes tell together, drawn into a folder where one is given."""
    scenes = [row for outcome in outcomes for row in outcome.rows]
    rows = mean_rows(scenes)
    judged, worst = expectations(rows), _worst(outcomes)
    return RegionsResult(
        rows=rows,
        scenes=scenes,
        figures=_draw(outcomes, worst, figures) if figures else (),
        notes=(
            "functions by the bundled table, without text features for words that it lacks",
            "one storey is compared with its own; a home's figures are over all its regions",
            *_unseen(scenes),
            _floors_found([outcome.ours["floors"] for outcome in outcomes]),
            *(_told(row) for row in judged if row["met"] is not None),
            *(note for home in worst for note in _told_of(home)),
        ),
        styles=style_rows([row for row in scenes if row["config"] in (OURS, *BASELINES)]),
        expectations=judged,
        worst=[_summary(home) for home in worst],
        silhouettes=[outcome.sweep.columns for outcome in outcomes],
    )


def outcome_at(place: FloorPlace, queries: int = 0) -> Outcome:
    """Every method on one home; queries: most targets, 0 = all."""
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
    diagnosis = diagnose(ground, cuts[OURS])
    return Outcome(
        [{"config": name, **named, **row, "floors": floors} for name, row in rows.items()],
        storey_plans(ground, cuts, rows, diagnosis),
        diagnosis.columns,
        sweep(ground),
    )


def _at(spec: PlaceSpec, queries: int) -> Outcome:
    return outcome_at(floor_place_of(spec), queries)


def _worst(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """The homes where ours is least right; ties as they come."""
    return sorted(outcomes, key=lambda outcome: outcome.ours["strict"]["acc"])[:_WORST]


def _summary(home: Outcome) -> Row:
    named = {name: home.ours[name] for name in ("scene", "style", "seen", "acc", "regions", "gt_regions")}
    return {**named, "strict_acc": home.ours["strict"]["acc"], **home.diagnosis}


def _named(home: Outcome) -> str:
    return str(home.ours["scene"])


def _told(row: Row) -> str:
    met = "met" if row["met"] else "MISSED"
    strict = {True: "met", False: "missed", None: "not known"}[row["strict_met"]]
    return f"expected {row['expectation']} {row['bound']}: {row['value']:.3f}, {met} (strict: {strict})"


def _told_of(home: Outcome) -> list[str]:
    """Which areas of a home were found, and of each other one why it was not."""
    found = [area["area"] for area in home.diagnosis["areas"] if area["verdict"] == Verdict.FOUND.value]
    rightly = f"found with their functions: {', '.join(found) or 'none'}"
    return [f"{_named(home)}: {told}" for told in (rightly, *home.diagnosis["why"])]


def _unseen(scenes: Sequence[Row]) -> tuple[str, ...]:
    """Names the homes that the walk hardly saw: no method can be right there."""
    homes = {row["scene"]: row["seen"] for row in scenes}
    poor = [f"{name} {share:.0%}" for name, share in homes.items() if share < _ENOUGH_SEEN]
    return (f"less than {_ENOUGH_SEEN:.0%} of the floor seen: {', '.join(poor)}",) if poor else ()


def _floors_found(floors: Sequence[dict[str, int]]) -> str:
    """How often the number of floors was right, by our way and by HOV-SG's."""
    ours, hovsg = (sum(each[way] == each["true"] for each in floors) for way in ("found", "found_hovsg"))
    return f"floors counted right in {ours} of {len(floors)} homes, by HOV-SG's histogram in {hovsg}"


def _draw(outcomes: Sequence[Outcome], worst: Sequence[Outcome], folder: Path) -> tuple[Path, ...]:
    """The plans of the worst homes and of the best one, and every home's silhouettes."""
    chosen = {f"worst-{number}": home for number, home in enumerate(worst, start=1)}
    best = max(outcomes, key=lambda outcome: outcome.ours["strict"]["acc"], default=None)
    if best is not None and best not in worst:
        chosen["best"] = best
    drawn = [
        page.draw(folder / f"regions-{name}{f'-storey-{number}' if number else ''}.png")
        for name, home in chosen.items()
        for number, page in enumerate(home.plans)
    ]
    curves = [
        KCurve(_named(home), home.sweep.silhouettes, home.sweep.acc, home.sweep.chosen, home.sweep.areas)
        for home in outcomes
    ]
    return (*drawn, draw_silhouettes(folder / "regions-silhouettes.png", "auto-K over K", curves))
