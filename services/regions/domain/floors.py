"""Floors: the storeys of a scene, from the levels that its cameras look down on and stand above (SPEC 3).

Levels come from the cubes that were hit, their exact heights from the histograms of points (HOV-SG's peaks). A level
far enough above a floor, of a floor's size and stood on is the floor of a storey; the others (tables, landings, a
sunken part of a room) belong to the storey that they lie in. Surfaces seen from below (ceilings) are kept apart from
the start, which tells the ceiling of one storey from the floor of the next, a few decimetres higher.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ovip.scene.types import F64, I64, Bools
from services.regions.domain.counts import Counts
from services.regions.domain.evidence import BIN, CELL, FloorEvidence
from services.regions.domain.levels import (
    Hit,
    Level,
    LevelParams,
    Surfaces,
    count_near,
    find_levels,
    read_hit,
    tops,
    undersides,
)

_FEET = np.stack(np.meshgrid([-2, 0, 2], [-2, 0, 2], [-1, 0, 1], indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, slots=True)
class FloorParams:
    """How levels become storeys; metres and square metres.

    min_storey: a floor lies at least this far above the one below it, and cameras stood above it. min_split: a level
    this far above it is a storey of its own (a mezzanine, one half of a split level) where cameras stood right over
    it. min_area: of any floor but the lowest; a landing is smaller. min_upstairs: this is enough where a ceiling of
    min_area was seen between it and the floor below, which no landing has. sunken: a part of a storey lies no
    farther than this below its floor. level_share: that floor is no smaller than this share of the storey's largest
    level, nor stood over by a smaller share of its cameras. camera_low, camera_high: cameras that stand on a floor
    are this far above it. tolerance: what lies this far under a floor still belongs to it. min_headroom: a ceiling
    is at least this far above its floor. min_ceiling: and of this area.
    """

    levels: LevelParams = field(default_factory=LevelParams)
    min_storey: float = 2.0
    min_split: float = 1.0
    min_area: float = 4.0
    min_upstairs: float = 1.0
    sunken: float = 0.6
    level_share: float = 0.05
    camera_low: float = 0.15
    camera_high: float = 2.2
    tolerance: float = 0.3
    min_headroom: float = 1.9
    min_ceiling: float = 0.5


@dataclass(frozen=True, slots=True)
class Storey:
    """One storey in metres: floor and ceiling height (None where none was seen), and the heights it owns."""

    z: float
    ceiling_z: float | None
    low: float
    high: float


def find_storeys(evidence: FloorEvidence, params: FloorParams | None = None) -> tuple[Storey, ...]:
    """The storeys from the lowest up; none where no frame has been added, one where no level stands out.

    A storey that was only seen counts too, where it was seen well: from the stairs with the camera above its floor,
    or, below all others, from above.
    """
    params = params or FloorParams()
    if not evidence.cameras:
        return ()
    hit = read_hit(evidence.hits)
    ceilings = _ceilings(hit, evidence, params)
    groups = _grouped(_levels_stood_on(hit, evidence, params), ceilings, params)
    floors = [_floor(group, params) for group in groups] or [_lowest(evidence)]
    edges = [-np.inf, *(group[0].level.z - params.tolerance for group in groups[1:]), np.inf]
    return tuple(
        Storey(z, _ceiling(ceilings, z, above, params), low, high)
        for z, above, (low, high) in zip(floors, [*floors[1:], np.inf], pairwise(edges), strict=True)
    )


def storey_of(storeys: tuple[Storey, ...], heights: F64) -> I64:
    """Index of the storey that owns each height `(N,)` -> `(N,)`; below the lowest floor counts as the
    lowest.

    On stairs, too, each goes by its own height: an object, a point or a camera between two floors belongs to the
    lower one until it is within `tolerance` under the upper. A camera's height is that of its eyes, so that it
    belongs upstairs as soon as it sees the upper floor. Raises ValueError where there is no storey.
    """
    if not storeys:
        raise ValueError("expected at least one storey")
    edges = [storey.low for storey in storeys[1:]]
    return np.searchsorted(np.asarray(edges, dtype=np.float64), np.asarray(heights), side="right").astype(
        np.int64
    )


@dataclass(frozen=True, slots=True)
class _Stood:
    """A level; how many cameras were at a height to stand on it, and how many of those were right over it."""

    level: Level
    near: int
    over: int


def _levels_stood_on(hit: Hit, evidence: FloorEvidence, params: FloorParams) -> list[_Stood]:
    """The levels that were seen from above rather than from below, rising."""
    surfaces = tops(hit)
    levels = [
        level
        for level in find_levels(surfaces, evidence.heights_below, params.levels)
        if _seen_from(evidence.heights_below, evidence.heights_above, level)
    ]
    cameras = np.array(list(evidence.cameras.values()))
    rise = cameras[:, 2] - np.array([[level.z] for level in levels]).reshape(-1, 1)
    near = (rise > params.camera_low) & (rise < params.camera_high)
    found = [_under(surfaces, level.z, cameras) for level in levels]
    under: Bools = np.array(found, dtype=bool).reshape(near.shape) & near
    highest = np.cumsum(under[::-1], axis=0)[::-1] == 1  # a camera stands on the highest level under it
    over = under & highest
    return [
        _Stood(*row) for row in zip(levels, near.sum(axis=1).tolist(), over.sum(axis=1).tolist(), strict=True)
    ]


def _seen_from(side: Counts, other: Counts, level: Level) -> bool:
    return count_near(side, level.z, CELL) >= count_near(other, level.z, CELL)


def _under(surfaces: Surfaces, z: float, cameras: F64) -> Bools:
    """Whether there is a top at height `z` within a decimetre of the foot of each camera `(N, 3)` -> `(N,)`."""
    feet = np.floor(np.column_stack([cameras[:, :2], np.full(len(cameras), z)]) / CELL).astype(np.int64)
    found = surfaces.at((feet[:, None] + _FEET).reshape(-1, 3))
    return np.asarray(found.reshape(-1, len(_FEET)).any(axis=1), dtype=bool)


def _grouped(levels: Sequence[_Stood], ceilings: Sequence[Level], params: FloorParams) -> list[list[_Stood]]:
    """The levels of each storey from the lowest up, the first of each its lowest."""
    groups: list[list[_Stood]] = []
    for stood in _from_the_lowest(levels, params):
        if groups and not _is_storey(stood, _floor(groups[-1], params), ceilings, params):
            groups[-1].append(stood)
        else:
            groups.append([stood])
    return groups


def _from_the_lowest(levels: Sequence[_Stood], params: FloorParams) -> Sequence[_Stood]:
    """Without what lies below the lowest floor: levels that nobody stood on and that are none seen from above."""
    first = next((number for number, level in enumerate(levels) if level.near), 0)
    for number in range(first):
        far_below = levels[number].level.z <= levels[first].level.z - params.min_storey
        if far_below and levels[number].level.area >= params.min_area:
            return levels[number:]
    return levels[first:]


def _is_storey(stood: _Stood, floor: float, ceilings: Sequence[Level], params: FloorParams) -> bool:
    """Whether a level is the floor of the next storey above a floor."""
    rise = stood.level.z - floor
    if rise < params.min_storey:
        return rise >= params.min_split and stood.over > 0 and stood.level.area >= params.min_area
    over_ceiling = any(
        floor + params.min_headroom < ceiling.z < stood.level.z and ceiling.area >= params.min_area
        for ceiling in ceilings
    )
    return stood.near > 0 and stood.level.area >= (params.min_upstairs if over_ceiling else params.min_area)


def _floor(group: Sequence[_Stood], params: FloorParams) -> float:
    """The height of the lowest level, or of one a little higher that is stood over and larger."""
    largest, most = max(stood.level.area for stood in group), max(stood.over for stood in group)
    large = [stood for stood in group if stood.level.area >= params.level_share * largest]
    low = [stood for stood in large if stood.level.z <= large[0].level.z + params.sunken]
    over = [stood for stood in low if stood.over > params.level_share * most]
    return max([large[0], *over], key=lambda stood: stood.level.area).level.z


def _lowest(evidence: FloorEvidence) -> float:
    """Where there is no level: the second percentile of what was seen from above, else the lowest camera."""
    bins, counts = evidence.heights_below.items()
    if not len(bins):
        return float(min(place[2] for place in evidence.cameras.values()))
    at = int(np.searchsorted(np.cumsum(counts), 0.02 * counts.sum()))
    return float((bins[at] + 0.5) * BIN)


def _ceilings(hit: Hit, evidence: FloorEvidence, params: FloorParams) -> list[Level]:
    """The levels that were seen from below rather than from above, rising."""
    levels = find_levels(undersides(hit), evidence.heights_above, params.levels)
    return [level for level in levels if _seen_from(evidence.heights_above, evidence.heights_below, level)]


def _ceiling(ceilings: Sequence[Level], z: float, above: float, params: FloorParams) -> float | None:
    """The height of most ceiling, between headroom and the next floor; None where none was seen."""
    inside = [
        level
        for level in ceilings
        if z + params.min_headroom < level.z < above and level.area >= params.min_ceiling
    ]
    return max(inside, key=lambda level: level.area).z if inside else None
