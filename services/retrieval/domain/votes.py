"""Voxel-vote confirmation (VVC): detections of several frames meet in one voxel (CARA, Tiers 3 and 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ovip.scene.types import F32, F64, I64, Box2, Detection

Voxel = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class VoteParams:
    """The paper's 0.25 m voxels and k = 3 frames. share: a detection votes for every voxel that holds at
    least this share of the points that its fullest voxel holds, which keeps stray points of a loose mask
    out.
    """

    voxel: float = 0.25
    frames: int = 3
    share: float = 0.3


@dataclass(frozen=True, slots=True)
class Sighting:
    """A detection as it votes. center: `(3,)`; box: `(6,)` metres; mean_color: `(3,)` RGB; feature: `(D,)`
    unit.
    """

    frame_id: str
    label: str
    score: float
    center: F64
    box: F64
    box2: Box2
    mean_color: F64
    feature: F32
    voxels: tuple[Voxel, ...]


@dataclass(frozen=True, slots=True)
class Survivor:
    """A voxel that enough frames agree on, with the sightings that voted for it, best seen first.

    position: `(3,)` mean of their centres by score; box: `(6,)` median of their boxes.
    """

    voxel: Voxel
    frames: tuple[str, ...]
    sightings: tuple[Sighting, ...]
    position: F64
    box: F64


def sight(frame_id: str, detection: Detection, params: VoteParams | None = None) -> Sighting:
    """The detection and the voxels it votes for; one without points votes for that of its box's centre."""
    params = params or VoteParams()
    points = detection.points if len(detection.points) else _middle(detection.box)[None].astype(np.float32)
    colors = detection.colors if len(detection.colors) else np.zeros((1, 3), np.uint8)
    return Sighting(
        frame_id=frame_id,
        label=detection.label,
        score=detection.score,
        center=_middle(detection.box),
        box=detection.box,
        box2=detection.box2,
        mean_color=colors.mean(axis=0).astype(np.float64),
        feature=detection.feature,
        voxels=voxels_of(points, params),
    )


def voxels_of(points: F32 | F64, params: VoteParams | None = None) -> tuple[Voxel, ...]:
    """Voxels with at least `share` of the fullest one's points among `(N, 3)`, in lexical order; N >= 1."""
    params = params or VoteParams()
    cells: I64 = np.floor(np.asarray(points, np.float64) / params.voxel).astype(np.int64)
    unique, counts = np.unique(cells, axis=0, return_counts=True)
    kept = unique[counts >= params.share * counts.max()]
    return tuple((int(x), int(y), int(z)) for x, y, z in kept)


def vote(sightings: Sequence[Sighting], params: VoteParams | None = None) -> tuple[Survivor, ...]:
    """Voxels with sightings from at least `frames` distinct frames, most frames first.

    To the paper's letter only sightings in the same voxel add up: an object across a border gathers votes in
    each voxel that holds a share of its points, and those of a neighbour never help. A frame counts once a
    voxel. Each sighting supports one survivor only, the strongest, and the rest is counted again without it,
    so that one object gives one survivor. Ties: greater sum of scores, then the lower voxel.
    """
    params = params or VoteParams()
    left = list(sightings)
    survivors: list[Survivor] = []
    while (best := _strongest(left, params)) is not None:
        survivors.append(best)
        used = {id(sighting) for sighting in best.sightings}
        left = [sighting for sighting in left if id(sighting) not in used]
    return tuple(survivors)


def _strongest(sightings: Sequence[Sighting], params: VoteParams) -> Survivor | None:
    ballots: dict[Voxel, list[Sighting]] = {}
    for sighting in sightings:
        for voxel in sighting.voxels:
            ballots.setdefault(voxel, []).append(sighting)
    standing = [(voxel, held) for voxel, held in ballots.items() if len(_frames(held)) >= params.frames]
    if not standing:
        return None
    voxel, held = min(
        standing, key=lambda item: (-len(_frames(item[1])), -sum(s.score for s in item[1]), item[0])
    )
    held = sorted(held, key=lambda s: (-s.score * max(s.box2.area, 1.0), s.frame_id))
    weights = np.array([max(s.score, 1e-6) for s in held])
    position = (np.array([s.center for s in held]) * weights[:, None]).sum(axis=0) / weights.sum()
    box = np.median([s.box for s in held], axis=0)
    return Survivor(voxel, _frames(held), tuple(held), position, box)


def _frames(sightings: Sequence[Sighting]) -> tuple[str, ...]:
    return tuple(sorted({sighting.frame_id for sighting in sightings}))


def _middle(box: F64) -> F64:
    middle: F64 = (box[:3] + box[3:]) / 2
    return middle
