"""What is asked and what is answered: queries, tier reports, viewpoints, coverage, answers (SPEC 4)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from ovip.scene.types import F64, Box2, Intrinsics


class Outcome(StrEnum):
    FOUND = "found"
    ABSENT = "absent"
    UNRESOLVED = "unresolved"


class TierResult(StrEnum):
    FOUND = "found"
    AMBIGUOUS = "ambiguous"
    MISSING = "missing"
    REJECTED = "rejected"
    SKIPPED = "skipped"
    WAITING = "waiting"
    EXHAUSTED = "exhausted"


@dataclass(frozen=True, slots=True)
class Query:
    """A question. robot_pose: `(4, 4)` world_from_camera or None. Zeros mean the service's default."""

    scene: str
    text: str
    robot_pose: F64 | None = None
    robot_radius: float = 0.0
    region_hint: str = ""
    min_tier: int = 0
    max_tier: int = 0
    max_vlm_calls: int = 0
    max_viewpoints: int = 0


@dataclass(frozen=True, slots=True)
class TierReport:
    """Why a tier answered, or why it did not, and what it cost."""

    tier: int
    result: TierResult
    why: str
    vlm_calls: int
    ms: float


@dataclass(frozen=True, slots=True)
class Candidate:
    """A place the target may be. position: `(3,)`; box: `(6,)` low then high, metres, or None."""

    label: str
    position: F64
    score: float
    why: str
    object_id: str = ""
    box: F64 | None = None
    frame_id: str = ""
    box2: Box2 | None = None


@dataclass(frozen=True, slots=True)
class Goal:
    """Where to stand and which way to face. position: `(3,)` on the floor; yaw in radians."""

    position: F64
    yaw: float


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """One heading at one waypoint of an active search. path: `(N, 3)` floor positions to it."""

    viewpoint_id: str
    position: F64
    yaw: float
    region_id: str
    index: int
    total: int
    path: F64


@dataclass(frozen=True, slots=True)
class RegionCoverage:
    """How much of a region's floor a search has seen, and how likely the target was there."""

    region_id: str
    display_name: str
    area: float
    seen: float
    prior: float


@dataclass(frozen=True, slots=True)
class Coverage:
    """What an absence rests on."""

    planned: int
    visited: int
    unreachable: int
    regions: tuple[RegionCoverage, ...]
    posterior_present: float
    complete: bool


@dataclass(frozen=True, slots=True)
class Answer:
    """Found, Absent or Unresolved, with the whole account. path: `(N, 3)` floor positions, maybe empty."""

    outcome: Outcome
    tier: int
    object: Candidate | None
    goal: Goal | None
    path: F64
    tiers: tuple[TierReport, ...]
    candidates: tuple[Candidate, ...] = ()
    rejected: tuple[Candidate, ...] = ()
    fallbacks: tuple[str, ...] = ()
    map_version: int = 0
    regions_revision: int = 0
    coverage: Coverage | None = None
    needs: str = ""


@dataclass(frozen=True, slots=True)
class Observation:
    """What a robot answers to a viewpoint: a frame, or that it cannot get there."""

    viewpoint_id: str
    frame_id: str = ""
    unreachable: bool = False


@dataclass(frozen=True, slots=True)
class TierStarted:
    tier: int


SearchEvent = TierStarted | TierReport | Viewpoint | Answer


@dataclass(frozen=True, slots=True)
class FrameRecord:
    """A frame of the history without its images."""

    frame_id: str
    timestamp_ns: int
    world_from_camera: F64
    intrinsics: Intrinsics
    tags: tuple[str, ...] = ()
    processed: bool = False
    log_id: str = ""


@dataclass(frozen=True, slots=True)
class PerceptionStatus:
    """Where perception stands with a scene."""

    frames_durable: int
    frames_processed: int
    frames_skipped: int
    vocabulary: tuple[str, ...]
    world_from_source: F64
    backend: str
    feature_space: str
    detections: int = 0
    newest_detections_id: str = ""


@dataclass(frozen=True, slots=True)
class SceneSummary:
    """One line about a scene."""

    scene: str
    map_version: int
    objects: int
    frames: int
    detections: int


@dataclass(frozen=True, slots=True)
class VlmReply:
    """A VLM's schema-checked reply. value: the parsed JSON."""

    value: object
    cached: bool = False
    route: str = ""
    prompt_tokens: int = 0
    output_tokens: int = 0
    ms: float = 0.0


@dataclass(frozen=True, slots=True)
class GatewayStatus:
    """What the VLM gateway has done."""

    configured: bool
    routes: tuple[str, ...] = ()
    calls: int = 0
    cache_hits: int = 0
    refused: int = 0
