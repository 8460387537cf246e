"""Relations against a home's own: on clouds lifted by true masks, and as a map of detections has them (SPEC 2.9)."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from scipy.spatial import cKDTree

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.mapping.making import PlaceSpec, place_of
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.scoring import CUTOFF, Mapped, mapped
from lab.evaluation.processes import in_processes
from lab.evaluation.scores.relations import (
    Fact,
    KindCounts,
    holder_counts,
    kind_counts,
    loose_counts,
)
from lab.evaluation.true_clouds import true_clouds
from lab.simulation.home import Home
from lab.simulation.home import RelationKind as TrueKind
from lab.simulation.imperfect import read_cache
from ovip.errors import InvalidInput
from ovip.scene.boxes import box_of
from ovip.scene.types import F32, RelationKind
from services.mapper.domain.params import MapParams
from services.mapper.domain.relations import Body, RelationParams, reach, relations_of

Tally = dict[str, tuple[KindCounts, KindCounts]]
"""Counts by column: as a reader would judge, and to the letter."""

_KINDS = {
    TrueKind.ON: RelationKind.ON,
    TrueKind.IN: RelationKind.IN,
    TrueKind.ATTACHED: RelationKind.ATTACHED_TO,
    TrueKind.NEXT: RelationKind.NEXT_TO,
}
_HOLDS = frozenset({"floor", "wall", "ceiling"})
_MOSTLY = 0.5  # of a mapped object's points lie on one thing, where it is that thing
_NOTES = (
    "truth is how things were placed; pairs count whose two things were both seen (mapped: both mapped)",
    "things: clouds lifted by true masks, without floors, walls and ceilings; structure: with them",
    "noisy camera: as structure, by a real camera's depth and a drifting pose, cleaned as the mapper cleans",
    "mapped: what the map of imperfect detections says, but for what it says of two parts of one thing",
    "on is right for what is in the other, too, for it rests on its board; strict: to the letter",
    "holder: the right other, whether on, in or attached to it",
    "things on different boards of a shelf are next to each other in truth only",
    "things that stand on two others equally high may be next to each other on the map only",
)


def run(options: Options) -> Result:
    """Precision (P) and recall (R) by kind, over the relations of all homes together; InvalidInput for a data set."""
    if options.dataset is not None:
        raise InvalidInput(
            f"dataset: expected simulated homes, because {options.dataset} has no true relations"
        )
    seeds = [options.seed + i for i in range(options.homes)]
    homes = in_processes(_at, seeds, options.workers)
    configs = list(homes[0][1])
    return Result(
        rows=[{"config": c, **row_of(_added([tallies[c] for _, tallies in homes]))} for c in configs],
        scenes=[
            {"config": c, "scene": name, **row_of(tallies[c])} for c in configs for name, tallies in homes
        ],
        notes=_NOTES,
    )


def row_of(tally: Tally) -> Row:
    """P and R of each column, and how many relations there truly are; to the letter under "strict"."""
    loose, strict = ({column: counts[i] for column, counts in tally.items()} for i in (0, 1))
    return {**_figures(loose), "strict": _figures(strict)}


def tally_of(told: Collection[Fact], true: Collection[Fact]) -> Tally:
    """What was told against the truth, by kind, and the holders alone."""
    kinds = {k.value: (loose_counts(told, true, k), kind_counts(told, true, k)) for k in RelationKind}
    holders = holder_counts(told, true)
    return {**kinds, "holder": (holders, holders)}


def told_of(clouds: Mapping[int, F32], params: RelationParams | None = None) -> set[Fact]:
    """All relations between clouds `(P, 3)` by id, each told by its neighbours alone, as the map does."""
    bodies = [Body(str(i), "", box_of(points), points) for i, points in clouds.items() if len(points)]
    boxes = np.array([body.box for body in bodies]).reshape(-1, 6)
    told: set[Fact] = set()
    for body in bodies:
        apart = np.maximum(boxes[:, :3] - body.box[3:], body.box[:3] - boxes[:, 3:]).max(axis=1)
        near = [bodies[i] for i in np.flatnonzero(apart <= reach(params))]
        told |= {(int(body.object_id), r.kind, int(r.other_id)) for r in relations_of(body, near, params)}
    return told


def facts_of(home: Home) -> frozenset[Fact]:
    """A home's relations in the map's words."""
    return frozenset((r.subject, _KINDS[r.kind], r.object) for r in home.relations)


def things_of(scene: Mapped, place: Place) -> dict[str, int]:
    """The thing that each mapped object is: the one that most of its points lie on, where half of them do."""
    if not len(scene.points) or not len(place.points):
        return {}
    distance, nearest = cKDTree(place.points).query(scene.points, distance_upper_bound=CUTOFF)
    near = np.isfinite(distance)
    found = {}
    for i, thing in enumerate(scene.objects):
        own = scene.owners == i
        ids, counts = np.unique(place.instances[nearest[own & near]], return_counts=True)
        if len(ids) and counts.max() >= _MOSTLY * own.sum():
            found[thing.object_id] = int(ids[counts.argmax()])
    return found


def _at(seed: int) -> tuple[str, dict[str, Tally]]:
    """A home's name, and its tally in each configuration."""
    from lab.simulation.generate import make_home

    home = make_home(seed)
    clouds, facts = true_clouds(home), facts_of(home)
    things = {thing.object_id for thing in home.things}
    structure = {thing.object_id for thing in home.objects if thing.label in _HOLDS}
    return home.name, {
        "things": _on_clouds(clouds.exact, things, (), facts),
        "structure": _on_clouds(clouds.exact, things, structure, facts),
        "noisy camera": _on_clouds(clouds.noisy, things, structure, facts),
        "mapped": _on_map(place_of(PlaceSpec(seed=seed)), facts),
    }


def _on_clouds(
    clouds: Mapping[int, F32], things: Collection[int], structure: Collection[int], facts: Collection[Fact]
) -> Tally:
    """What things are to things and to structure; of structure alone the truth says nothing."""
    seen = {i: points for i, points in clouds.items() if i in things or i in structure}
    told = {fact for fact in told_of(seen) if fact[0] in things}
    return tally_of(told, _among(facts, seen))


def _on_map(place: Place, facts: Collection[Fact]) -> Tally:
    """What a map's objects say of each other, where both are things, and not parts of one."""
    scene = mapped(read_cache(place.cache)[1], MapParams())
    things = things_of(scene, place)
    told = {
        (things[thing.object_id], relation.kind, things[relation.other_id])
        for thing in scene.objects
        for relation in thing.relations
        if thing.object_id in things and relation.other_id in things
    }
    told = {fact for fact in told if fact[0] != fact[2]}
    return tally_of(told, _among(facts, set(things.values())))


def _among(facts: Collection[Fact], ids: Collection[int]) -> set[Fact]:
    return {fact for fact in facts if fact[0] in ids and fact[2] in ids}


def _added(tallies: Sequence[Tally]) -> Tally:
    return {
        column: (
            sum((tally[column][0] for tally in tallies), KindCounts()),
            sum((tally[column][1] for tally in tallies), KindCounts()),
        )
        for column in tallies[0]
    }


def _figures(counts: Mapping[str, KindCounts]) -> Row:
    return dict(_named(counts))


def _named(counts: Mapping[str, KindCounts]) -> Iterator[tuple[str, float | int | None]]:
    for column, counted in counts.items():
        yield f"{column}_P", counted.precision
        yield f"{column}_R", counted.recall
        yield f"{column}_n", counted.true
