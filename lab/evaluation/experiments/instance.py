"""Native-instance quality: how well mapped objects are the scene's own instances, by size."""

from __future__ import annotations

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.pictures import with_maps
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.runs import score_places
from lab.evaluation.mapping.scoring import instance_columns, mapped, transfer
from lab.simulation.imperfect import read_cache
from ovip.scene.types import DetectionBatch
from services.mapper.domain.presets import PRESETS

CONFIGS = ("overlap", "ours")


def run(options: Options) -> Result:
    """Rows: the overlap baseline, and what the mapper runs."""
    return with_maps(score_places(score, options), options, CONFIGS)


def score(place: Place) -> list[Row]:
    """The place's row of each configuration."""
    _, batches = read_cache(place.cache)
    kept = list(batches)
    return [_row(place, config, kept) for config in CONFIGS]


def _row(place: Place, config: str, batches: list[DetectionBatch]) -> Row:
    scene = mapped(batches, PRESETS[config])
    seen = transfer(scene, place.points)
    return {
        "config": config,
        "scene": place.name,
        **instance_columns(place, seen.compat),
        "objects": len(scene.objects),
        "gt_objects": len(place.area_ids),
        "strict": instance_columns(place, seen.strict),
    }
