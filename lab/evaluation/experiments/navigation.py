"""Navigation to what was asked for: policies that share map, starts, driving and scorer, and differ in the goal."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from lab.evaluation.asking.drives import Bound, Start, drive, reachable_questions, start_of
from lab.evaluation.asking.policies import lexical, most_alike, nearest, random
from lab.evaluation.asking.questions import Question, present_questions
from lab.evaluation.asking.stack import Mapped, Search, copy_of, find, map_place, search, stack_over, the_map
from lab.evaluation.asking.worlds import Place, WorldSpec, place_of, world_notes, worlds_of
from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.processes import in_processes
from lab.evaluation.scores.navigation import Drive, identities, score_drives
from lab.simulation.camera import EYE_HEIGHT
from ovip.scene.answers import Answer
from ovip.scene.types import F64, MapObject

SEEDS = (710, 711, 712)
POLICIES = ("random", "nearest", "lexical", "CLIP", "ours", "ours, standoff")
_QUESTIONS = 8
_MOST_VIEWPOINTS = 60  # of one search; a question has three
_NOTES = (
    "random, nearest, lexical, CLIP drive to the middle of a mapped object; nearest: the nearest, whatever was asked",
    "CLIP ranks by the product's own text space, for the robots send no image features",
    "ours drives to its object, or to its best candidate where it leaves the question open",
    f"ours without either searches, at most {_MOST_VIEWPOINTS} viewpoints, and its robot's driving counts",
    '"ours, standoff" drives to the pose that the answer gives a robot',
    "starts and goals are on the storey on which the walk ends; a goal on another storey is not driven to",
    "success: within 1 m of the footprint of an instance; strict: within 1 m on foot of the place beside it",
)


@dataclass(frozen=True, slots=True)
class Driven:
    """One policy's drive for one question from one start."""

    scene: str
    policy: str
    seed: int
    question: str
    loose: Drive
    strict: Drive
    searched: bool


def run(options: Options) -> Result:
    """Drives every policy from every start. NotConfigured where the text model is missing."""
    specs = worlds_of(options)
    most = options.queries or _QUESTIONS
    driven = [d for one in in_processes(partial(_navigate, most), specs, options.workers) for d in one]
    scenes = [
        {"scene": spec.name, **row}
        for spec in specs
        for row in _rows([d for d in driven if d.scene == spec.name])
    ]
    return Result(rows=_rows(driven), scenes=scenes, notes=(*world_notes(specs), *_NOTES))


def _navigate(most: int, spec: WorldSpec) -> list[Driven]:
    with tempfile.TemporaryDirectory(prefix="ovip-eval-") as folder:
        mapped = map_place(spec, Path(folder))
        place = place_of(spec)
        floor = place.terrain.floor_at(float(place.world.walk()[-1][2, 3]) - EYE_HEIGHT)
        fair = reachable_questions(place, present_questions(place.truth, mapped.shown, spec.seed), floor)
        chosen = np.random.default_rng([spec.seed, 3]).permutation(len(fair))[:most]
        questions = [fair[k] for k in sorted(chosen.tolist())]
        return asyncio.run(_drive_all(place, mapped, questions, floor))


async def _drive_all(place: Place, mapped: Mapped, questions: Sequence[Question], floor: int) -> list[Driven]:
    driven: list[Driven] = []
    unanswered: list[tuple[Question, int, Start]] = []
    async with stack_over(mapped.folder) as client:
        objects = (await the_map(client)).objects
        for index, question in enumerate(questions):
            feature = (await client.perception.embed_text([question.text]))[0]
            for seed in SEEDS:
                start = start_of(place.terrain, floor, index, seed)
                rng = np.random.default_rng([seed, index, 1])
                ranked = {
                    "random": random(rng, objects),
                    "nearest": nearest(start.xy, objects),
                    "lexical": lexical(question.text, objects),
                    "CLIP": most_alike(feature, objects),
                }
                driven += [
                    _driven(place, name, seed, question, start, Bound(_middle(found)))
                    for name, found in ranked.items()
                ]
                answer = await find(client, question.text, start.pose)
                if answer.object or answer.candidates:
                    driven += _ours(place, seed, question, start, answer)
                else:
                    unanswered.append((question, seed, start))
    for question, seed, start in unanswered:
        done = await _searched(place, mapped, question, start)
        driven += _ours(place, seed, question, start, done.answer, done)
    return driven


def _ours(
    place: Place, seed: int, question: Question, start: Start, answer: Answer, done: Search | None = None
) -> list[Driven]:
    """Drives to the answer's object, or best candidate, and to its standoff pose; `done`: what it searched before."""
    named = answer.object or (answer.candidates[0] if answer.candidates else None)
    middle = None if named is None else named.position
    pose = middle if answer.goal is None else answer.goal.position
    travelled, last = (0.0, None) if done is None else (done.travelled, done.last[:2, 3])
    return [
        replace(
            _driven(place, policy, seed, question, start, Bound(goal, travelled, last)),
            searched=done is not None,
        )
        for policy, goal in zip(POLICIES[-2:], (middle, pose), strict=True)
    ]


def _driven(place: Place, policy: str, seed: int, question: Question, start: Start, bound: Bound) -> Driven:
    loose, strict = drive(place, question, start, bound)
    return Driven(place.spec.name, policy, seed, question.text, loose, strict, searched=False)


def _middle(ranked: Sequence[MapObject]) -> F64 | None:
    return (ranked[0].box[:3] + ranked[0].box[3:]) / 2 if ranked else None


async def _searched(place: Place, mapped: Mapped, question: Question, start: Start) -> Search:
    """An active search in a copy of the scene."""
    with copy_of(mapped.folder) as folder:
        async with stack_over(folder) as client:
            return await search(place, client, question.text, start.pose, most=_MOST_VIEWPOINTS)


def _rows(driven: Sequence[Driven]) -> list[Row]:
    return [_row(policy, [d for d in driven if d.policy == policy]) for policy in POLICIES]


def _row(policy: str, driven: Sequence[Driven]) -> Row:
    return {
        "config": policy,
        "queries": len({(d.scene, d.question) for d in driven}),
        **_score(driven, "loose"),
        "searched": sum(d.searched for d in driven),
        "as_short_as_shortest": identities([d.loose for d in driven]),
        "goals_at_truth": sum(d.loose.goal_is_truth for d in driven),
        "strict": _score(driven, "strict"),
    }


def _score(driven: Sequence[Driven], scored: str) -> dict[str, float]:
    by_seed = {seed: [getattr(d, scored) for d in driven if d.seed == seed] for seed in SEEDS}
    score = score_drives(by_seed)
    return {
        "SR": score.sr,
        "SR_std": score.sr_std,
        "SPL": score.spl,
        "SPL_std": score.spl_std,
        "path_m": score.path,
    }
