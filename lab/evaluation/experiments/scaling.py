"""How the map's quality, size and cost grow with the home."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.diagnosis import diagnosed
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.runs import over_places
from lab.evaluation.mapping.scoring import instance_columns, judged, read_map, semantic_scores, transfer
from lab.figures.curves import draw_curves
from lab.simulation.imperfect import read_cache
from services.mapper.domain.object_map import map_of
from services.mapper.domain.presets import PRESETS

CONFIG = "ours"
_NOTE = (
    "ms_per_frame is the mapper alone, on this machine while it ran the protocol; it is no part of the scores"
)


def run(options: Options) -> Result:
    """A row per place, from few things to many: quality, duplicates, milliseconds a frame, bytes of the map."""
    rows = sorted(over_places(score, options), key=lambda row: (row["gt_objects"], row["config"]))
    scenes = [{**row, "scene": row["config"], "config": CONFIG} for row in rows]
    result = Result(rows=rows, scenes=scenes, notes=(_NOTE,))
    if options.figures is None:
        return result
    return replace(result, figures=_drawn(rows, options.figures))


def score(place: Place) -> Row:
    """The place's row."""
    batches = list(read_cache(place.cache)[1])
    began = time.process_time()
    object_map = map_of(batches, PRESETS[CONFIG])
    seconds = time.process_time() - began
    scene = read_map(object_map)
    seen, wrong = transfer(scene, place.points), diagnosed(place, scene)
    compat, strict = semantic_scores(place, scene, judged(place, scene))
    return {
        "config": place.name,
        "gt_objects": len(place.area_ids),
        "frames": place.frames,
        "detections": place.detections,
        "objects": len(scene.objects),
        "found": wrong.found,
        "duplicates": wrong.duplicates,
        "spurious": wrong.spurious,
        **instance_columns(place, seen.compat),
        **compat.columns,
        "ms_per_frame": 1000 * seconds / max(1, place.frames),
        "bytes": len(object_map.segment()),
        "strict": {**strict.columns, **instance_columns(place, seen.strict)},
    }


def _drawn(rows: list[Row], folder: Path) -> tuple[Path, ...]:
    x = [float(row["gt_objects"]) for row in rows]
    shares = {name: [float(row[name]) for row in rows] for name in ("found", "PQ", "duplicates", "spurious")}
    costs = {
        "milliseconds a frame": [float(row["ms_per_frame"]) for row in rows],
        "map, MB": [float(row["bytes"]) / 1e6 for row in rows],
    }
    return (
        draw_curves(folder / "scaling_quality.png", x, shares, "things in the home", "share"),
        draw_curves(folder / "scaling_cost.png", x, costs, "things in the home", "cost"),
    )
