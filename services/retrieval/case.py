"""One question being worked on: what was asked, where, with which judge; and what a tier says of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ovip.scene.answers import Candidate, Query, TierResult
from ovip.scene.types import F64, Region
from services.retrieval.domain.judgement import Judgement, Verdict
from services.retrieval.domain.lookup import ObjectMatch
from services.retrieval.domain.names import NameParams
from services.retrieval.domain.priors import Priors
from services.retrieval.domain.query import Target
from services.retrieval.domain.schedule import ScheduleParams
from services.retrieval.domain.tags import TagParams
from services.retrieval.domain.viewpoints import ViewpointParams
from services.retrieval.domain.votes import VoteParams, Voxel
from services.retrieval.evidence import Evidence
from services.retrieval.judge import Judge

MOST_CANDIDATES = 20
_LOOSE = 0.1  # metres by which a mapped box is taken larger when a new sighting may be the same thing


@dataclass(frozen=True, slots=True)
class Limits:
    """Numbers of one question: budgets, and the parameters of the paper's steps."""

    history_frames: int = 96
    ground_batch: int = 8
    viewpoints: int = 1200
    radius: float = 0.25
    detection_rate: float = 0.7
    names: NameParams = field(default_factory=NameParams)
    tags: TagParams = field(default_factory=TagParams)
    votes: VoteParams = field(default_factory=VoteParams)
    schedule: ScheduleParams = field(default_factory=ScheduleParams)
    viewpoint: ViewpointParams = field(default_factory=ViewpointParams)


@dataclass(frozen=True, slots=True)
class Ruling:
    """What a tier says. found: accepted, best first. doubtful: neither accepted nor rejected, best first.

    unjudged: words of the question that this judge had no way to judge. unexplored: where floor in reach ends at what
    was never seen, in words.
    """

    result: TierResult
    why: str
    found: tuple[Candidate, ...] = ()
    doubtful: tuple[Candidate, ...] = ()
    unjudged: tuple[str, ...] = ()
    unexplored: str = ""


@dataclass(frozen=True, slots=True)
class Doubt:
    """A voted candidate that could not be settled, and with how many frames it was judged."""

    candidate: Candidate
    frames: int


@dataclass
class Case:
    """A question in progress.

    places: the regions it is limited to, none for everywhere. alternatives: targets that serve the purpose
    asked for. matches: Tier 1's, for Tier 2 to judge. doubts: by voxel. unseeable: whether
    no grounder has a way to see it; None: not asked yet.
    """

    query: Query
    target: Target
    evidence: Evidence
    judge: Judge
    limits: Limits
    places: tuple[Region, ...] = ()
    alternatives: tuple[Target, ...] = ()
    matches: tuple[ObjectMatch, ...] = ()
    rejected: list[Candidate] = field(default_factory=list)
    doubts: dict[Voxel, Doubt] = field(default_factory=dict)
    priors: Priors | None = None
    unseeable: bool | None = None

    @property
    def radius(self) -> float:
        """The robot's radius, metres."""
        return self.query.robot_radius or self.limits.radius

    def regions(self) -> tuple[Region, ...]:
        """The regions that the question is about."""
        return self.places or self.evidence.partition.regions

    def is_rejected(self, position: F64) -> bool:
        """Whether a place lies in something already judged not to be the target."""
        return any(_holds(candidate, position, self.limits.votes.voxel) for candidate in self.rejected)


def judged(
    case: Case, candidates: Sequence[Candidate], judgements: Sequence[Judgement]
) -> list[tuple[Verdict, Candidate]]:
    """Each candidate with its verdict, the reason added and the scores multiplied; the rejected go to the
    case.
    """
    pairs = [(j.verdict, _with(c, j)) for c, j in zip(candidates, judgements, strict=True)]
    case.rejected.extend(chosen(pairs, Verdict.REJECT))
    return pairs


def chosen(pairs: Sequence[tuple[Verdict, Candidate]], wanted: Verdict) -> tuple[Candidate, ...]:
    """The candidates of one verdict, best first; ties keep their order."""
    return ranked([candidate for verdict, candidate in pairs if verdict is wanted])


def ranked(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Best score first; ties keep their order."""
    return tuple(sorted(candidates, key=lambda candidate: -candidate.score))


def choice(candidates: Sequence[Candidate]) -> str:
    """`a choice among the 3 candidates`, or what to do with one."""
    return (
        f"a choice among the {len(candidates)} candidates"
        if len(candidates) > 1
        else "a look at the candidate"
    )


def spoken(words: Sequence[str]) -> str:
    """`'a', 'b' and 'c'`."""
    quoted = [repr(word) for word in dict.fromkeys(words)]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


def _holds(candidate: Candidate, position: F64, reach: float) -> bool:
    if candidate.box is None:
        return float(np.linalg.norm(candidate.position - position)) <= reach
    return bool(((position >= candidate.box[:3] - _LOOSE) & (position <= candidate.box[3:] + _LOOSE)).all())


def _with(candidate: Candidate, judgement: Judgement) -> Candidate:
    why = "; ".join(part for part in (candidate.why, judgement.why) if part)
    return replace(candidate, score=candidate.score * judgement.score, why=why)
