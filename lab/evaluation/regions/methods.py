"""The ways to cut a home into regions that are compared: KGSW as the service runs it, variants of it, and baselines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lab.evaluation.regions.floors import FloorPlace
from ovip.scene.types import F64, I32
from services.regions.config import Settings
from services.regions.domain import cells
from services.regions.domain.assembly import Cut, assemble
from services.regions.domain.baselines.auto_k import auto_k_rooms
from services.regions.domain.baselines.hovsg import hovsg_rooms
from services.regions.domain.baselines.sysnav import sysnav_rooms
from services.regions.domain.functions import functions_of
from services.regions.domain.partition import UNKNOWN_FUNCTION, PartitionParams
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects

Surveyed = tuple[SurveyedStorey, ...]


@dataclass(frozen=True, slots=True, eq=False)
class StoreyRegions:
    """One storey cut up. labels: `(R, C)` on the survey's grid, 0 = none, else 1 + index of a region.

    functions: of the regions, "" where the method names none. silhouettes: by K, of auto-K.
    """

    labels: I32
    functions: tuple[str, ...]
    silhouettes: dict[int, float]


Method = Callable[[FloorPlace, Surveyed], tuple[StoreyRegions, ...]]


def kgsw(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """As the service cuts: functions by the table, its own settings' numbers."""
    return assembled(place, surveyed, _table_functions(place, surveyed), service_params())


def kgsw_to_the_letter(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """With the paper's own numbers and nothing beyond its Algorithm 1."""
    return assembled(place, surveyed, _table_functions(place, surveyed), PartitionParams())


def kgsw_oracle_functions(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """Where every object's function is that of the area it is truly in: what a VLM that errs never would give."""
    functions = true_functions(place, surveyed)
    return assembled(place, surveyed, functions, service_params(), (True,) * len(functions))


def ours_but(**paper: Any) -> Method:
    """As the service cuts, some of its numbers the paper's."""

    def method(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
        functions = _table_functions(place, surveyed)
        return assembled(place, surveyed, functions, replace(service_params(), **paper))

    return method


def hovsg(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """HOV-SG's rooms, on our storeys."""
    return tuple(_nameless(hovsg_rooms(place.evidence, here.storey, here.space)) for here in surveyed)


def sysnav(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """SysNav-style rooms, on our storeys."""
    return tuple(_nameless(sysnav_rooms(place.evidence, here.storey, here.space)) for here in surveyed)


def auto_k(place: FloorPlace, surveyed: Surveyed) -> tuple[StoreyRegions, ...]:
    """Clusters of the same objects, grown over the same free space in the same way as KGSW's."""
    storeys = storeys_of_objects(surveyed, place.objects.centres)
    regions = []
    for number, here in enumerate(surveyed):
        at = cells_of(here, place.objects.centres[storeys == number])
        labels, clustering = auto_k_rooms(here.space.free, at, 0, service_params())
        regions.append(_nameless(labels, clustering.silhouettes))
    return tuple(regions)


_PAPER = PartitionParams()
METHODS: dict[str, Method] = {
    "KGSW": kgsw,
    "KGSW oracle functions": kgsw_oracle_functions,
    "KGSW to the letter": kgsw_to_the_letter,
    "KGSW, paper's DIL": ours_but(dilation=_PAPER.dilation),
    "KGSW, paper's growth": ours_but(growth=_PAPER.growth),
    "KGSW, no voting": ours_but(votes=_PAPER.votes),
    "KGSW, no merging": ours_but(merge_width=_PAPER.merge_width),
    "HOV-SG": hovsg,
    "SysNav": sysnav,
    "auto-K": auto_k,
}
"""Ours, what it would be with perfect functions, the paper's own, ours without each thing that it adds; baselines."""


def service_params() -> PartitionParams:
    """The numbers that the service runs with where nobody sets any."""
    return Settings.model_construct().partition


def true_functions(place: FloorPlace, surveyed: Surveyed) -> tuple[str, ...]:
    """Of each mapped object, the function of the true area at, or nearest to, its centre; unknown where nothing was
    surveyed."""
    if not surveyed:
        return (UNKNOWN_FUNCTION,) * len(place.objects.ids)
    centres = place.objects.centres
    storeys = storeys_of_objects(surveyed, centres)
    floors = [place.truth.storey_at(here.storey.z) for here in surveyed]
    return tuple(
        place.truth.function_at(floors[storey], centre[:2]) or UNKNOWN_FUNCTION
        for storey, centre in zip(storeys.tolist(), centres, strict=True)
    )


def cells_of(here: SurveyedStorey, points: F64) -> F64:
    """World points `(N, 2 or 3)` as (row, column), cell centres at integers -> `(N, 2)`."""
    return cells.cells_of(points, here.space.origin, here.space.resolution)


def _table_functions(place: FloorPlace, surveyed: Surveyed) -> tuple[str, ...]:
    """By the service's table, floor by floor; words that it lacks stay unknown (no perception to borrow from)."""
    objects = place.objects
    storeys = storeys_of_objects(surveyed, objects.centres)
    functions = [UNKNOWN_FUNCTION] * len(objects.ids)
    for storey in sorted(set(storeys.tolist())):
        members = np.flatnonzero(storeys == storey)
        floor = objects.only(members)
        for member, function in zip(
            members.tolist(), functions_of(floor.labels, floor.centres[:, :2], {}), strict=True
        ):
            functions[member] = function
    return tuple(functions)


def assembled(
    place: FloorPlace,
    surveyed: Surveyed,
    functions: tuple[str, ...],
    params: PartitionParams,
    told: tuple[bool, ...] = (),
) -> tuple[StoreyRegions, ...]:
    """The service's assembly of objects with these functions; told: as if a VLM had named them, see `votes_of`."""
    cut = assemble(surveyed, place.objects, functions, place.evidence, Cut.none(), params, told=told)
    of_region = {region.region_id: region.function for region in cut.partition.regions}
    return tuple(
        StoreyRegions(grid.regions.astype(np.int32), tuple(of_region[i] for i in grid.region_ids), {})
        for grid in cut.grids
    )


def _nameless(labels: I32, silhouettes: dict[int, float] | None = None) -> StoreyRegions:
    return StoreyRegions(labels, ("",) * int(labels.max(initial=0)), silhouettes or {})
