"""What each part of the mapper adds on one detection cache: overlap, +IPSM, +LAMP, +AWF, and our upkeep with them."""

from __future__ import annotations

import numpy as np

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.pictures import with_maps
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.runs import score_places
from lab.evaluation.mapping.scoring import (
    Mapped,
    Transfer,
    detected_classes,
    instance_columns,
    judged,
    label_recall,
    mapped,
    semantic_scores,
    transfer,
)
from lab.evaluation.scores.instance import swallowed_classes
from lab.simulation.imperfect import read_cache
from ovip.scene.types import I64
from services.mapper.domain.presets import PRESETS

BASELINE = "overlap"


def run(options: Options) -> Result:
    """A row per configuration: semantic and instance scores, recall by size, and of the classes overlap swallowed."""
    return with_maps(score_places(score, options), options)


def score(place: Place) -> list[Row]:
    """The place's row of each preset."""
    _, batches = read_cache(place.cache)
    kept = list(batches)
    maps = {name: mapped(kept, params) for name, params in PRESETS.items()}
    seen = {name: transfer(scene, place.points) for name, scene in maps.items()}
    baseline = label_recall(place, maps[BASELINE], seen[BASELINE].compat)
    swallowed = swallowed_classes(baseline, detected_classes(place, kept))
    return [row_of(place, name, maps[name], seen[name], swallowed) for name in PRESETS]


def row_of(place: Place, config: str, scene: Mapped, seen: Transfer, swallowed: I64) -> Row:
    """One configuration's row. swallowed: the classes that the overlap map absorbed."""
    compat, strict = semantic_scores(place, scene, judged(place, scene))
    return {
        "config": config,
        "scene": place.name,
        **compat.columns,
        **instance_columns(place, seen.compat),
        "swallowed_recall": _recall(place, scene, seen.compat, swallowed),
        "objects": len(scene.objects),
        "gt_objects": len(place.area_ids),
        "swallowed_classes": len(swallowed),
        "strict": {
            **strict.columns,
            **instance_columns(place, seen.strict),
            "swallowed_recall": _recall(place, scene, seen.strict, swallowed),
        },
    }


def _recall(place: Place, scene: Mapped, seen: I64, classes: I64) -> float | None:
    """Mean label-area recall of `classes`, None for no class."""
    return float(np.mean(label_recall(place, scene, seen)[classes])) if len(classes) else None
