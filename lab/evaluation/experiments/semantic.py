"""Semantic quality of the final map under the ConceptGraphs evaluator, by feature and with the detector's labels."""

from __future__ import annotations

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.pictures import with_maps
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.runs import score_places
from lab.evaluation.mapping.scoring import N_EXCLUDE, Judged, Mapped, judged, mapped, semantic_scores
from lab.simulation.imperfect import read_cache
from services.mapper.domain.presets import PRESETS

LAMBDAS = (0.3, 1.0)
OTHER_EXCLUDES = (4, 1)


def run(options: Options) -> Result:
    """Rows: the overlap baseline, ours, and ours with labels mixed in.

    Columns mAcc_4, mAcc_1 and so on leave fewer classes out than the paper's six.
    """
    return with_maps(score_places(score, options), options)


def score(place: Place) -> list[Row]:
    """The place's rows."""
    batches = list(read_cache(place.cache)[1])
    baseline, ours = (mapped(batches, PRESETS[name]) for name in ("overlap", "ours"))
    rows = _rows(place, baseline, {"overlap": 0.0})
    return rows + _rows(place, ours, {"ours": 0.0, **{f"ours, labels {lam:g}": lam for lam in LAMBDAS}})


def _rows(place: Place, scene: Mapped, configs: dict[str, float]) -> list[Row]:
    """A row for each lambda, by its name."""
    points = {n: judged(place, scene, n) for n in (N_EXCLUDE, *OTHER_EXCLUDES)}
    return [_row(place, scene, points, config, lam) for config, lam in configs.items()]


def _row(place: Place, scene: Mapped, points: dict[int, Judged], config: str, lam: float) -> Row:
    columns: tuple[Row, Row] = ({}, {})
    for n, at in points.items():
        suffix = "" if n == N_EXCLUDE else f"_{n}"
        for row, result in zip(columns, semantic_scores(place, scene, at, lam), strict=True):
            row |= {f"{name}{suffix}": value for name, value in result.columns.items()}
    compat, strict = columns
    names = {"config": config, "scene": place.name, "lambda": lam}
    return {**names, **compat, "objects": len(scene.objects), "strict": strict}
