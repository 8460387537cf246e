"""A robot that circles one room for thousands of frames: what its map holds and weighs after each thousand (SPEC 2.4).

What it sees is noisy all the way: the pose is off by centimetres, things are missed, cut, called by another word, and
now and then there is a box with nothing in it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lab.bench.mapping_world import SITE_SIDE, CrowdedFloor, Thing
from lab.bench.rows import Row
from ovip.scene.boxes import box_of
from ovip.scene.types import F32, Detection, DetectionBatch
from services.mapper.domain.object_map import ObjectMap

FRAMES = 10_000
_ROUNDS = (0.01, 0.1, 0.5, 1.0)  # of all frames, after which a row is taken


@dataclass(frozen=True, slots=True)
class CircleParams:
    """What is seen, and how badly.

    things: in the room. in_view: at once. missed, cut, misnamed: shares of views. hallucinated: expected a frame.
    round: frames of a round. pose: metres by which a frame is off, each axis.
    """

    things: int = 40
    in_view: int = 10
    missed: float = 0.15
    cut: float = 0.2
    misnamed: float = 0.05
    hallucinated: float = 0.05
    round: int = 200
    pose: float = 0.015


def measure_circle(frames: int = FRAMES, params: CircleParams | None = None) -> list[Row]:
    """Rows after 1, 10, 50 and 100 % of `frames` frames; the map is upkept as the mapper's service does."""
    circle = Circle(params or CircleParams())
    made, rows, done, mapping_s = ObjectMap(), list[Row](), 0, 0.0
    for share in _ROUNDS:
        until = round(share * frames)
        for frame in range(done, until):
            batch = circle.batch(frame)
            began = time.perf_counter()
            made.integrate(batch)
            if made.upkeep_due:
                made.upkeep()
            mapping_s += time.perf_counter() - began
        rows.append(_row(made, until, mapping_s / max(1, until - done)))
        done, mapping_s = until, 0.0
    return rows


class Circle:
    """The room's frames, each the same whenever it is asked for. things: what stands in it, by bearing."""

    def __init__(self, params: CircleParams) -> None:
        self._params = params
        self._floor = CrowdedFloor(256, points=(100, 600), shift=params.pose)
        things = self._floor.things(0, params.things)
        middle = np.mean([thing.points.mean(axis=0) for thing in things], axis=0)
        self.things = sorted(things, key=lambda thing: _bearing(thing, middle))

    def batch(self, frame: int) -> DetectionBatch:
        """Those things that stand before the robot at its place in the round, as it sees them."""
        p, rng = self._params, np.random.default_rng([1, frame])
        first = frame * p.things // p.round
        before = [self.things[(first + i) % p.things] for i in range(p.in_view)]
        seen = [thing for thing in before if rng.random() > p.missed]
        ghosts = [self._ghost(rng) for _ in range(rng.poisson(p.hallucinated))]
        batch = self._floor.batch([*seen, *ghosts], frame)
        detections = tuple(self._worsened(d, rng) for d in batch.detections)
        return replace(batch, detections=detections)

    def _ghost(self, rng: np.random.Generator) -> Thing:
        """A thing that is not there: another place's points, somewhere in the room, under any word."""
        thing = self._floor.site(1000 + int(rng.integers(1000)))[-1]
        place = np.append(rng.uniform(0, 2 * SITE_SIDE, 2), rng.uniform(0, 1.5))
        points = thing.points - thing.points.mean(axis=0) + place.astype(np.float32)
        return replace(thing, points=points.astype(np.float32))

    def _worsened(self, d: Detection, rng: np.random.Generator) -> Detection:
        if rng.random() < self._params.misnamed:
            d = replace(d, label=f"word {rng.integers(self._floor.words)}")
        if rng.random() < self._params.cut:
            axis, share = int(rng.integers(3)), rng.uniform(0.5, 0.9)
            keep = d.points[:, axis] <= np.quantile(d.points[:, axis], share)
            d = replace(d, points=d.points[keep], colors=d.colors[keep], box=box_of(d.points[keep]))
        return d


def _bearing(thing: Thing, middle: F32) -> float:
    x, y, _ = thing.points.mean(axis=0) - middle
    return float(np.arctan2(y, x))


def _row(made: ObjectMap, frames: int, seconds_a_frame: float) -> Row:
    return {
        "frames": frames,
        "objects": len(made.objects()),
        "unconfirmed": len(made.objects(include_unconfirmed=True)) - len(made.objects()),
        "aliases": len(made.aliases),
        "voxels": sum(o.voxels for o in made.objects(include_unconfirmed=True)),
        "bytes_map": made.nbytes,
        "bytes_snapshot": len(made.segment()),
        "rss_mb": _resident_mb(),
        "frame_ms": round(1e3 * seconds_a_frame, 2),
    }


def _resident_mb() -> int:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(round(int(line.split()[1]) / 1024) for line in lines if line.startswith("VmRSS:"))
