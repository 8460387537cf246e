"""auto-K over every K: where the silhouette would choose, and what each choice is worth as rooms (Tables autok and
silhouette-sweep of the paper). On the ground floor, as there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lab.evaluation.experiment import Row
from lab.evaluation.regions.floors import rooms_of
from lab.evaluation.regions.methods import StoreyRegions, cells_of, service_params
from lab.evaluation.regions.rows import Ground, predicted_rooms
from lab.evaluation.scores.region_matching import compat_score, strict_score
from ovip.scene.types import F64
from services.regions.domain.baselines.auto_k import AutoKParams, auto_k_rooms
from services.regions.domain.survey import storeys_of_objects

FEWEST, MOST = 2, 12
_COLLAPSED = 0.5


@dataclass(frozen=True, slots=True)
class Sweep:
    """One home's ground floor. aspect: of the objects' cloud, its longer over its shorter side along its own axes.

    areas: true ones. silhouettes: by K; acc, strict_acc: of the rooms that this many clusters give. chosen: K of the
    highest silhouette, None without objects.
    """

    scene: str
    style: str
    aspect: float
    areas: int
    silhouettes: dict[int, float]
    acc: dict[int, float]
    strict_acc: dict[int, float]

    @property
    def chosen(self) -> int | None:
        """Ties go to the smaller K."""
        scores = {k: score for k, score in self.silhouettes.items() if FEWEST <= k <= MOST}
        return max(sorted(scores), key=lambda k: scores[k]) if scores else None

    @property
    def columns(self) -> Row:
        """As a result's JSON holds it. collapsed: at most half as many clusters chosen as there are areas."""
        chosen = self.chosen
        return {
            "scene": self.scene,
            "style": self.style,
            "aspect": round(self.aspect, 2),
            "areas": self.areas,
            "chosen": chosen,
            "collapsed": chosen is not None and chosen <= _COLLAPSED * self.areas,
            "silhouettes": {str(k): round(score, 3) for k, score in self.silhouettes.items()},
            "acc": {str(k): round(score, 3) for k, score in self.acc.items()},
            "strict_acc": {str(k): round(score, 3) for k, score in self.strict_acc.items()},
            "acc_at_chosen": None if chosen is None else round(self.acc[chosen], 3),
            "acc_at_areas": None if self.areas not in self.acc else round(self.acc[self.areas], 3),
        }


def sweep(ground: Ground) -> Sweep:
    """Clusters each K from 2 to 12, and as many as there are areas, on the home's lowest storey that was surveyed."""
    truth = ground.place.truth
    floor = ground.floors[0] if ground.floors else 0
    areas = rooms_of(area for area in truth.areas if area.floor == floor)
    silhouettes, acc, strict_acc = dict[int, float](), dict[int, float](), dict[int, float]()
    points = _points(ground)
    for k in sorted({*range(FEWEST, MOST + 1), max(len(areas), FEWEST)}) if ground.surveyed else ():
        here = ground.surveyed[0]
        only = AutoKParams(fewest=k, most=k)
        labels, clustering = auto_k_rooms(here.space.free, cells_of(here, points), 0, service_params(), only)
        if k not in clustering.silhouettes:
            continue
        regions = StoreyRegions(labels, ("",) * int(labels.max(initial=0)), {})
        predicted = predicted_rooms(ground, (regions, *_nothing(ground)))
        silhouettes[k] = clustering.silhouettes[k]
        acc[k] = compat_score(predicted, areas).accuracy
        strict_acc[k] = strict_score(predicted, areas).accuracy
    return Sweep(truth.name, truth.style, aspect_of(points), len(areas), silhouettes, acc, strict_acc)


def aspect_of(points: F64) -> float:
    """Longer over shorter side of `(N, 2)` points along their principal axes; 1 where they have no extent."""
    if len(points) < 2:
        return 1.0
    centred = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    sides = np.ptp(centred @ axes.T, axis=0)
    return float(sides.max() / sides.min()) if len(sides) == 2 and sides.min() > 1e-9 else 1.0


def _points(ground: Ground) -> F64:
    """x, y of the objects on the lowest storey `(N, 2)`."""
    centres = ground.place.objects.centres
    return centres[storeys_of_objects(ground.surveyed, centres) == 0, :2]


def _nothing(ground: Ground) -> tuple[StoreyRegions, ...]:
    """The other storeys, uncut."""
    return tuple(
        StoreyRegions(np.zeros(here.space.free.shape, np.int32), (), {}) for here in ground.surveyed[1:]
    )
