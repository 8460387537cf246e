"""Absence: every question forced through an active search, of things that are there and of things that are not."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from lab.evaluation.asking.questions import Question, absent_questions, present_questions
from lab.evaluation.asking.stack import Mapped, copy_of, map_place, search, stack_over
from lab.evaluation.asking.worlds import Place, WorldSpec, place_of, world_notes, worlds_of
from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.processes import in_processes
from lab.evaluation.scores.absence import Confusion, Decision, confusion, half_of, wilson, within_budget
from lab.figures.searches import DrawnSearch, draw_searches
from lab.simulation.camera import EYE_HEIGHT
from ovip.scene.answers import Answer, Outcome
from ovip.scene.types import F64
from services.perception.adapters.full.naming import indoor_vocabulary

CONFIGS = ("full", "half")
_EACH = 4  # present and absent questions of one place
_WITHIN = 1.0
_NOTES = (
    "a search that ends without finding is a negative decision, whatever the answer is called",
    "strict: only the answer absent, every planned viewpoint seen, is one, and a find counts within 1 m of an instance",
    "half: the first half of the planned viewpoints of the same search, whose order does not depend on the budget",
    "every search begins from a copy of what the walk mapped, where the walk ended",
)


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """One search. found_at: the viewpoint, from 1, at which it found; None for never.

    miss: metres from what it found to the nearest instance. declared_absent: it answered absent, all seen.
    looks: `(N, 3)` places and headings that it looked from; found: `(3,)` what it gave, None for nothing.
    """

    scene: str
    question: Question
    planned: int
    visited: int
    unreachable: int
    found_at: int | None
    miss: float
    declared_absent: bool
    travelled: float
    needs: str
    looks: F64 = field(default_factory=lambda: np.zeros((0, 3)))
    found: F64 | None = None


def run(options: Options) -> Result:
    """Searches for every question in every place. NotConfigured where the text model is missing."""
    specs = worlds_of(options)
    each = max(1, options.queries // 2) if options.queries else _EACH
    with tempfile.TemporaryDirectory(prefix="ovip-eval-") as root:
        folders = [(spec, Path(root) / str(number)) for number, spec in enumerate(specs)]
        mapped = in_processes(partial(_mapped, each), folders, options.workers)
        asked = [(one, question) for one, questions in mapped for question in questions]
        searched = in_processes(_search, asked, options.workers)
    by_scene = {spec.name: [s for s in searched if s.scene == spec.name] for spec in specs}
    scenes = [
        {"scene": name, **row, "searches": [_plain(s) for s in here]}
        for name, here in by_scene.items()
        for row in rows_of(here)
    ]
    return Result(
        rows=rows_of(searched),
        scenes=scenes,
        figures=draw(options.figures, specs, searched) if options.figures else (),
        notes=(*world_notes(specs), *_NOTES, *_reasons(searched)),
    )


def _mapped(each: int, item: tuple[WorldSpec, Path]) -> tuple[Mapped, tuple[Question, ...]]:
    """A place mapped, and its questions: as many of what is there as of what is not."""
    mapped = map_place(*item)
    truth, seed = place_of(mapped.spec).truth, mapped.spec.seed
    present = present_questions(truth, mapped.shown, seed, most=each)
    return mapped, (*present, *absent_questions(truth, indoor_vocabulary().words, seed, each))


def search_for(mapped: Mapped, question: Question) -> Searched:
    """One search through tier 4 alone, in a copy of what was mapped."""
    return asyncio.run(_search_in_copy(place_of(mapped.spec), mapped, question))


def _search(item: tuple[Mapped, Question]) -> Searched:
    return search_for(*item)


async def _search_in_copy(place: Place, mapped: Mapped, question: Question) -> Searched:
    with copy_of(mapped.folder) as folder:
        async with stack_over(folder) as client:
            done = await search(place, client, question.text, place.world.walk()[-1], min_tier=4)
    answer, coverage = done.answer, done.answer.coverage
    return Searched(
        scene=place.spec.name,
        question=question,
        planned=coverage.planned if coverage else 0,
        visited=coverage.visited if coverage else 0,
        unreachable=coverage.unreachable if coverage else 0,
        found_at=coverage.visited if coverage and answer.outcome is Outcome.FOUND else None,
        miss=_miss(place, question, answer),
        declared_absent=answer.outcome is Outcome.ABSENT and coverage is not None and coverage.complete,
        travelled=done.travelled,
        needs=answer.needs,
        looks=done.looks,
        found=None if answer.object is None else answer.object.position,
    )


def _miss(place: Place, question: Question, answer: Answer) -> float:
    if answer.object is None or not question.meant:
        return float("inf")
    apart = np.linalg.norm(place.truth.centres(question.meant) - answer.object.position, axis=1)
    return float(apart.min())


def rows_of(searched: Sequence[Searched]) -> list[Row]:
    """A row for the whole plan, and one for its first half."""
    return [_row(config, searched) for config in CONFIGS]


def _row(config: str, searched: Sequence[Searched]) -> Row:
    compat = confusion([_decided(s, config) for s in searched], _WITHIN)
    return {
        "config": config,
        **_rates(compat),
        "viewpoints": float(np.mean([_looked(s, config) for s in searched])) if searched else 0.0,
        "unreachable": sum(s.unreachable for s in searched),
        "strict": _rates(_strict(config, searched)),
    }


def _rates(counts: Confusion) -> Row:
    low, high = wilson(counts.tp, counts.tp + counts.fn)
    absent_low, absent_high = wilson(counts.tn, counts.tn + counts.fp)
    return {
        "TP": counts.tp,
        "FN": counts.fn,
        "TN": counts.tn,
        "FP": counts.fp,
        "sensitivity": counts.sensitivity,
        "sensitivity_low": low,
        "sensitivity_high": high,
        "absent_accuracy": counts.absent_accuracy,
        "absent_low": absent_low,
        "absent_high": absent_high,
        "balanced_accuracy": counts.balanced_accuracy,
        "negative_precision": counts.negative_precision,
        "loc_1m": counts.located_rate,
    }


def _decided(s: Searched, config: str) -> Decision:
    return Decision(s.question.present, within_budget(s.found_at, _budget(s, config)), s.miss)


def _strict(config: str, searched: Sequence[Searched]) -> Confusion:
    """Finds count where they are right, and absence only where it was declared."""
    decided = [_decided(s, config) for s in searched]
    present = [(s, d) for s, d in zip(searched, decided, strict=True) if d.present]
    absent = [s for s in searched if not s.question.present]
    right = sum(d.declared and d.miss <= _WITHIN for _, d in present)
    declared = sum(s.declared_absent and _budget(s, config) >= s.planned for s in absent)
    return Confusion(right, len(present) - right, declared, len(absent) - declared, right)


def _budget(s: Searched, config: str) -> int:
    return half_of(s.planned) if config == "half" else s.planned


def _looked(s: Searched, config: str) -> int:
    return min(s.visited, _budget(s, config))


def _plain(s: Searched) -> Row:
    """One search in a line, for whoever asks what went wrong."""
    return {
        "text": s.question.text,
        "present": s.question.present,
        "found_at": s.found_at,
        "miss_m": s.miss if np.isfinite(s.miss) else None,
        "declared_absent": s.declared_absent,
        "planned": s.planned,
        "visited": s.visited,
        "travelled_m": s.travelled,
    }


def _reasons(searched: Sequence[Searched]) -> tuple[str, ...]:
    """Why searches for absent things were left open, with how often."""
    left_open = [s for s in searched if not s.question.present and not s.declared_absent and s.needs]
    needs = [s.needs.split("'")[0].strip() for s in left_open]
    return tuple(
        f"left open where nothing is there, {needs.count(why)} of {len(searched)} searches: needs {why}"
        for why in dict.fromkeys(needs)
    )


def draw(folder: Path, specs: Sequence[WorldSpec], searched: Sequence[Searched]) -> tuple[Path, ...]:
    """The first search for something present and the first for something absent, of each place."""
    drawn: list[Path] = []
    for spec in specs:
        place, here = place_of(spec), [s for s in searched if s.scene == spec.name]
        pair = [next(iter(s for s in here if s.question.present is there), None) for there in (True, False)]
        chosen = [_drawn(place, s) for s in pair if s is not None]
        grid = place.terrain.grids[_floor(place)]
        drawn.append(draw_searches(folder / f"absence-{spec.name.replace(' ', '-')}.png", grid, chosen))
    return tuple(drawn)


def _drawn(place: Place, s: Searched) -> DrawnSearch:
    end = "absent" if s.declared_absent else "left open"
    meant = [i for i in s.question.meant if place.truth.thing(i).floor == _floor(place)]
    title = f"{s.question.text}: {'found' if s.found is not None else end} after {s.visited} of {s.planned}"
    found = None if s.found is None else s.found[:2]
    return DrawnSearch(title, s.looks, place.truth.centres(meant)[:, :2], found)


def _floor(place: Place) -> int:
    """The storey on which the walk ends and a search begins."""
    return place.terrain.floor_at(float(place.world.walk()[-1][2, 3]) - EYE_HEIGHT)
