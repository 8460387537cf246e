"""Scores the partitions of one home: rooms matched to the truth, and regions as units of search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.evaluation.experiment import Row
from lab.evaluation.regions.floors import FloorPlace, Target, rooms_of
from lab.evaluation.regions.methods import StoreyRegions, Surveyed, cells_of
from lab.evaluation.scores.region_matching import Room, compat_score, strict_score
from lab.evaluation.scores.region_search import (
    NOWHERE,
    Units,
    open_targets,
    oracle_units,
    routing,
    strict_units,
)
from ovip.scene.grid import FREE, FloorGrid
from ovip.scene.types import F64, I32, I64, Bools
from ovip.scene.walking import traversable
from ovip.scene.words import normalize_word
from services.regions.domain.cells import labels_at
from services.regions.domain.functions import FUNCTIONS, prior_of
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects
from services.retrieval.domain.viewpoints import plan_waypoints

ROBOT_RADIUS = 0.25
"""Metres; who sweeps the viewpoints."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What every method's score of one home shares.

    floors: the true storey of each surveyed one. waypoints: cells `(V, 2)` from which a robot sees all of each
    storey. targets: what is sought.
    """

    place: FloorPlace
    surveyed: Surveyed
    floors: tuple[int, ...]
    waypoints: tuple[I64, ...]
    targets: tuple[Target, ...]

    @classmethod
    def of(cls, place: FloorPlace, surveyed: Surveyed, queries: int = 0) -> Ground:
        """queries: most targets, spread evenly over the home's list; 0 = all."""
        targets = place.truth.targets
        if 0 < queries < len(targets):
            targets = tuple(targets[i] for i in np.linspace(0, len(targets) - 1, queries).round().astype(int))
        return cls(
            place,
            surveyed,
            tuple(place.truth.storey_at(here.storey.z) for here in surveyed),
            tuple(_waypoints(number, here) for number, here in enumerate(surveyed)),
            targets,
        )


def score_regions(
    ground: Ground, cut: tuple[StoreyRegions, ...], geometric: tuple[StoreyRegions, ...]
) -> Row:
    """A row without names: compat columns, the same under "strict", and those against walled rooms under "rooms".

    geometric: SysNav's regions, which decide what lies in the open.
    """
    truth = ground.place.truth
    predicted = predicted_rooms(ground, cut)
    areas, rooms = rooms_of(truth.areas), rooms_of(truth.rooms)
    units, holder = units_of(ground, cut), holders(ground, cut)
    in_the_open = open_targets(units_of(ground, geometric), holders(ground, geometric))
    by_label = routing(units, holder, _routes_by_label(ground, cut))
    row: Row = {
        **compat_score(predicted, areas).columns,
        **oracle_units(units, holder, in_the_open).columns,
        **by_label.columns,
        "regions": len(predicted),
        "gt_regions": len(areas),
        "strict": {
            **strict_score(predicted, areas).columns,
            **strict_units(units, holder, in_the_open).columns,
            **by_label.columns,
        },
        "rooms": {
            **compat_score(predicted, rooms).columns,
            "gt_regions": len(rooms),
            "strict": strict_score(predicted, rooms).columns,
        },
    }
    if any(any(here.functions) for here in cut):
        by_function = routing(units, holder, _routes_by_function(ground, cut))
        row["by_function"] = by_function.columns
    return row


def seen_share(ground: Ground) -> float:
    """What share of the true areas' floor the walk saw as floor, 0..1."""
    truth = rooms_of(ground.place.truth.areas)
    sizes = np.array([len(room.points) for room in truth], np.float64)
    return float((sizes * seen_of(ground, truth)).sum() / max(sizes.sum(), 1))


def seen_of(ground: Ground, rooms: Sequence[Room]) -> F64:
    """What share of each of G rooms is free space of the survey `(G,)`, 0..1."""
    seen = np.zeros(len(rooms))
    for here, floor in zip(ground.surveyed, ground.floors, strict=True):
        for k, room in enumerate(rooms):
            if room.floor == floor:
                cells = np.rint(cells_of(here, room.points)).astype(int)
                inside = ((cells >= 0) & (cells < here.space.free.shape)).all(axis=1)
                seen[k] += here.space.free[tuple(cells[inside].T)].sum() / len(room.points)
    return seen


def predicted_rooms(ground: Ground, cut: tuple[StoreyRegions, ...]) -> list[Room]:
    """Every region as a cloud of its cells on the true storey nearest to it; empty ones are left out."""
    return [room for _, room in named_rooms(ground, cut)]


def named_rooms(ground: Ground, cut: tuple[StoreyRegions, ...]) -> list[tuple[str, Room]]:
    """The same, each with its region's function."""
    rooms = []
    for here, floor, regions in zip(ground.surveyed, ground.floors, cut, strict=True):
        for label, function in enumerate(regions.functions, start=1):
            cells = np.argwhere(regions.labels == label)
            if len(cells):
                points = (cells[:, ::-1] + 0.5) * here.space.resolution + np.asarray(here.space.origin)
                rooms.append((function, Room(floor, points)))
    return rooms


def units_of(ground: Ground, cut: tuple[StoreyRegions, ...]) -> Units:
    """Floor, viewpoints and mapped objects of each region, storey after storey. An object counts in the nearest one."""
    storeys = storeys_of_objects(ground.surveyed, ground.place.objects.centres)
    floor, area, viewpoints, objects, whole = [], [], [], [], []
    for number, (here, regions) in enumerate(zip(ground.surveyed, cut, strict=True)):
        count = len(regions.functions)
        mine = cells_of(here, ground.place.objects.centres[storeys == number])
        floor.append(np.full(count, number))
        area.append(_counts(regions.labels[here.space.free], count))
        viewpoints.append(_counts(regions.labels[tuple(ground.waypoints[number].T)], count))
        objects.append(_counts(labels_at(regions.labels, mine) + 1, count))
        whole.append((here.space.free.sum(), len(ground.waypoints[number]), len(mine)))
    total = np.array(whole, dtype=np.float64).reshape(-1, 3)
    return Units(
        floor=np.concatenate([np.zeros(0, np.int64), *floor]),
        area=np.concatenate([np.zeros(0), *area]),
        viewpoints=np.concatenate([np.zeros(0), *viewpoints]),
        objects=np.concatenate([np.zeros(0), *objects]),
        whole_area=total[:, 0],
        whole_viewpoints=total[:, 1],
        whole_objects=total[:, 2],
    )


def holders(ground: Ground, cut: tuple[StoreyRegions, ...]) -> I64:
    """The region whose cells lie under each target's centre -> `(T,)`, -1 for none."""
    first = np.cumsum([0, *(len(regions.functions) for regions in cut)])
    holder = np.full(len(ground.targets), NOWHERE, np.int64)
    for number, (here, floor, regions) in enumerate(zip(ground.surveyed, ground.floors, cut, strict=True)):
        for t, target in enumerate(ground.targets):
            label = _label_at(regions.labels, here, target.centre) if target.floor == floor else 0
            if label and holder[t] == NOWHERE:
                holder[t] = first[number] + label - 1
    return holder


def _routes_by_label(ground: Ground, cut: tuple[StoreyRegions, ...]) -> list[tuple[int, ...]]:
    """The regions of the mapped objects that bear each target's label."""
    objects = ground.place.objects
    storeys = storeys_of_objects(ground.surveyed, objects.centres)
    found: dict[str, set[int]] = {}
    first = 0
    for number, (here, regions) in enumerate(zip(ground.surveyed, cut, strict=True)):
        mine = np.flatnonzero(storeys == number)
        at = labels_at(regions.labels, cells_of(here, objects.centres[mine]))
        for member, region in zip(mine.tolist(), at.tolist(), strict=True):
            if region != NOWHERE:
                found.setdefault(normalize_word(objects.labels[member]), set()).add(first + region)
        first += len(regions.functions)
    return [tuple(sorted(found.get(normalize_word(target.label), ()))) for target in ground.targets]


def _routes_by_function(ground: Ground, cut: tuple[StoreyRegions, ...]) -> list[tuple[int, ...]]:
    """The regions of the function that each target's word speaks for most; none for a word that speaks for none."""
    functions = [function for regions in cut for function in regions.functions]
    routes: dict[str, tuple[int, ...]] = {}
    for target in ground.targets:
        if target.label not in routes:
            prior = prior_of(target.label)
            likely = None if prior is None else FUNCTIONS[int(prior.argmax())]
            routes[target.label] = tuple(k for k, function in enumerate(functions) if function == likely)
    return [routes[target.label] for target in ground.targets]


def _waypoints(number: int, here: SurveyedStorey) -> I64:
    space = here.space
    grid = FloorGrid(
        number, space.origin, space.resolution, space.occupancy, np.zeros(space.free.shape, np.uint16)
    )
    seen: Bools = space.free & (space.occupancy == FREE)
    return np.array(plan_waypoints(grid, seen, traversable(grid, ROBOT_RADIUS)), np.int64).reshape(-1, 2)


def _counts(labels: I32 | I64, count: int) -> F64:
    """How many of the labels are 1, .., count -> `(count,)`."""
    return np.bincount(labels.ravel(), minlength=count + 1)[1 : count + 1].astype(np.float64)


def _label_at(labels: I32, here: SurveyedStorey, point: F64) -> int:
    row, column = np.rint(cells_of(here, point[None])[0]).astype(int)
    inside = 0 <= row < labels.shape[0] and 0 <= column < labels.shape[1]
    return int(labels[row, column]) if inside else 0
