"""Places that a robot maps and is asked about: named so that any process can make the same one again."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from lab.evaluation.asking.terrain import Terrain, terrain_of_ground, terrain_of_room
from lab.evaluation.asking.truth import Truth, truth_of_home, truth_of_room
from lab.evaluation.experiment import Options
from lab.simulation.camera import CAMERA
from lab.simulation.detecting import Sight
from lab.simulation.home import Home
from lab.simulation.imperfect import (
    NOISY,
    FeatureModel,
    Look,
    SeenFrame,
    imperfect_looks,
    onboard_of,
    truth_of,
)
from lab.simulation.room import SimulatedRoom
from lab.simulation.small_house import load_small_house
from lab.simulation.world import HomeWorld, World
from ovip.errors import InvalidInput
from ovip.scene.types import F64, Intrinsics

ROBOT_RADIUS = 0.2
"""Metres, of the robots that drive here."""
PLANNING_RADIUS = 0.25
"""Metres, of the robot that a question speaks of: the product's default, so that plans leave the robot room."""
SHOWN_PIXELS = 60
"""Pixels in one view from which on a thing counts as shown to the camera."""
MOST_FRAMES = 360
"""Frames of a walk that are mapped: of a longer one every n-th."""
_WHOLE_HOMES = "open3d"


@dataclass(frozen=True, slots=True)
class WorldSpec:
    """kind: "home" (generated), "room" (the small one that needs no rendering package) or "small_house"."""

    kind: str
    seed: int
    root: Path | None = None

    @property
    def name(self) -> str:
        """As rows call it."""
        return self.kind if self.kind == "small_house" else f"{self.kind} {self.seed}"


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A world with its truth and where one can drive in it."""

    spec: WorldSpec
    world: Eyes
    truth: Truth
    terrain: Terrain


def worlds_of(options: Options) -> tuple[WorldSpec, ...]:
    """What `ovip eval` was pointed at. InvalidInput where no robot can drive there.

    Simulated homes; where the lab's rendering package is missing, the small room in as many variants.
    """
    if options.dataset == "small_house":
        if options.root is None:
            raise InvalidInput("--root: expected the folder of the small house")
        return (WorldSpec("small_house", options.seed, options.root),)
    if options.dataset is not None:
        raise InvalidInput(
            f"--dataset {options.dataset}: expected simulated homes (leave it out) or small_house, because a robot "
            "must be able to drive and look there"
        )
    kind = "home" if find_spec(_WHOLE_HOMES) else "room"
    return tuple(WorldSpec(kind, seed) for seed in range(options.seed, options.seed + options.homes))


def world_notes(specs: tuple[WorldSpec, ...]) -> tuple[str, ...]:
    """What a reader must know of the places."""
    if any(spec.kind == "room" for spec in specs):
        return (f"{_WHOLE_HOMES} is not installed: the small simulated room instead of simulated homes",)
    return ()


@functools.lru_cache(maxsize=1)
def place_of(spec: WorldSpec) -> Place:
    """The place, made; the last one is kept. NotConfigured where a package for it is missing."""
    if spec.kind == "room":
        room = SimulatedRoom(spec.seed)
        truth = truth_of_room(room)
        return Place(spec, Eyes(room, truth, spec.seed), truth, terrain_of_room(room, ROBOT_RADIUS))
    home = _home(spec)
    world = HomeWorld(home, CAMERA, spec.seed)
    truth = truth_of_home(home)
    return Place(spec, Eyes(world, truth, spec.seed), truth, terrain_of_ground(world.ground, ROBOT_RADIUS))


class Eyes:
    """A world whose robot detects on board as imperfectly as a real detector, and that notes what it was shown.

    shown: object id -> most pixels that any view so far held of it.
    """

    def __init__(self, world: World, truth: Truth, seed: int) -> None:
        self._world = world
        self._truth = truth_of(truth.things)
        self._model = FeatureModel(tuple(sorted({thing.label for thing in truth.things})))
        self.seed = seed
        self.shown: dict[int, int] = {}

    @property
    def intrinsics(self) -> Intrinsics:
        return self._world.intrinsics

    def walk(self) -> list[F64]:
        """The world's walk, of a long one every n-th pose."""
        poses = self._world.walk()
        return poses[:: -(-len(poses) // MOST_FRAMES)]

    def way(self, start: F64, via: F64, clearance: float) -> F64 | None:
        return self._world.way(start, via, clearance)

    def observe(self, pose: F64, index: int, before: F64 | None = None) -> Sight:
        """The world's view, with what an imperfect detector makes of it."""
        sight, _, looks = self.look(pose, index, before)
        return replace(sight, onboard=onboard_of(looks))

    def look(
        self, pose: F64, index: int, before: F64 | None = None
    ) -> tuple[Sight, SeenFrame, tuple[Look, ...]]:
        """The world's view, the same as a frame with its truth, and what the detector makes of it."""
        sight = self._world.observe(pose, index, before)
        for object_id, pixels in enumerate(np.bincount(sight.ids.ravel()).tolist()):
            if object_id and pixels:
                self.shown[object_id] = max(self.shown.get(object_id, 0), pixels)
        seen = SeenFrame(index, index, self.intrinsics, sight.pose, sight.rgb, sight.depth, sight.ids)
        return sight, seen, imperfect_looks(seen, self._truth, self._model, NOISY, self.seed)

    def shown_ids(self) -> tuple[int, ...]:
        """Ids of things of which some view held enough to recognise them."""
        return tuple(
            sorted(i for i, pixels in self.shown.items() if i in self._truth and pixels >= SHOWN_PIXELS)
        )


def _home(spec: WorldSpec) -> Home:
    if spec.kind == "small_house":
        assert spec.root is not None
        return load_small_house(spec.root)
    from lab.simulation.generate import make_home

    return make_home(spec.seed)
