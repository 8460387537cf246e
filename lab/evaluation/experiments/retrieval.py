"""Retrieval success rate of the cascade, of its first tier alone, and of two ways to look a question up in the map."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from lab.evaluation.asking.policies import lexical, most_alike
from lab.evaluation.asking.questions import Question, present_questions
from lab.evaluation.asking.stack import find, map_place, stack_over, the_map
from lab.evaluation.asking.worlds import Place, WorldSpec, place_of, world_notes, worlds_of
from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.processes import in_processes
from lab.evaluation.scores.retrieval import Ranked, misses, misses_of_instance, success_rates
from ovip.scene.answers import Answer
from ovip.scene.types import F64, MapObject

CONFIGS = ("ours", "tier 1 only", "lexical", "CLIP")
_WITHIN = 1.0
_MOST_PLACES = 5
_NOTES = (
    "robots detect on board, imperfectly, and send no image features: an object's feature is its labels' text feature",
    "CLIP ranks all objects by that likeness, in the product's own text space",
    "a question that the cascade leaves open counts with its ranked candidates",
    "strict: on the right storey, and nearer to an instance that was meant than to any other of its class",
)


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What one configuration answered to one question. miss, strict: metres `(K,)`, best place first."""

    scene: str
    config: str
    question: Question
    tier: int
    miss: F64
    strict: F64

    @property
    def name(self) -> str:
        """Tells the question from those of other scenes."""
        return f"{self.scene}: {self.question.text}"


def run(options: Options) -> Result:
    """Asks every place its questions. NotConfigured where the text model is missing."""
    specs = worlds_of(options)
    found = [
        one
        for asked in in_processes(partial(_retrieve, options.queries), specs, options.workers)
        for one in asked
    ]
    by_scene = {spec.name: [f for f in found if f.scene == spec.name] for spec in specs}
    scenes = [
        {"scene": name, **row, "missed": _missed([f for f in here if f.config == row["config"]])}
        for name, here in by_scene.items()
        for row in _rows(here)
    ]
    return Result(rows=_rows(found), scenes=scenes, notes=(*world_notes(specs), *_NOTES))


def _retrieve(most: int, spec: WorldSpec) -> list[Found]:
    with tempfile.TemporaryDirectory(prefix="ovip-eval-") as folder:
        mapped = map_place(spec, Path(folder))
        place = place_of(spec)
        questions = present_questions(place.truth, mapped.shown, spec.seed, most=most)
        return asyncio.run(_ask(place, questions, mapped.folder))


async def _ask(place: Place, questions: Sequence[Question], folder: Path) -> list[Found]:
    pose = place.world.walk()[-1]
    async with stack_over(folder) as client:
        objects = (await the_map(client)).objects
        found: list[Found] = []
        for question in questions:
            ours = await find(client, question.text, pose)
            first = await find(client, question.text, pose, max_tier=1)
            feature = (await client.perception.embed_text([question.text]))[0]
            places = (_places(ours), _places(first), _centres(lexical(question.text, objects)))
            looked_up = (*places, _centres(most_alike(feature, objects)))
            found += [
                _found(place, config, question, tier, where)
                for config, tier, where in zip(CONFIGS, (ours.tier, first.tier, 0, 0), looked_up, strict=True)
            ]
    return found


def _found(place: Place, config: str, question: Question, tier: int, places: F64) -> Found:
    truth = place.truth
    ranked = Ranked(question.text, places, truth.centres(question.meant), truth.centres(question.alike))
    storeys = {place.truth.thing(i).floor for i in question.meant}
    on_storey = np.array([place.terrain.floor_at(float(z)) in storeys for z in places[:, 2]], dtype=bool)
    strict = np.where(on_storey, misses_of_instance(ranked), np.inf)
    return Found(place.spec.name, config, question, tier, misses(ranked), strict)


def _places(answer: Answer) -> F64:
    """Where the answer says the target is: its object, then its other candidates."""
    named = ([answer.object] if answer.object else []) + list(answer.candidates)
    return np.array([c.position for c in named[:_MOST_PLACES]], dtype=np.float64).reshape(-1, 3)


def _centres(objects: Iterable[MapObject]) -> F64:
    middles = [(o.box[:3] + o.box[3:]) / 2 for o in list(objects)[:_MOST_PLACES]]
    return np.array(middles, dtype=np.float64).reshape(-1, 3)


def _rows(found: Sequence[Found]) -> list[Row]:
    return [_row(config, [f for f in found if f.config == config]) for config in CONFIGS]


def _row(config: str, found: Sequence[Found]) -> Row:
    row: Row = {
        "config": config,
        "queries": len({f.name for f in found}),
        **success_rates([(f.name, f.miss) for f in found]),
    }
    for kind in sorted({f.question.kind for f in found}):
        same = [(f.name, f.miss) for f in found if f.question.kind is kind]
        row[f"top1_1m_{kind.value}"] = success_rates(same)["rsr_top1_1m"]
    if config == "ours":
        row |= _tiers(found)
    return {**row, "strict": success_rates([(f.name, f.strict) for f in found])}


def _missed(found: Sequence[Found]) -> list[str]:
    """The questions whose first place was not within a metre."""
    return [f.question.text for f in found if not (len(f.miss) and f.miss[0] <= _WITHIN)]


def _tiers(found: Sequence[Found]) -> dict[str, float]:
    """Of all questions, the share that each tier answered with a place within a metre."""
    hit = [f.tier for f in found if len(f.miss) and f.miss[0] <= _WITHIN]
    return {f"success_tier{tier}": hit.count(tier) / len(found) for tier in (1, 2, 3)} if found else {}
