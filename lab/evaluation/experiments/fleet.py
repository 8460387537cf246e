"""Two robots in one home: do their recordings align by shape, is another home refused, is the joined map as good."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment

from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.processes import in_processes
from lab.evaluation.rows import scene_means
from lab.simulation.home import Home
from lab.simulation.imperfect import (
    SeenFrame,
    gated,
    halved,
    imperfect_batches,
    rendered_frames,
    small_house_frames,
)
from lab.simulation.world import HOME_CAMERA
from ovip.errors import InvalidInput, Unreliable
from ovip.scene.boxes import box_of, pairwise_iou
from ovip.scene.types import F32, F64, Detection, DetectionBatch, MapObject
from ovip.scene.voxels import downsample
from services.mapper.adapters.alignment import IcpAligner
from services.mapper.domain.object_map import map_of
from services.mapper.domain.presets import PRESETS
from services.mapper.domain.registration import turn

CONFIG = "ours"
METRES, DEGREES = 0.10, 2.0
"""An alignment counts as right within these, at the middle of the other's surface."""

_FRAMES = 150  # of a robot's walk through a simulated home
_TRANSFORMS = 3
_SURFACE_VOXEL = 0.05
_SAME_BOX = 0.5
_SECOND_ROBOT = 100_000  # its frames are numbered from here
_ALIGNING = (
    "aligned: share of random turns and shifts of the second robot's world that were found again within 10 cm and 2 "
    "degrees; wrong: found elsewhere; strangers_refused: share of alignments with another home that were refused"
)
_JOINING = (
    "objects: of the second robot's map, built in its own world and joined by the alignment found; matched: share of "
    "the objects of the map that saw both robots' frames in turn that it has, label and all, at a box IoU above 0.5; "
    "extra: share of its own that the other has not. A map forgets what only a few frames saw; one that joins two may "
    "have it from both"
)


@dataclass(frozen=True, slots=True)
class _Spec:
    """seed: of the home, or None for the small house in `root`. stranger: seed of a home that is another one."""

    seed: int | None
    root: Path | None
    stranger: int
    transforms: int


@dataclass(frozen=True, slots=True, eq=False)
class _Robots:
    """What two robots saw of one home, both in its world."""

    name: str
    one: list[DetectionBatch]
    other: list[DetectionBatch]


def run(options: Options) -> Result:
    """A row: alignment of two walks through one home, of walks through two, and the joined map against one of both."""
    scenes = in_processes(score, _specs(options), options.workers)
    return Result(rows=scene_means(scenes), scenes=scenes, notes=(_ALIGNING, _JOINING))


def score(spec: _Spec) -> Row:
    """The row of one home."""
    robots = _robots_in(spec)
    rng = np.random.default_rng(spec.stranger)
    surface, there = _surface(robots.one), _surface(robots.other)
    stranger = _surface_of_home(spec.stranger)
    tries = [_aligned(surface, there, pose) for pose in _poses(rng, spec.transforms)]
    found = [one for one in tries if one is not None]
    refused = [_refuses(surface, stranger, pose) for pose in _poses(rng, spec.transforms)]
    right = [one for one in found if one.metres <= METRES and one.degrees <= DEGREES]
    return {
        "config": CONFIG,
        "scene": robots.name,
        "aligned": len(right) / len(tries),
        "wrong": (len(found) - len(right)) / len(tries),
        "error_cm": _mean([100 * one.metres for one in right]),
        "error_deg": _mean([one.degrees for one in right]),
        "overlap": _mean([one.overlap for one in right]),
        "strangers_refused": float(np.mean(refused)),
        **(_joined(robots, right[0]) if right else {}),
    }


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """An alignment found. there_from_home: the other robot's world; metres, degrees: how far it is off."""

    there_from_home: F64
    home_from_there: F64
    metres: float
    degrees: float
    overlap: float


def _aligned(surface: F32, other: F32, there_from_home: F64) -> _Found | None:
    """None where it is refused."""
    there = _moved(other, there_from_home)
    try:
        found = IcpAligner().align(surface, there, None)
    except Unreliable:
        return None
    off = found.world_from_other @ there_from_home  # what should be no motion at all
    middle = other.mean(axis=0, dtype=np.float64)
    metres = float(np.linalg.norm(off[:3, :3] @ middle + off[:3, 3] - middle))
    degrees = float(np.degrees(np.arccos(np.clip((np.trace(off[:3, :3]) - 1) / 2, -1, 1))))
    return _Found(there_from_home, found.world_from_other, metres, degrees, found.overlap)


def _refuses(surface: F32, stranger: F32, pose: F64) -> bool:
    return _aligned(surface, stranger, pose) is None


def _joined(robots: _Robots, found: _Found) -> Row:
    """The joined map against the map of all that both saw."""
    params = PRESETS[CONFIG]
    both = map_of(_in_turn(robots), params)
    joined = map_of(robots.one, params)
    alone = len(joined.objects())
    joined.join(
        map_of([moved_batch(b, found.there_from_home) for b in robots.other], params), found.home_from_there
    )
    joined.upkeep()
    return {
        "objects": len(joined.objects()),
        "objects_of_both": len(both.objects()),
        "objects_of_one": alone,
        "matched": matched_share(both.objects(), joined.objects()),
        "extra": 1 - (matched_share(joined.objects(), both.objects()) or 0.0),
    }


def _in_turn(robots: _Robots) -> list[DetectionBatch]:
    """A frame of one, then one of the other, as two robots at once send them."""
    pairs = zip_longest(robots.one, robots.other)
    return [batch for pair in pairs for batch in pair if batch is not None]


def matched_share(wanted: Sequence[MapObject], there: Sequence[MapObject]) -> float | None:
    """Share of objects with one of their own among others: its label, and a box IoU above 0.5. None of none."""
    if not wanted:
        return None
    if not there:
        return 0.0
    iou = pairwise_iou(np.stack([o.box for o in wanted]), np.stack([o.box for o in there]))
    same = np.array([[a.label == b.label for b in there] for a in wanted])
    good = same & (iou > _SAME_BOX)
    rows, columns = linear_sum_assignment(-(good * (1 + iou)))
    return float(good[rows, columns].sum() / len(wanted))


def moved_batch(batch: DetectionBatch, pose: F64) -> DetectionBatch:
    """The batch as a robot has it whose world is moved by a rigid `(4, 4)`."""
    return replace(
        batch,
        world_from_camera=pose @ batch.world_from_camera,
        detections=tuple(_moved_detection(d, pose) for d in batch.detections),
        surface=_moved(batch.surface, pose),
    )


def _moved_detection(detection: Detection, pose: F64) -> Detection:
    points = _moved(detection.points, pose)
    return replace(detection, points=points, box=box_of(points))


def _moved(points: F32, pose: F64) -> F32:
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3], np.float32)


def _poses(rng: np.random.Generator, count: int) -> Iterator[F64]:
    """Upright turns and shifts of a few metres."""
    for _ in range(count):
        pose = turn(float(rng.uniform(0, 2 * np.pi)))
        pose[:3, 3] = rng.uniform(-1, 1, 3) * [6.0, 6.0, 0.5]
        yield pose


def _surface(batches: Iterable[DetectionBatch]) -> F32:
    return downsample(np.concatenate([batch.surface for batch in batches]), _SURFACE_VOXEL)[0]


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _specs(options: Options) -> list[_Spec]:
    transforms = options.queries or _TRANSFORMS
    if options.dataset == "small_house":
        if options.root is None or not options.root.is_dir():
            raise InvalidInput(f"root: expected the folder of {options.dataset}, got {options.root}")
        return [_Spec(None, options.root, options.seed, transforms)]
    if options.dataset is not None:
        raise InvalidInput(
            f"dataset: expected small_house, or none for simulated homes, got {options.dataset!r}"
        )
    return [_Spec(options.seed + i, None, options.seed + i + 1, transforms) for i in range(options.homes)]


def _robots_in(spec: _Spec) -> _Robots:
    """Two walks of their own through a simulated home; of the small house, the two halves of its walk."""
    if spec.seed is not None:
        from lab.simulation.generate import make_home

        home = make_home(spec.seed)
        walks = [list(_walked(home, 2 * spec.seed + i)) for i in (0, 1)]
        seed = spec.seed
    else:
        from lab.simulation.small_house import load_small_house

        assert spec.root is not None
        home = load_small_house(spec.root)
        frames = list(halved(small_house_frames(spec.root)))
        walks = [frames[: len(frames) // 2], frames[len(frames) // 2 :]]
        seed = spec.stranger
    return _Robots(home.name, *(list(gated(partial(_seen, home, i, walks[i], seed))) for i in (0, 1)))


def _seen(home: Home, robot: int, frames: Iterable[SeenFrame], seed: int) -> list[DetectionBatch]:
    numbered = (replace(seen, index=seen.index + robot * _SECOND_ROBOT) for seen in frames)
    return list(imperfect_batches(numbered, home.objects, seed=seed))


def _walked(home: Home, seed: int) -> Iterator[SeenFrame]:
    from lab.simulation.renderer import Renderer
    from lab.simulation.tour import walk_through

    return rendered_frames(Renderer(home, HOME_CAMERA), walk_through(home, seed, _FRAMES))


def _surface_of_home(seed: int) -> F32:
    from lab.simulation.generate import make_home
    from services.perception.domain.lifting import LiftParams, surface_cloud

    clouds = [surface_cloud(seen.frame, LiftParams()) for seen in _walked(make_home(seed), seed)]
    return downsample(np.concatenate(clouds), _SURFACE_VOXEL)[0]
