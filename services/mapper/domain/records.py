"""One object's state beside its box and feature sum, and what a step changed of all of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ovip.scene.types import (
    F64,
    Box2,
    MapDelta,
    MapObject,
    Move,
    Presence,
    Relation,
    StepKind,
)
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.presence import Evidence
from services.mapper.domain.shapes import Body

FRAMES_REMEMBERED = 32
_NO_SECOND = np.zeros(0)


Extent = tuple[int, F64]
"""A cloud's number of voxels, and its box `(6,)`."""


@dataclass(slots=True)
class ObjectRecord:
    """One object, the paper's o_j: everything but its box and its feature sum, which the table holds as rows.

    view_weight: Omega_j. label_counts: C_j, labels in the order they came. second_sum `(E,)`: the second encoder's
    feature sum. seen_by: the last frames that saw it, by number. settled, related: its cloud's size and box when upkeep
    last cleaned it, and last measured its relations; fresh: the box of what was added since that. watched: its cloud's
    size when its evidence was made. given_label: an operator's. deleted: the version at which an operator said it is
    not there, else 0. apart: ids that an operator said are other things. touched: the version of any change, version:
    of one that readers see, revision: of one that an edit must know of. The last ones are kept to be quick: slot,
    mode(C_j), and what was made of it.
    """

    object_id: str
    cloud: VoxelCloud
    view_weight: float
    label_counts: dict[str, int]
    observations: int
    frames: int
    seen_by: tuple[int, ...]
    first_seen_ns: int
    last_seen_ns: int
    best_weight: float
    best_frame_id: str
    best_box2: Box2
    last_batch: int
    second_sum: F64 = field(default_factory=lambda: _NO_SECOND)
    given_label: str = ""
    pinned: bool = False
    deleted: int = 0
    apart: frozenset[str] = frozenset()
    presence: Presence = Presence.PRESENT
    evidence: Evidence | None = None
    moves: tuple[Move, ...] = ()
    relations: tuple[Relation, ...] = ()
    settled: Extent | None = None
    related: Extent | None = None
    fresh: F64 | None = None
    watched: int = 0
    touched: int = 0
    version: int = 0
    revision: int = 0
    slot: int = -1
    mode: str = ""
    read: MapObject | None = None
    digest: bytes = b""
    body: Body | None = None

    def __post_init__(self) -> None:
        self.recount()

    @property
    def birth(self) -> int:
        """Which object of the map it is, in order of birth."""
        return int(self.object_id[1:])

    @property
    def label(self) -> str:
        """What readers call it."""
        return self.given_label or self.mode

    def is_confirmed(self, frames: int) -> bool:
        """Whether readers may believe in it: so many frames saw it, or an operator said something of it."""
        return self.frames >= frames or self.pinned or bool(self.given_label)

    def recount(self) -> None:
        """mode(C_j), ties to the label seen first."""
        self.mode = max(self.label_counts, key=lambda label: self.label_counts[label])


@dataclass(slots=True)
class Changes:
    """What one step has changed so far."""

    version: int
    created: set[str] = field(default_factory=set)
    updated: set[str] = field(default_factory=set)
    removed: set[str] = field(default_factory=set)
    aliases: dict[str, str] = field(default_factory=dict)
    departed: set[str] = field(default_factory=set)
    returned: set[str] = field(default_factory=set)
    moved: set[str] = field(default_factory=set)

    def delta(self, kind: StepKind, frame_id: str = "") -> MapDelta:
        """The step as its readers learn of it."""
        gone = self.removed | self.aliases.keys()

        def told(ids: set[str]) -> tuple[str, ...]:
            return tuple(sorted(ids - gone))

        return MapDelta(
            version=self.version,
            frame_id=frame_id,
            kind=kind,
            created=told(self.created),
            updated=told(self.updated - self.created),
            removed=tuple(sorted(self.removed)),
            aliases=dict(sorted(self.aliases.items())),
            departed=told(self.departed),
            returned=told(self.returned),
            moved=told(self.moved),
        )


def added(a: F64, b: F64) -> F64:
    """The sum of two feature sums of which either may be empty."""
    return a + b if len(a) == len(b) else (a if len(a) else b)


def remembered(frames: Iterable[int]) -> tuple[int, ...]:
    """The last FRAMES_REMEMBERED different ones, in order."""
    return tuple(dict.fromkeys(frames))[-FRAMES_REMEMBERED:]
