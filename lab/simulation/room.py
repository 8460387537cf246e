"""A small furnished home with exact truth: an open-plan room, and a bedroom through a doorway.

World z up, metres, floor at 0. The main room (kitchen, dining, living) spans x 0..7, y 0..5; the bedroom x
7.1..10.7, y 1..5; the doorway is in the wall between them, y 2.2..3.1. A seed moves small things and chairs a
little and picks the grain of surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from lab.simulation.camera import CAMERA, EYE_HEIGHT, PITCH
from lab.simulation.detecting import Sight, onboard_detections
from lab.simulation.furniture import BUILDERS, COLORS, Color, Piece
from lab.simulation.rendering import Rendering, render
from lab.simulation.solids import Finish, Solid, footprint_distance
from lab.simulation.walking import is_clear, smooth_walk
from ovip.scene.boxes import box_of
from ovip.scene.types import F32, F64, U8, U16, Intrinsics

CEILING = 2.6
DOOR_TOP = 2.05
ROBOT_HEIGHT = 1.4

STRUCTURE = ("floor", "ceiling", "wall")

# low and high x, low and high y of the floor of each space; the doorway joins them
MAIN_ROOM = (0.0, 7.0, 0.0, 5.0)
BEDROOM = (7.1, 10.7, 1.0, 5.0)
DOORWAY = (7.0, 7.1, 2.2, 3.1)

_HALF_TURN, _QUARTER_TURN = np.pi, np.pi / 2


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedObject:
    """One thing with its truth. object_id: as rendered, from 1. color: a word. box: `(6,)`, exact bounds."""

    object_id: int
    label: str
    color: str
    box: F64
    structural: bool = False


@dataclass(frozen=True, slots=True)
class _Placed:
    """What stands where, give or take `wobble` metres in x and y and `turn` radians, as the seed has it."""

    label: str
    color: str
    at: tuple[float, float, float]
    yaw: float = 0.0
    wobble: float = 0.0
    turn: float = 0.0


_TABLE_TOP, _COUNTER_TOP, _STAND_TOP, _SHELF_TOP, _NIGHTSTAND_TOP = 0.74, 0.88, 0.45, 1.25, 0.50
# yaw 0: the front faces -y
_FURNITURE = (
    _Placed("table", "brown", (4.6, 2.4, 0)),
    _Placed("chair", "yellow", (4.25, 1.78, 0), yaw=_HALF_TURN, wobble=0.04, turn=0.25),
    _Placed("chair", "yellow", (4.95, 3.03, 0), wobble=0.04, turn=0.25),
    _Placed("chair", "yellow", (3.58, 2.45, 0), yaw=_QUARTER_TURN, wobble=0.04, turn=0.25),
    _Placed("sofa", "blue", (1.6, 0.46, 0), yaw=_HALF_TURN),
    _Placed("tv stand", "brown", (1.5, 4.77, 0)),
    _Placed("tv", "black", (1.5, 4.80, _STAND_TOP)),
    _Placed("bookshelf", "brown", (0.17, 2.7, 0), yaw=_QUARTER_TURN),
    _Placed("counter", "white", (4.45, 4.69, 0)),
    _Placed("sink", "gray", (4.35, 4.67, _COUNTER_TOP)),
    _Placed("oven", "black", (5.72, 4.70, 0)),
    _Placed("refrigerator", "white", (6.55, 4.65, 0)),
    _Placed("bed", "green", (9.66, 3.95, 0), yaw=-_QUARTER_TURN),
    _Placed("nightstand", "brown", (10.46, 2.9, 0), yaw=-_QUARTER_TURN),
    _Placed("mug", "white", (4.15, 2.25, _TABLE_TOP), wobble=0.05, turn=_HALF_TURN),
    _Placed("mug", "red", (4.95, 2.55, _TABLE_TOP), wobble=0.05, turn=_HALF_TURN),
    _Placed("laptop", "gray", (4.55, 2.45, _TABLE_TOP), wobble=0.03, turn=0.2),
    _Placed("bottle", "green", (3.75, 4.65, _COUNTER_TOP), wobble=0.05),
    _Placed("remote", "black", (0.98, 4.68, _STAND_TOP), wobble=0.02, turn=0.3),
    _Placed("vase", "orange", (0.17, 2.75, _SHELF_TOP), wobble=0.02),
    _Placed("book", "red", (10.44, 2.92, _NIGHTSTAND_TOP), wobble=0.03, turn=0.3),
)

# where the robot goes (x, y) and what it looks at (x, y) there
_ROUTE = (
    ((3.1, 1.5), (1.2, 4.6)),
    ((2.5, 2.6), (1.2, 4.6)),
    ((1.9, 3.3), (1.0, 4.6)),
    ((1.6, 3.1), (0.2, 2.7)),
    ((1.7, 3.0), (1.2, 0.6)),
    ((2.5, 3.0), (3.2, 1.0)),
    ((3.1, 3.3), (4.5, 2.4)),
    ((3.8, 3.7), (4.1, 4.8)),
    ((4.9, 3.75), (5.6, 4.8)),
    ((5.6, 3.5), (6.6, 4.7)),
    ((6.1, 3.1), (6.9, 2.9)),
    ((6.6, 2.65), (9.0, 2.6)),
    ((7.4, 2.65), (10.4, 2.8)),
    ((8.5, 2.4), (10.4, 2.9)),
    ((8.6, 2.3), (9.8, 3.9)),
    ((8.3, 2.4), (8.3, 5.0)),
    ((7.9, 2.65), (6.0, 3.0)),
    ((7.1, 2.65), (4.7, 2.6)),
    ((6.3, 2.4), (4.7, 2.4)),
    ((6.0, 1.4), (4.6, 2.4)),
    ((4.9, 0.85), (4.5, 2.4)),
    ((3.6, 0.9), (4.3, 2.4)),
    ((3.0, 1.5), (4.5, 2.5)),
)


class SimulatedRoom:
    """The home for one seed: its objects, what a camera sees, where a robot can stand, and a walk."""

    def __init__(self, seed: int = 0) -> None:
        self.seed = seed
        self.intrinsics: Intrinsics = CAMERA
        rng = np.random.default_rng(seed)
        pieces = [*_structure(), *_furnished(rng, first_id=1 + len(_STRUCTURE_BOXES))]
        self._solids: tuple[Solid, ...] = tuple(solid for _, _, piece in pieces for solid in piece.solids)
        self.objects: tuple[SimulatedObject, ...] = tuple(_object(*named) for named in pieces)
        self._obstacles = tuple(solid for solid in self._solids if _in_the_way(solid))

    def render(self, world_from_camera: F64) -> tuple[U8, F32, U16]:
        """rgb `(H, W, 3)` uint8, z-depth `(H, W)` float32 metres, object ids `(H, W)` uint16; 0 = nothing."""
        seen: Rendering = render(self._solids, self.intrinsics, world_from_camera, self.seed)
        return seen.rgb, seen.depth, seen.ids

    def walk(self) -> list[F64]:
        """Poses `(4, 4)` of the robot's round: 1.3 m high, a little downwards, small steps, clear of all."""
        places, targets = zip(*_ROUTE, strict=True)
        return smooth_walk(np.array(places), np.array(targets), EYE_HEIGHT, PITCH)

    def is_free(self, xy: F64, clearance: float = 0.2) -> bool:
        """Whether a robot of radius `clearance` can stand at floor point `xy` `(2,)` metres."""
        point = np.asarray(xy, dtype=np.float64)[None, :2]
        if not any(_within(point[0], space) for space in (MAIN_ROOM, BEDROOM, DOORWAY)):
            return False
        return all(footprint_distance(solid, point)[0] >= clearance for solid in self._obstacles)

    def way(self, start: F64, via: F64, clearance: float) -> F64 | None:
        """Floor points `(N, 3)` driven straight from `start` through `via` `(N, 3)`; None where that is blocked."""
        points = np.vstack([start, via]) * [1.0, 1.0, 0.0]
        clear = all(is_clear(lambda p: self.is_free(p, clearance), a, b) for a, b in pairwise(points))
        return points if clear else None

    def observe(self, pose: F64, index: int, before: F64 | None = None) -> Sight:
        """What the robot senses at `pose`: no noise, and exact detections on board."""
        rgb, depth, ids = self.render(pose)
        return Sight(rgb, depth, pose, ids, onboard_detections(self, ids))

    def object_with(self, object_id: int) -> SimulatedObject:
        """The object with this id, as in rendered ids."""
        return self.objects[object_id - 1]


_WALL, _FLOOR, _WHITE = (226, 222, 212), (176, 140, 104), (240, 240, 238)
# label, low corner, high corner, colour, finish
_STRUCTURE_BOXES: tuple[
    tuple[str, tuple[float, float, float], tuple[float, float, float], Color, Finish], ...
] = (
    ("floor", (-0.1, -0.1, -0.1), (10.8, 5.1, 0), _FLOOR, Finish.TILES),
    ("ceiling", (-0.1, -0.1, CEILING), (10.8, 5.1, CEILING + 0.1), _WHITE, Finish.PLAIN),
    ("wall", (-0.1, -0.1, 0), (7.1, 0, CEILING), _WALL, Finish.PLAIN),
    ("wall", (-0.1, 0, 0), (0, 5, CEILING), _WALL, Finish.PLAIN),
    ("wall", (-0.1, 5, 0), (10.8, 5.1, CEILING), _WALL, Finish.PLAIN),
    ("wall", (7.1, 0.9, 0), (10.8, 1.0, CEILING), _WALL, Finish.PLAIN),
    ("wall", (10.7, 1.0, 0), (10.8, 5, CEILING), _WALL, Finish.PLAIN),
    ("wall", (7.0, 0, 0), (7.1, 2.2, CEILING), _WALL, Finish.PLAIN),
    ("wall", (7.0, 3.1, 0), (7.1, 5, CEILING), _WALL, Finish.PLAIN),
    ("wall", (7.0, 2.2, DOOR_TOP), (7.1, 3.1, CEILING), _WALL, Finish.PLAIN),
)


def _structure() -> list[tuple[str, str, Piece]]:
    pieces = []
    for object_id, (label, low, high, color, finish) in enumerate(_STRUCTURE_BOXES, start=1):
        piece = Piece(object_id, color, (0.0, 0.0, 0.0))
        size = (high[0] - low[0], high[1] - low[1], high[2] - low[2])
        middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2)
        piece.box(middle, size, finish=finish)
        pieces.append((label, "brown" if label == "floor" else "white", piece))
    return pieces


def _furnished(rng: np.random.Generator, first_id: int) -> list[tuple[str, str, Piece]]:
    pieces = []
    for object_id, placed in enumerate(_FURNITURE, start=first_id):
        dx, dy, turn = rng.uniform(-1, 1, 3) * (placed.wobble, placed.wobble, placed.turn)
        at = (placed.at[0] + float(dx), placed.at[1] + float(dy), placed.at[2])
        piece = Piece(object_id, COLORS[placed.color], at, placed.yaw + float(turn))
        BUILDERS[placed.label](piece)
        pieces.append((placed.label, placed.color, piece))
    return pieces


def _object(label: str, color: str, piece: Piece) -> SimulatedObject:
    bounds = np.array([solid.bounds() for solid in piece.solids])
    box = box_of(np.concatenate([bounds[:, :3], bounds[:, 3:]]))
    return SimulatedObject(piece.object_id, label, color, box, structural=label in STRUCTURE)


def _in_the_way(solid: Solid) -> bool:
    """Whether a robot on the floor could run into it."""
    low, high = solid.bounds()[[2, 5]]
    return bool(low < ROBOT_HEIGHT and high > 0)


def _within(point: F64, space: tuple[float, float, float, float]) -> bool:
    return bool(space[0] <= point[0] <= space[1] and space[2] <= point[1] <= space[3])
