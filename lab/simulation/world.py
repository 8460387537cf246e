"""Worlds that a simulated robot lives in: the seam, and a whole home as one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

import numpy as np

from lab.simulation.camera import EYE_HEIGHT
from lab.simulation.detecting import Sight, onboard_detections
from lab.simulation.ground import Ground
from lab.simulation.home import Home, HomeObject
from lab.simulation.renderer import Renderer, RenderParams
from lab.simulation.sensor import NO_NOISE, Sensor, SensorParams
from lab.simulation.tour import TourParams, walk_through
from lab.simulation.walking import is_clear
from ovip.scene.types import F32, F64, U8, U16, Intrinsics

HOME_CAMERA = Intrinsics(fx=460.0, fy=460.0, cx=319.5, cy=239.5, width=640, height=480)
"""A robot's camera in a home: 70 degrees wide."""

_ARRIVED = 0.15  # metres from a place that count as there


class World(Protocol):
    """What a robot needs of the place it is in. Places are floor points `(3,)`, metres."""

    @property
    def seed(self) -> int: ...
    @property
    def intrinsics(self) -> Intrinsics: ...

    def walk(self) -> list[F64]:
        """Poses `(4, 4)` of the robot's round."""
        ...

    def way(self, start: F64, via: F64, clearance: float) -> F64 | None:
        """Floor points `(N, 3)` from `start` through `via` `(N, 3)` that keep `clearance`; None for no way."""
        ...

    def observe(self, pose: F64, index: int, before: F64 | None = None) -> Sight:
        """What the robot senses at the true `pose` in its frame `index`; before: its pose one frame earlier."""
        ...


@dataclass(frozen=True, slots=True)
class HomeWorldParams:
    """onboard: whether the robot detects the true instances itself. frames: of its walk, None = as many as it needs."""

    sensor: SensorParams = NO_NOISE
    render: RenderParams = field(default_factory=RenderParams)
    tour: TourParams = field(default_factory=lambda: TourParams(height=EYE_HEIGHT))
    onboard: bool = False
    frames: int | None = None


class HomeWorld:
    """A home with one robot's sensor in it; `beside` gives the same home to another robot."""

    def __init__(
        self,
        home: Home,
        intrinsics: Intrinsics = HOME_CAMERA,
        seed: int = 0,
        params: HomeWorldParams | None = None,
    ) -> None:
        chosen = params or HomeWorldParams()
        self._set_up(home, seed, chosen, Renderer(home, intrinsics, chosen.render), Ground(home))

    def _set_up(
        self, home: Home, seed: int, params: HomeWorldParams, renderer: Renderer, ground: Ground
    ) -> None:
        self.home, self.seed, self.ground = home, seed, ground
        self.intrinsics = renderer.intrinsics
        self._params, self._renderer = params, renderer
        self._sensor = Sensor(self.intrinsics, params.sensor, seed)
        self._walk: list[F64] | None = None

    def beside(self, seed: int) -> HomeWorld:
        """The same home for another robot: its own walk and sensor noise, by `seed`; nothing is built anew."""
        other = object.__new__(HomeWorld)
        other._set_up(self.home, seed, self._params, self._renderer, self.ground)
        return other

    @property
    def objects(self) -> Sequence[HomeObject]:
        """All that stands in the home."""
        return self.home.objects

    def walk(self) -> list[F64]:
        """A tour of the whole home, by the seed."""
        if self._walk is None:
            self._walk = walk_through(
                self.home, self.seed, self._params.frames, self._params.tour, self.ground
            )
        return list(self._walk)

    def render(self, pose: F64) -> tuple[U8, F32, U16]:
        """rgb `(H, W, 3)`, depth `(H, W)` metres, ids `(H, W)`, without noise."""
        seen = self._renderer.render(pose)
        return seen.rgb, seen.depth, seen.ids

    def observe(self, pose: F64, index: int, before: F64 | None = None) -> Sight:
        """What the robot's sensor makes of the view from `pose`, and what it detects on board."""
        rgb, depth, ids = self.render(pose)
        noisy, measured, tracked = self._sensor.observe(rgb, depth, pose, index, before)
        detected = onboard_detections(self.home, ids) if self._params.onboard else None
        return Sight(noisy, measured, tracked, ids, detected)

    def is_free(self, place: F64, clearance: float = 0.2) -> bool:
        """Whether a robot of radius `clearance` can stand at floor point `(3,)`, or `(2,)` of the lowest storey."""
        return self.ground.is_free(place[:2], clearance, self._floor(place))

    def way(self, start: F64, via: F64, clearance: float) -> F64 | None:
        """The way through the places, round what stands between them, and by the stairs; None where there is none."""
        points = [self._on_floor(start)]
        for a, b in pairwise([start, *via]):
            leg = self._leg(a, b, clearance)
            if leg is None:
                return None
            points += list(leg[1:])
        return np.array(points)

    def _leg(self, a: F64, b: F64, clearance: float) -> F64 | None:
        here, there = self._floor(a), self._floor(b)
        if here != there:
            return self._by_stairs(a, b, clearance)
        if not self.is_free(b, clearance):
            return None
        if is_clear(lambda p: self.is_free(p, clearance), a, b):
            return np.stack([self._on_floor(a), self._on_floor(b)])
        path = self.ground.path(here, a[:2], b[:2], clearance)
        if not len(path) or max(np.hypot(*(path[0] - a[:2])), np.hypot(*(path[-1] - b[:2]))) > _ARRIVED:
            return None
        z = self.ground.storey(here).z
        return np.vstack(
            [self._on_floor(a), np.column_stack([path, np.full(len(path), z)]), self._on_floor(b)]
        )

    def _by_stairs(self, a: F64, b: F64, clearance: float) -> F64 | None:
        """One storey at a time, up or down the first flight that leads there."""
        here, there = self._floor(a), self._floor(b)
        for flight in self.ground.flights:
            up = (flight.lower, flight.upper) == (here, here + 1) and there > here
            down = (flight.upper, flight.lower) == (here, here - 1) and there < here
            if not (up or down):
                continue
            steps = flight.way if up else flight.way[::-1]
            before, after = self._leg(a, steps[0], clearance), self._leg(steps[-1], b, clearance)
            if before is not None and after is not None:
                return np.vstack([before, steps[1:-1], after])
        return None

    def _floor(self, place: F64) -> int:
        lowest = min(storey.z for storey in self.home.storeys)
        return self.ground.floor_at(float(place[2]) if len(place) > 2 else lowest)

    def _on_floor(self, place: F64) -> F64:
        return np.array([*place[:2], self.ground.storey(self._floor(place)).z])
