"""What a map got wrong, by name: instances missed, mapped twice, and objects of nothing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.scoring import CUTOFF, Mapped
from lab.evaluation.scores.instance import NOTHING
from ovip.scene.types import I64


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """instance_of: `(N,)` the true instance that each object is of, NOTHING for none.

    found: share of the instances that some object is of. duplicates: share of the objects of an instance that
    another object, of more points, is of too. spurious: share of all objects that are of nothing.
    """

    instance_of: I64
    found: float
    duplicates: float
    spurious: float


def diagnosed(place: Place, scene: Mapped) -> Diagnosis:
    """Each object is of the instance that most of its points lie on, within the cut-off, if a third of them do."""
    instance_of = _instances(place, scene)
    of_something = instance_of[instance_of != NOTHING]
    distinct = len(np.unique(of_something))
    return Diagnosis(
        instance_of,
        found=distinct / max(1, len(place.area_ids)),
        duplicates=(len(of_something) - distinct) / max(1, len(of_something)),
        spurious=1 - len(of_something) / max(1, len(scene.objects)),
    )


def _instances(place: Place, scene: Mapped) -> I64:
    of = np.full(len(scene.objects), NOTHING, np.int64)
    if not len(scene.points) or not len(place.points):
        return of
    distance, nearest = cKDTree(place.points).query(scene.points, distance_upper_bound=CUTOFF)
    near = np.isfinite(distance)
    owners, instances = scene.owners[near], place.instances[nearest[near]]
    sizes = np.bincount(scene.owners, minlength=len(of))
    pairs, counts = np.unique(np.stack([owners, instances]), axis=1, return_counts=True)
    for (owner, instance), count in sorted(
        zip(pairs.T.tolist(), counts.tolist(), strict=True), key=lambda p: p[1]
    ):
        if count >= sizes[owner] / 3:
            of[owner] = instance  # the last has most points
    return of
