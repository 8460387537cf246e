"""One scene's partitions: floors surveyed, objects placed and named, floors that have changed enough cut anew."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, replace

import numpy as np

from ovip.codec import encode_partition
from ovip.scene.grid import FloorGrid
from ovip.scene.types import I64
from services.regions.domain.assembly import Cut, PlacedObjects, assemble
from services.regions.domain.events import events_between
from services.regions.domain.partition import PartitionParams
from services.regions.domain.staleness import Basis, StalenessParams, is_stale, same_floors
from services.regions.domain.survey import SurveyedStorey, storeys_of_objects, survey
from services.regions.grouping import FloorGrouping, GroupingMemory
from services.regions.map_view import MapView
from services.regions.metrics import STEP_SECONDS
from services.regions.ports import Grouping
from services.regions.shelf import Answered, Gathered


@dataclass(frozen=True, slots=True)
class CutParams:
    """The numbers of Algorithm 1, and what makes a floor stale."""

    partition: PartitionParams
    staleness: StalenessParams


@dataclass(frozen=True, slots=True)
class Made:
    """A partition and how it came about: how many floors were cut anew and kept, and whether anything that a
    reader sees differs from the one before (the map's version alone is no difference)."""

    answered: Answered
    stale: int
    kept: int
    differs: bool


class Partitioner:
    """Makes one scene's partitions, each from the one before it."""

    def __init__(self, view: MapView, grouping: FloorGrouping, params: CutParams) -> None:
        self._view = view
        self._grouping = grouping
        self._params = params
        self._surveyed: tuple[int, tuple[SurveyedStorey, ...]] = (-1, ())

    def would_cut_otherwise(self, answered: Answered) -> bool:
        """Whether the partition was cut with other settings, or by an older version."""
        return answered.cut.partition.revision > 0 and answered.settings != _settings(self._params)

    async def partition(self, gathered: Gathered, before: Answered, wish: int) -> Made:
        """What the evidence and the map say now. A new wish, or other settings, cut every floor anew.

        An OvipError where the map cannot be read.
        """
        wished = wish > before.wish
        with STEP_SECONDS.labels("map").time():
            objects, version = await self._view.objects()
            map_after = self._view.after
        with STEP_SECONDS.labels("survey").time():
            surveyed = await self._survey(gathered)
        storeys = storeys_of_objects(surveyed, objects.centres)
        with STEP_SECONDS.labels("grouping").time():
            memory = GroupingMemory() if wished else before.memory
            grouping, memory = await self._grouping.functions(storeys, objects, memory)
        with STEP_SECONDS.labels("cut").time():
            here = _Here(surveyed, storeys, objects, grouping, version)
            made = await asyncio.to_thread(_made, here, gathered, before, wished, self._params)
        answered = replace(
            made.answered,
            map_after=map_after,
            wish=wish,
            detections_after=gathered.after,
            memory=memory,
        )
        return replace(made, answered=answered)

    async def _survey(self, gathered: Gathered) -> tuple[SurveyedStorey, ...]:
        frames = gathered.evidence.revision
        if self._surveyed[0] != frames:
            self._surveyed = frames, await asyncio.to_thread(survey, gathered.evidence)
        return self._surveyed[1]


@dataclass(frozen=True, slots=True)
class _Here:
    """What a partition is made of, beside the evidence."""

    surveyed: tuple[SurveyedStorey, ...]
    storeys: I64
    objects: PlacedObjects
    grouping: Grouping
    map_version: int


def _settings(params: CutParams) -> str:
    return repr(params.partition)


def _made(here: _Here, gathered: Gathered, before: Answered, afresh: bool, params: CutParams) -> Made:
    settings, bases = _settings(params), _bases(here)
    anew = afresh or settings != before.settings
    kept = {} if anew else _kept(here, bases, before, params.staleness)
    cut = assemble(
        here.surveyed,
        here.objects,
        here.grouping.functions,
        gathered.evidence,
        before.cut,
        params.partition,
        frozenset(kept),
        here.grouping.told,
    )
    for floor, number in kept.items():
        bases[number] = before.bases[floor]
    cut = _told(cut, before.cut, here)
    answered = replace(before, cut=cut, bases=tuple(bases), settings=settings, lost="")
    return Made(answered, len(bases) - len(kept), len(kept), _differs(cut, before.cut))


def _kept(here: _Here, bases: list[Basis], before: Answered, params: StalenessParams) -> dict[int, int]:
    """Floors of the last partition that are not stale -> their numbers now. A floor of which a region has lost its
    last cell since it was cut is stale, too."""
    known = before.cut.partition.floors if before.bases else ()
    regions = {region.region_id for region in before.cut.partition.regions}
    same = same_floors([floor.z for floor in known], [floor.storey.z for floor in here.surveyed])
    return {
        floor: number
        for number, floor in enumerate(same)
        if floor is not None
        and regions.issuperset(before.cut.grids[floor].region_ids)
        and not is_stale(before.bases[floor], bases[number], params)
    }


def _bases(here: _Here) -> list[Basis]:
    functions = np.array(here.grouping.functions, dtype=object)
    told = here.grouping.told
    bases = []
    for number, floor in enumerate(here.surveyed):
        members = np.flatnonzero(here.storeys == number)
        mine = here.objects.only(members)
        bases.append(
            Basis(
                origin=floor.space.origin,
                resolution=floor.space.resolution,
                shape=(floor.space.free.shape[0], floor.space.free.shape[1]),
                packed=np.packbits(floor.space.free),
                ids=mine.ids,
                labels=mine.labels,
                functions=tuple(functions[members]),
                centres=mine.centres[:, :2],
                told=tuple(told[i] for i in members.tolist()) if told else (),
            )
        )
    return bases


def _told(cut: Cut, before: Cut, here: _Here) -> Cut:
    """The cut with its events, its map version and its fallbacks."""
    events = events_between(before.partition, before.grids, cut.partition, cut.grids)
    partition = replace(
        cut.partition, events=events, map_version=here.map_version, fallbacks=here.grouping.fallbacks
    )
    return replace(cut, partition=partition)


def _differs(cut: Cut, before: Cut) -> bool:
    """Whether a reader sees anything else than before, but for numbers of revision and version."""
    if len(cut.grids) != len(before.grids) or not all(map(_same_grid, cut.grids, before.grids)):
        return True
    one, other = (replace(c.partition, revision=0, map_version=0, events=()) for c in (cut, before))
    return encode_partition(one) != encode_partition(other)


def _same_grid(one: FloorGrid, other: FloorGrid) -> bool:
    return (
        (one.origin, one.resolution, one.region_ids) == (other.origin, other.resolution, other.region_ids)
        and np.array_equal(one.occupancy, other.occupancy)
        and np.array_equal(one.regions, other.regions)
    )
