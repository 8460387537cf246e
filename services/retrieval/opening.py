"""Opening a question: checked, parsed, with one look at its scene and a judge within its budget."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ovip import keys
from ovip.errors import InvalidInput, NotFound
from ovip.scene.answers import Query
from ovip.scene.camera import check_pose
from ovip.scene.types import Region
from services.retrieval.case import Case, Limits
from services.retrieval.domain import cascade
from services.retrieval.domain.places import matching_regions
from services.retrieval.domain.priors import Priors
from services.retrieval.domain.query import Attribute, AttributeKind, Target, parse
from services.retrieval.domain.search import Search
from services.retrieval.evidence import FrameHistory, Sources, TextSpace, look_at
from services.retrieval.judge import Judge
from services.retrieval.ports import Crops, Scenes, Vlm
from services.retrieval.vlm_budget import VlmBudget

MOST_RADIUS = 2.0


@dataclass
class Desk:
    """Where questions are opened: the services they are answered from and the numbers they get."""

    sources: Sources
    scenes: Scenes
    vlm: Vlm
    crops: Crops
    limits: Limits
    max_vlm_calls: int
    text_space: TextSpace
    history: FrameHistory

    async def open(self, query: Query) -> Case:
        """A new question; InvalidInput, NotFound where it cannot be one."""
        return await self._open(query, 0)

    async def reopen(self, search: Search) -> Case:
        """A stored search's question, with what it has spent and rejected."""
        case = await self._open(search.query, search.vlm_calls)
        case.rejected.extend(search.account.rejected)
        case.judge.vlm.fallbacks[:0] = search.account.fallbacks
        case.priors = Priors(search.priors, "the stored plan") if search.priors else None
        return case

    async def check_scene(self, scene: str) -> None:
        """InvalidInput where the name cannot be a scene's, NotFound where there is no such scene."""
        keys.check_name(scene, "scene")
        if scene not in await self.scenes.scenes():
            raise NotFound(f"scene {scene!r}: there is no such scene")

    async def _open(self, query: Query, spent: int) -> Case:
        target = parse(query.text)
        _check(query)
        await self.check_scene(query.scene)
        evidence = await look_at(query.scene, self.sources, self.text_space, self.history)
        budget = VlmBudget(self.vlm, query.max_vlm_calls or self.max_vlm_calls, spent)
        case = Case(query, target, evidence, Judge(budget, self.crops, evidence), self.limits)
        case.places = _places(case)
        if target.purpose:
            case.alternatives = await _things(case)
            case.target = case.alternatives[0]
        return case


def _check(query: Query) -> None:
    cascade.bounds(query)
    if query.robot_pose is not None:
        check_pose(query.robot_pose)
    if not (np.isfinite(query.robot_radius) and 0.0 <= query.robot_radius <= MOST_RADIUS):
        raise InvalidInput(
            f"radius: expected 0 (default) to {MOST_RADIUS:g} metres, got {query.robot_radius}"
        )


def _places(case: Case) -> tuple[Region, ...]:
    """Regions that the hint, or a relation such as "in the kitchen", limits the question to; none for
    everywhere.
    """
    regions = case.evidence.partition.regions
    hinted = matching_regions(case.query.region_hint, regions)
    if case.query.region_hint and not hinted:
        case.evidence.note(
            f"region hint {case.query.region_hint!r}: no region is called so, looked everywhere"
        )
    said = {
        r.region_id: r
        for relation in case.target.relations
        for r in matching_regions(relation.anchor, regions)
    }
    both = tuple(region for region in hinted if region.region_id in said)
    return both or hinted or tuple(said.values())


async def _things(case: Case) -> tuple[Target, ...]:
    """Targets that serve the purpose, best first; where a fallback named them the purpose is left to be
    judged.
    """
    before = len(case.judge.vlm.fallbacks)
    nouns = await case.judge.things_for(case.target)
    guessed = len(case.judge.vlm.fallbacks) > before
    left = (Attribute(AttributeKind.OTHER, case.target.phrase),) if guessed else ()
    return tuple(replace(case.target, noun=noun, attributes=left, purpose="") for noun in nouns) or (
        case.target,
    )
