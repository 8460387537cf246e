"""Chooses tau and the upkeep's thresholds on training homes: sweeps one after another, draws curves, writes down."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from lab.evaluation.experiment import TEST_SEED, Options, Result, Row
from lab.evaluation.mapping.making import PlaceSpec, place_of, specs_of
from lab.evaluation.mapping.scoring import instance_columns, judged, mapped, semantic_scores, transfer
from lab.evaluation.processes import in_processes
from lab.evaluation.rows import scene_means
from lab.figures.curves import draw_curves
from lab.simulation.imperfect import read_cache
from services.mapper.domain.params import MapParams

PLATEAU = 0.5
"""Points of the criterion within which values are as good as the best one."""

CRITERION = "mean of strict PQ, strict F-mIoU and strict recall of small objects (percent, scene mean)"


@dataclass(frozen=True, slots=True)
class Sweep:
    """One setting: which part of a map's params has it, and the values it takes.

    least: values below are measured and drawn, and never chosen.
    """

    name: str
    part: str
    values: tuple[float, ...]
    least: float = 0.0

    def put(self, params: MapParams, value: float) -> MapParams:
        """The params with this value."""
        changed = replace(getattr(params, self.part), **{self.name: value})
        return replace(params, **{self.part: changed})


SWEEPS = (
    # below 1 - alpha, looks alone would join like things a room apart, and pruning would not be exact
    Sweep("tau", "association", (0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.6), least=1.0),
    Sweep("merge_overlap", "upkeep", (0.2, 0.35, 0.5, 0.65, 0.8)),
    Sweep("merge_inside", "upkeep", (0.5, 0.6, 0.7, 0.8, 0.9)),
    Sweep("merge_similarity", "upkeep", (0.7, 0.75, 0.8, 0.85, 0.9, 0.95)),
    Sweep("merge_mutual", "upkeep", (0.25, 0.35, 0.5, 0.65, 0.8, 1.0)),
    Sweep("confirm_frames", "upkeep", (2, 3, 4, 5, 6)),
)


def run(options: Options) -> Result:
    """A row per setting and value, in the order swept; each setting is chosen before the next is swept."""
    specs = specs_of(training(options))
    params, scenes, chosen = MapParams(), [], {}
    for sweep in SWEEPS:
        found = _swept(sweep, params, specs, options.workers)
        scenes += found
        chosen[sweep.name] = choice(sweep, [row["criterion"] for row in scene_means(found)])
        params = sweep.put(params, chosen[sweep.name])
    rows = scene_means(scenes)
    how = _how(specs, chosen)
    if options.figures is None:
        return Result(rows, scenes, notes=(how,))
    figures = tuple(_drawn(sweep, rows, chosen[sweep.name], options.figures) for sweep in SWEEPS)
    plain = {"chosen": chosen, "how": how, "rows": rows}
    (options.figures / "calibration.json").write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    return Result(rows, scenes, figures, (how,))


def training(options: Options) -> Options:
    """The options with homes that no figure is reported on: seeds that would reach the test homes' start at 0."""
    return options if options.seed + options.homes <= TEST_SEED else replace(options, seed=0)


def choice(sweep: Sweep, scores: Sequence[float]) -> float:
    """The plateau's middle among the values that may be chosen."""
    allowed = [i for i, value in enumerate(sweep.values) if value >= sweep.least]
    return plateau_middle([sweep.values[i] for i in allowed], [scores[i] for i in allowed])


def plateau_middle(values: Sequence[float], scores: Sequence[float]) -> float:
    """The middle value of the run of neighbours around the best score (the first of equals) that are as good as it.

    As good: within PLATEAU. Of two middle values the first.
    """
    best = max(range(len(scores)), key=lambda i: scores[i])
    good = [score >= scores[best] - PLATEAU for score in scores]
    low, high = best, best
    while low > 0 and good[low - 1]:
        low -= 1
    while high + 1 < len(good) and good[high + 1]:
        high += 1
    return values[(low + high) // 2]


def _swept(sweep: Sweep, params: MapParams, specs: Sequence[PlaceSpec], workers: int) -> list[Row]:
    candidates = [(f"{sweep.name} = {value:g}", sweep.put(params, value)) for value in sweep.values]
    return [row for rows in in_processes(partial(_scored, candidates), specs, workers) for row in rows]


def _scored(candidates: Sequence[tuple[str, MapParams]], spec: PlaceSpec) -> list[Row]:
    place = place_of(spec)
    batches = list(read_cache(place.cache)[1])
    rows = []
    for config, params in candidates:
        scene = mapped(batches, params)
        _, strict = semantic_scores(place, scene, judged(place, scene))
        instances = instance_columns(place, transfer(scene, place.points).strict)
        rows.append(
            {
                "config": config,
                "scene": place.name,
                "criterion": _criterion(strict.frequency_iou, instances),
                **strict.columns,
                **instances,
                "objects": len(scene.objects),
                "gt_objects": len(place.area_ids),
            }
        )
    return rows


def _criterion(frequency_iou: float, instances: dict[str, float]) -> float:
    return (frequency_iou + 100 * (instances["PQ"] + instances.get("recall_small", 0.0))) / 3


def _how(specs: Sequence[PlaceSpec], chosen: dict[str, float]) -> str:
    where = specs[0].dataset or f"simulated homes of seeds {specs[0].seed} to {specs[-1].seed}"
    values = ", ".join(f"{name} {value:g}" for name, value in chosen.items())
    return (
        f"chosen on {where}: {values}; each is the middle of the plateau within {PLATEAU} points of the best "
        f"{CRITERION}, one setting after another. tau and merge_similarity are for features like the lab's "
        "(OpenCLIP geometry); another encoder wants its own."
    )


def _drawn(sweep: Sweep, rows: list[Row], chosen: float, folder: Path) -> Path:
    here = [row for row in rows if row["config"].startswith(f"{sweep.name} = ")]
    curves = {
        "criterion": [float(row["criterion"]) for row in here],
        "strict PQ, percent": [100 * float(row["PQ"]) for row in here],
        "strict F-mIoU": [float(row["F-mIoU"]) for row in here],
        "small-object recall, percent": [100 * float(row["recall_small"]) for row in here],
    }
    return draw_curves(
        folder / f"calibrate_{sweep.name}.png", sweep.values, curves, sweep.name, "percent", chosen
    )
