"""The vocabulary gate, on and off, over tags that hold sporadic hallucinations: what is grounded, and what it maps."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from lab.evaluation.asking.truth import Truth
from lab.evaluation.asking.worlds import Place, WorldSpec, place_of, world_notes, worlds_of
from lab.evaluation.experiment import Options, Result, Row
from lab.evaluation.processes import in_processes
from lab.evaluation.rows import scene_means
from lab.evaluation.scores.vocabulary import Means, is_false, means_exactly, means_loosely, vocabulary_score
from lab.simulation.imperfect import batch_of, gated
from ovip.scene.types import F64, DetectionBatch, MapObject
from services.mapper.domain.object_map import map_of
from services.perception.domain.lifting import LiftParams

CONFIGS = ("gate on", "gate off")
_NOTES = (
    "tags are the words of an imperfect detector's labels, hallucinated ones among them, mapped with the defaults",
    "a word is right where a thing shown on the walk is called so, or by a near synonym; strict: by that very word",
    "an object is false where the box of nothing of its word touches its own; unconfirmed ones are never shown",
)


@dataclass(frozen=True, slots=True, eq=False)
class Walked:
    """What a walk gave. batches: ungated. labels: of the things that were shown for long enough to be recognised."""

    batches: tuple[DetectionBatch, ...]
    labels: frozenset[str]


def run(options: Options) -> Result:
    """Maps every place's walk twice."""
    specs = worlds_of(options)
    scenes = [row for rows in in_processes(_compare, specs, options.workers) for row in rows]
    return Result(rows=scene_means(scenes), scenes=scenes, notes=(*world_notes(specs), *_NOTES))


def compare(place: Place, poses: Sequence[F64]) -> list[Row]:
    """The rows of one place, seen from `poses` `(4, 4)` one after the other."""
    walked = _walk(place, poses)
    kept = {"gate on": tuple(gated(lambda: walked.batches)), "gate off": walked.batches}
    return [_row(config, kept[config], walked, place.truth) for config in CONFIGS]


def _compare(spec: WorldSpec) -> list[Row]:
    place = place_of(spec)
    return [{"scene": spec.name, **row} for row in compare(place, place.world.walk())]


def _walk(place: Place, poses: Sequence[F64]) -> Walked:
    """The batches of a walk, ungated, and the labels of what it showed."""
    lifting, before, batches = LiftParams(), None, []
    for index, pose in enumerate(poses):
        _, seen, looks = place.world.look(pose, index, before)
        batches.append(batch_of(seen.frame, looks, lifting))
        before = pose
    shown = set(place.world.shown_ids())
    return Walked(tuple(batches), frozenset(t.label for t in place.truth.things if t.object_id in shown))


def _row(config: str, batches: Sequence[DetectionBatch], walked: Walked, truth: Truth) -> Row:
    words = {word for batch in batches for word in batch.words}
    object_map = map_of(batches)
    objects = object_map.objects()
    compat, strict = (
        _score(words, objects, walked.labels, truth, means) for means in (means_loosely, means_exactly)
    )
    return {
        "config": config,
        "tags": len({word for batch in walked.batches for word in batch.words}),
        "words": len(words),
        "pairs": sum(len(batch.words) for batch in batches),
        "detections": sum(len(batch.detections) for batch in batches),
        "objects": len(objects),
        "unconfirmed": len(object_map.objects(include_unconfirmed=True)) - len(objects),
        **compat,
        "strict": strict,
    }


def _score(
    words: Collection[str], objects: Sequence[MapObject], labels: Collection[str], truth: Truth, means: Means
) -> dict[str, float]:
    score = vocabulary_score(words, labels, means)
    things = [(thing.label, thing.box) for thing in truth.things]
    return {
        "precision": score.precision,
        "recall": score.recall,
        "false_objects": sum(is_false(o.label, o.box, things, means) for o in objects),
    }
