"""From what the tiers said to the answer: the best candidate, where to stand, how to get there, what is still
needed.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ovip.scene.answers import Answer, Candidate, Outcome, TierReport, TierResult
from ovip.scene.building import floor_of
from ovip.scene.types import Floor
from services.retrieval.case import MOST_CANDIDATES, Case, Ruling, choice, spoken
from services.retrieval.domain.cascade import LAST_TIER
from services.retrieval.domain.goals import NO_PATH, way_to
from services.retrieval.tiers import as_candidate


def account(case: Case, reports: Sequence[TierReport], outcome: Outcome, tier: int) -> Answer:
    """An answer without an object: reports, rejected candidates, fallbacks and versions."""
    return Answer(
        outcome=outcome,
        tier=tier,
        object=None,
        goal=None,
        path=NO_PATH,
        tiers=tuple(reports),
        rejected=tuple(case.rejected[:MOST_CANDIDATES]),
        fallbacks=tuple(dict.fromkeys([*case.judge.vlm.fallbacks, *case.evidence.notes])),
        map_version=case.evidence.scene_map.version,
        regions_revision=case.evidence.partition.revision,
    )


async def found(case: Case, reports: Sequence[TierReport], tier: int, ruling: Ruling) -> Answer:
    """Found: the best candidate with a standoff pose and the way there; the others follow as candidates.

    Where there is no way the object's `why` says so, and the answer stands.
    """
    best, others = ruling.found[0], (*ruling.found[1:], *ruling.doubtful)
    box = best.box if best.box is not None else np.tile(best.position, 2)
    storey = _storey(case, best)
    building = await case.evidence.building(case.radius)
    start = await case.evidence.start(case.query.robot_pose)
    way = await asyncio.to_thread(way_to, box, start, building, storey.floor if storey else None)
    said = replace(best, why="; ".join(part for part in (best.why, way.why) if part))
    base = account(case, reports, Outcome.FOUND, tier)
    return replace(base, object=said, goal=way.goal, path=way.path, candidates=others[:MOST_CANDIDATES])


async def settle(case: Case, reports: Sequence[TierReport], ruling: Ruling, highest: int) -> Answer:
    """The answer that tiers 1 to 3 come to, `ruling` being the last one's."""
    tier = reports[-1].tier
    if ruling.found:
        return await found(case, reports, tier, ruling)
    if ruling.result is TierResult.AMBIGUOUS and tier == 1:
        return await _unjudged_instances(case, reports)
    base = account(case, reports, Outcome.UNRESOLVED, tier)
    return replace(base, candidates=ruling.doubtful[:MOST_CANDIDATES], needs=_needs(ruling, highest))


async def _unjudged_instances(case: Case, reports: Sequence[TierReport]) -> Answer:
    """Tier 1 left instances to Tier 2, which max_tier rules out: equal ones answer it, open ones do not."""
    instances = tuple(as_candidate(match) for match in case.matches)
    if case.target.plain and not any(match.name.leftover for match in case.matches):
        return await found(case, reports, 1, Ruling(TierResult.FOUND, "", instances))
    base = account(case, reports, Outcome.UNRESOLVED, 1)
    needs = "tier 2, which judges what a name cannot settle (max_tier is 1)"
    return replace(base, candidates=instances[:MOST_CANDIDATES], needs=needs)


def _needs(ruling: Ruling, highest: int) -> str:
    if ruling.unjudged:
        return f"a VLM to judge {spoken(ruling.unjudged)}, or {choice(ruling.doubtful)}"
    if ruling.doubtful:
        return f"a better look, or {choice(ruling.doubtful)}"
    left = f"tier {LAST_TIER}" if highest == LAST_TIER - 1 else f"tiers {highest + 1} to {LAST_TIER}"
    return f"{left}, which max_tier {highest} leaves out"


def _storey(case: Case, candidate: Candidate) -> Floor | None:
    """The floor that the object's region is on, else the one below it."""
    floors = case.evidence.partition.floors
    for region in case.evidence.partition.regions:
        if candidate.object_id and candidate.object_id in region.object_ids:
            return next((floor for floor in floors if floor.floor == region.floor), None)
    return floor_of(float(candidate.position[2]), floors)
