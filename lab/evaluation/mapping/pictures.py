"""Pictures of a place's map, storey by storey."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from lab.evaluation.experiment import Options, Result
from lab.evaluation.mapping.places import Place, Storey
from lab.evaluation.mapping.runs import over_places
from lab.evaluation.mapping.scoring import Mapped, mapped
from lab.figures.homes import draw_home
from lab.figures.maps import MapLayer, draw_map
from lab.simulation.generate import make_home
from lab.simulation.imperfect import read_cache
from services.mapper.domain.presets import PRESETS

HOMES_DRAWN = 2


def with_maps(result: Result, options: Options, configs: Sequence[str] = ("overlap", "ours")) -> Result:
    """The result with pictures, where figures are asked for: the first homes, and every map by each configuration."""
    if options.figures is None:
        return result
    homes = draw_homes(options) if options.dataset is None else []
    drawn = over_places(partial(draw_maps, options.figures, tuple(configs)), options)
    return replace(result, figures=(*result.figures, *homes, *(path for paths in drawn for path in paths)))


def draw_homes(options: Options) -> list[Path]:
    """Writes home_NAME.png of the first two simulated homes: two views, and every storey from above."""
    assert options.figures is not None
    options.figures.mkdir(parents=True, exist_ok=True)
    homes = [make_home(options.seed + i) for i in range(min(HOMES_DRAWN, options.homes))]
    return [draw_home(home, options.figures / f"home_{_slug(home.name)}.png") for home in homes]


def draw_maps(folder: Path, configs: Sequence[str], place: Place) -> list[Path]:
    """Writes map_PLACE_CONFIG.png of each configuration, and returns their paths."""
    batches = list(read_cache(place.cache)[1])
    drawn = []
    for config in configs:
        scene = mapped(batches, PRESETS[config])
        layers = [_layer(storey, scene) for storey in place.storeys] or [_all(scene)]
        title = f"{place.name}, {config}: {len(scene.objects)} objects of {len(place.area_ids)} things"
        drawn.append(draw_map(folder / f"map_{_slug(place.name)}_{_slug(config)}.png", layers, title))
    return drawn


def _layer(storey: Storey, scene: Mapped) -> MapLayer:
    """What of the map lies on the storey."""
    on = [i for i, o in enumerate(scene.objects) if storey.low - 0.3 <= o.centroid[2] < storey.high]
    return MapLayer(
        name=storey.name,
        clouds=[scene.points[scene.owners == i] for i in on],
        labels=[scene.objects[i].label for i in on],
        outlines=[(name, np.array(ring)) for name, ring in storey.areas],
    )


def _all(scene: Mapped) -> MapLayer:
    clouds = [scene.points[scene.owners == i] for i in range(len(scene.objects))]
    return MapLayer("the map", clouds, [o.label for o in scene.objects])


def _slug(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
