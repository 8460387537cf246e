"""A place before and after a change, walked twice: the detections of each walk, and what it showed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from lab.evaluation.asking.truth import truth_of_room
from lab.evaluation.asking.worlds import WorldSpec
from lab.simulation.changed import Change, ChangedRoom, changed_home, some_change
from lab.simulation.home import Home, HomeObject
from lab.simulation.imperfect import (
    NOISY,
    FeatureModel,
    ImperfectParams,
    SeenFrame,
    gated,
    imperfect_batches,
)
from lab.simulation.imperfect.frames import FRAME_NS
from lab.simulation.room import SimulatedRoom
from lab.simulation.sensor import Sensor, SensorParams
from lab.simulation.world import HOME_CAMERA
from ovip.scene.camera import backproject, project
from ovip.scene.types import F32, F64, I64, U16, DetectionBatch, Intrinsics
from ovip.scene.voxels import voxel_keys

FRAMES = 240
"""Of one walk through a simulated home."""

_GREY = 128
_VOXEL = 0.03  # metres between points of the truth
_MOST_POINTS = 300  # of a thing, to see whether a view looks past it
_BEHIND = 0.05  # metres that a view must look past a point to see that nothing is there
_OPEN = 0.3  # of a thing's points past which a view must look to be one that could notice
_SHOWN = 60  # pixels of a thing in a view in which it could be detected
_GLANCE = 3  # frames from one look to the next, to see what a walk shows
# the small room's: what is carried away, and the foot of what is put elsewhere, by colour and label
_CARRIED_AWAY = (("green", "bottle"), ("gray", "laptop"), ("orange", "vase"))
_PUT_AT = {("red", "mug"): (5.15, 4.62, 0.88), ("white", "mug"): (2.12, 4.66, 0.45)}


class Eye(Protocol):
    """Renders depth `(H, W)` metres and ids `(H, W)` at a pose."""

    def depth_and_ids(self, world_from_camera: F64, /) -> tuple[F32, U16]: ...


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """things: as they stood before the change; boxes: id -> where each one left stands after it, `(6,)` metres."""

    name: str
    seed: int
    intrinsics: Intrinsics
    before: Eye
    after: Eye
    things: tuple[HomeObject, ...]
    boxes: Mapping[int, F64]
    change: Change
    poses: Sequence[F64]
    sensor: SensorParams = field(default_factory=SensorParams)
    imperfect: ImperfectParams = NOISY


@dataclass(slots=True, eq=False)
class Shown:
    """What a walk showed. points `(P, 3)`, ids `(P,)`: the true surfaces it saw, of things.

    views: id -> frames with enough of the thing to detect it. past: id -> frames that looked through where the thing
    stood on another walk.
    """

    points: F32 = field(default_factory=lambda: np.zeros((0, 3), np.float32))
    ids: I64 = field(default_factory=lambda: np.zeros(0, np.int64))
    views: dict[int, list[int]] = field(default_factory=dict)
    past: dict[int, list[int]] = field(default_factory=dict)


def stage_of(spec: WorldSpec, frames: int = FRAMES) -> Stage:
    """The place with a change by its seed. NotConfigured where a package for it is missing."""
    return room_stage(spec.seed) if spec.kind == "room" else _home_stage(spec, frames)


def room_stage(seed: int) -> Stage:
    """The small room: three things carried away, two mugs put elsewhere."""
    room = SimulatedRoom(seed)
    named = {(thing.color, thing.label): thing for thing in room.objects}
    away = frozenset(named[name].object_id for name in _CARRIED_AWAY)
    moved = {named[name].object_id: np.array(at) - _foot(named[name].box) for name, at in _PUT_AT.items()}
    change = Change(away, moved)
    after = ChangedRoom(seed, change)
    boxes = {thing.object_id: thing.box for thing in after.objects}
    things = truth_of_room(room).things
    return Stage(
        f"room {seed}",
        seed,
        room.intrinsics,
        _RoomEye(room),
        _RoomEye(after),
        things,
        boxes,
        change,
        room.walk(),
    )


def walked(
    stage: Stage, eye: Eye, walk: int, known: Shown | None = None
) -> tuple[list[DetectionBatch], Shown]:
    """The batches of one walk, as perception commits them, and what it showed.

    walk: 0, 1, ...; its frames' numbers, noise and drift follow those of the one before. known: an earlier walk's, for
    `past`.
    """
    shown = Shown()
    model = FeatureModel(tuple(sorted({thing.label for thing in stage.things})))
    frames = _frames(stage, eye, walk, shown, known)
    made = list(imperfect_batches(frames, stage.things, stage.imperfect, stage.seed, model))
    return list(gated(lambda: made)), shown


def _frames(stage: Stage, eye: Eye, walk: int, shown: Shown, known: Shown | None) -> Iterator[SeenFrame]:
    k = stage.intrinsics
    sensor = Sensor(k, stage.sensor, stage.seed)
    grey = np.full((k.height, k.width, 3), _GREY, np.uint8)
    things = np.array([thing.object_id for thing in stage.things])
    places = _places(known, stage.change) if known else {}
    for number, pose in enumerate(stage.poses):
        index = walk * len(stage.poses) + number
        depth, ids = eye.depth_and_ids(pose)
        _note(shown, index, depth, ids, things, k, pose)
        for object_id, points in places.items():
            if _looks_past(points, depth, k, pose):
                shown.past.setdefault(object_id, []).append(index)
        _, measured, tracked = sensor.observe(grey, depth, pose, index)
        yield SeenFrame(index, index * FRAME_NS, k, tracked, None, measured, ids)


def _note(shown: Shown, index: int, depth: F32, ids: U16, things: I64, k: Intrinsics, pose: F64) -> None:
    counts = np.bincount(ids.ravel(), minlength=int(things.max(initial=0)) + 1)
    for object_id in things[counts[things] >= _SHOWN].tolist():
        shown.views.setdefault(object_id, []).append(index)
    sparse = np.zeros(ids.shape, np.bool_)
    sparse[::3, ::3] = True
    points, pixels = backproject(depth, k, pose, sparse & np.isin(ids, things))
    points = np.concatenate([shown.points, points])
    owners = np.concatenate([shown.ids, ids.ravel()[pixels].astype(np.int64)])
    keys = np.stack([voxel_keys(points, _VOXEL), owners])
    first = np.unique(keys, axis=1, return_index=True)[1]
    shown.points, shown.ids = points[first], owners[first]


def _places(known: Shown, change: Change) -> dict[int, F32]:
    """Points `(P, 3)` of where each changed thing was seen to stand."""
    own = {i: known.points[known.ids == i] for i in sorted(change.removed | change.moved.keys())}
    return {i: points[:: 1 + len(points) // _MOST_POINTS] for i, points in own.items() if len(points)}


def _looks_past(points: F32, depth: F32, k: Intrinsics, pose: F64) -> bool:
    """Whether the true depth lies well behind enough of the points."""
    uv, z = project(points, k, pose)
    column, row = np.rint(uv).astype(np.int64).T
    inside = (z > 0.3) & (z < 5) & (column >= 0) & (column < k.width) & (row >= 0) & (row < k.height)
    beyond = depth[row[inside], column[inside]] > z[inside] + _BEHIND
    return int(beyond.sum()) >= _OPEN * len(points)


def _foot(box: F64) -> F64:
    return np.array([(box[0] + box[3]) / 2, (box[1] + box[4]) / 2, box[2]])


class _RoomEye:
    def __init__(self, room: SimulatedRoom) -> None:
        self._room = room

    def depth_and_ids(self, world_from_camera: F64) -> tuple[F32, U16]:
        _, depth, ids = self._room.render(world_from_camera)
        return depth, ids


def _home_stage(spec: WorldSpec, frames: int) -> Stage:
    from lab.simulation.renderer import Renderer
    from lab.simulation.tour import walk_through

    home = _home(spec)
    before, poses = Renderer(home, HOME_CAMERA), walk_through(home, spec.seed, frames)
    change = some_change(home, spec.seed, among=_well_seen(before, poses, home.things))
    after = changed_home(home, change)
    return Stage(
        spec.name,
        spec.seed,
        HOME_CAMERA,
        before,
        Renderer(after, HOME_CAMERA),
        home.things,
        {thing.object_id: thing.box for thing in after.things},
        change,
        poses,
    )


def _well_seen(eye: Eye, poses: Sequence[F64], things: Sequence[HomeObject]) -> list[int]:
    """Ids of the things that the walk shows in enough views to be mapped, by every few of its frames."""
    counts = np.zeros(1 + max((thing.object_id for thing in things), default=0), np.int64)
    for pose in poses[::_GLANCE]:
        pixels = np.bincount(eye.depth_and_ids(pose)[1].ravel(), minlength=len(counts))[: len(counts)]
        counts += pixels >= 2 * _SHOWN
    return [thing.object_id for thing in things if counts[thing.object_id] >= 2]


def _home(spec: WorldSpec) -> Home:
    if spec.root is not None:
        from lab.simulation.small_house import load_small_house

        return load_small_house(spec.root)
    from lab.simulation.generate import make_home

    return make_home(spec.seed)
