"""The words of the system as values: what a frame, a detection, an object and a region are (one word per thing)."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import numpy.typing as npt

F32 = npt.NDArray[np.float32]
F64 = npt.NDArray[np.float64]
U8 = npt.NDArray[np.uint8]
U16 = npt.NDArray[np.uint16]
I32 = npt.NDArray[np.int32]
I64 = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

NEAREST_BLOCK = 4
"""Pixels along the edge of a block of `DetectionBatch.nearest`."""


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Pinhole camera in pixels; pixel centres at integers."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class Box2:
    """Axis-aligned box in pixels, half-open: `x0 <= x < x1`."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        return max(0.0, self.x1 - self.x0) * max(0.0, self.y1 - self.y0)


@dataclass(frozen=True, slots=True)
class Frame:
    """One posed RGB-D image pair, decoded.

    rgb: `(H, W, 3)` uint8. depth: `(H, W)` float32 metres, 0 = no measurement.
    world_from_camera: `(4, 4)` float64, rigid; world z up.
    """

    frame_id: str
    timestamp_ns: int
    intrinsics: Intrinsics
    world_from_camera: F64
    rgb: U8
    depth: F32


@dataclass(frozen=True, slots=True)
class Detection:
    """One mask in one frame, lifted to 3D.

    box: `(6,)` float64, low then high corner, world metres. feature: `(D,)` float32, unit length.
    points: `(N, 3)` float32 world metres. colors: `(N, 3)` uint8 RGB. second_feature: `(E,)` float32 of a second
    encoder (DINO family), unit length, which may only veto merges; empty where none looked.
    """

    detection_id: str
    label: str
    score: float
    box2: Box2
    box: F64
    feature: F32
    points: F32
    colors: U8
    second_feature: F32 = field(default_factory=lambda: np.zeros(0, np.float32))


@dataclass(frozen=True, slots=True)
class DetectionBatch:
    """Everything found in one frame for the words grounded in it.

    surface: `(N, 3)` float32, a coarse cloud of all of the frame's depth. nearest: `(h, w)` float32, the nearest depth
    in metres measured in each block of NEAREST_BLOCK x NEAREST_BLOCK pixels, 0 where there is too little of it (what
    the frame saw through). Both empty where `late`.
    """

    frame_id: str
    timestamp_ns: int
    intrinsics: Intrinsics
    world_from_camera: F64
    detections: tuple[Detection, ...]
    surface: F32
    words: tuple[str, ...] = ()
    late: bool = False
    nearest: F32 = field(default_factory=lambda: np.zeros((0, 0), np.float32))


class Presence(StrEnum):
    """Whether an object is where the map has it: later depth may have seen through its place."""

    PRESENT = "present"
    MOVED_OR_REMOVED = "moved_or_removed"


class RelationKind(StrEnum):
    """How an object stands to another, by geometry alone."""

    ON = "on"
    IN = "in"
    NEXT_TO = "next_to"
    ATTACHED_TO = "attached_to"


@dataclass(frozen=True, slots=True)
class Relation:
    """Its holder stands in a relation to `other_id`. evidence: what was measured, by name (metres or shares)."""

    kind: RelationKind
    other_id: str
    evidence: dict[str, float]


@dataclass(frozen=True, slots=True)
class Move:
    """An object was recognised at another place. origin: its `(3,)` centroid before, world metres."""

    timestamp_ns: int
    origin: F64


@dataclass(frozen=True, slots=True)
class MapObject:
    """One mapped object, the paper's o_j, as readers see it.

    centroid: `(3,)`; box: `(6,)` low then high, world metres. feature: `(D,)` unit. mean_color: `(3,)` RGB 0..255.
    frames: different frames that saw it; of parts that merge, those before the last 32 of either may count twice.
    version: the map's, when anything of it last changed; revision: the map's, when last it was born, renamed, merged,
    split, moved, given up or edited (what an operator's edit must know of). pinned: upkeep leaves it alone.
    label_given: its label is an operator's.
    """

    object_id: str
    label: str
    label_counts: dict[str, int]
    centroid: F64
    box: F64
    feature: F32
    view_weight: float
    observations: int
    frames: int
    first_seen_ns: int
    last_seen_ns: int
    voxels: int
    mean_color: F64
    best_frame_id: str
    best_box2: Box2
    version: int
    revision: int = 0
    presence: Presence = Presence.PRESENT
    pinned: bool = False
    label_given: bool = False
    relations: tuple[Relation, ...] = ()
    moves: tuple[Move, ...] = ()


@dataclass(frozen=True, slots=True)
class SceneMap:
    """A scene's objects at one version."""

    scene: str
    version: int
    objects: tuple[MapObject, ...]
    state_hash: str
    frames: int
    detections: int
    applied_log_id: str


class StepKind(StrEnum):
    """What made a version of a map: a frame's detections, upkeep, an operator's edit, a map joined, new settings."""

    FRAME = "frame"
    UPKEEP = "upkeep"
    EDIT = "edit"
    JOIN = "join"
    SETTINGS = "settings"


@dataclass(frozen=True, slots=True)
class MapDelta:
    """What one version changed: object ids, and losers -> survivors.

    removed: gone for good, as noise or by an operator. departed: found moved or removed; returned: seen again there;
    moved: recognised at another place. Those three are updated, too.
    """

    version: int
    frame_id: str
    kind: StepKind = StepKind.FRAME
    created: tuple[str, ...] = ()
    updated: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    aliases: dict[str, str] = field(default_factory=dict)
    departed: tuple[str, ...] = ()
    returned: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Region:
    """One functional floor region. outlines, holes: tuples of `(N, 2)` world metres, open rings.

    frame_ids: taken in it. seen_by: the frames that see most of its floor, best first.
    """

    region_id: str
    floor: int
    function: str
    display_name: str
    area: float
    centroid: F64
    outlines: tuple[F64, ...]
    holes: tuple[F64, ...]
    object_ids: tuple[str, ...]
    frame_ids: tuple[str, ...]
    seen_by: tuple[str, ...] = ()


class EdgeKind(StrEnum):
    """How two regions are joined: by a border without a wall, a passage as narrow as a door, or stairs."""

    OPENING = "opening"
    DOORWAY = "doorway"
    STAIRS = "stairs"


@dataclass(frozen=True, slots=True)
class RegionEdge:
    """Two regions that touch, and the opening between them. position: `(3,)` metres; width in metres.

    Stairs join regions of two floors: `position` is their foot, in `a`, and `upper` `(3,)` their head, in `b`.
    """

    a: str
    b: str
    width: float
    position: F64
    kind: EdgeKind = EdgeKind.OPENING
    upper: F64 | None = None


@dataclass(frozen=True, slots=True)
class Frontier:
    """Where the floor that was seen ends at what never was. position: `(3,)` metres, its middle, on seen floor;
    width: metres along it; region_id: "" where that floor belongs to none."""

    floor: int
    region_id: str
    position: F64
    width: float


@dataclass(frozen=True, slots=True)
class Floor:
    """One storey: heights in metres (`ceiling_z` None where no ceiling was seen), area in square metres."""

    floor: int
    z: float
    ceiling_z: float | None
    area: float


class RegionEventKind(StrEnum):
    """What became of a region. RESHAPED: its floor changed by more than a tenth."""

    APPEARED = "appeared"
    VANISHED = "vanished"
    RETYPED = "retyped"
    RESHAPED = "reshaped"


@dataclass(frozen=True, slots=True)
class RegionEvent:
    """What became of one region from one partition to the next.

    display_name: now; of a vanished one, its last. other: of an appeared one, the region that most of its floor
    belonged to; of a vanished one, the region that most of it belongs to now; "" for none.
    """

    kind: RegionEventKind
    region_id: str
    floor: int
    display_name: str
    other: str = ""


@dataclass(frozen=True, slots=True)
class Partition:
    """The floors of a scene cut into regions, and the map version they were cut from.

    events: what changed since the revision before.
    """

    map_version: int
    revision: int
    floors: tuple[Floor, ...] = ()
    regions: tuple[Region, ...] = ()
    edges: tuple[RegionEdge, ...] = ()
    fallbacks: tuple[str, ...] = ()
    frontiers: tuple[Frontier, ...] = ()
    events: tuple[RegionEvent, ...] = ()
