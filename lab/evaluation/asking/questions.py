"""Questions from a place's truth: by class, by another word, attribute or relation, and for what is not there."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from lab.evaluation.asking.truth import Truth
from lab.simulation.home import STRUCTURE, HomeObject, RelationKind
from lab.simulation.imperfect.kinship import near_synonyms
from services.retrieval.domain.names import NameParams, match_name
from services.retrieval.domain.query import COLOURS


class Kind(StrEnum):
    """What a question says of its target."""

    CLASS = "class"
    OTHER_WORD = "other_word"
    ATTRIBUTE = "attribute"
    RELATION = "relation"


@dataclass(frozen=True, slots=True)
class Question:
    """text: as it is asked. label: the class asked for. meant: ids of the instances that answer it, none where it
    asks for something absent. alike: ids of the other instances of the class.
    """

    text: str
    kind: Kind
    label: str
    meant: tuple[int, ...] = ()
    alike: tuple[int, ...] = ()

    @property
    def present(self) -> bool:
        """Whether anything answers it."""
        return bool(self.meant)


@dataclass(frozen=True, slots=True)
class QuestionParams:
    """Most questions of each kind in one place, drawn by seed where there are more."""

    most: dict[Kind, int] = field(
        default_factory=lambda: {Kind.CLASS: 8, Kind.OTHER_WORD: 6, Kind.ATTRIBUTE: 6, Kind.RELATION: 4}
    )


def present_questions(
    truth: Truth, shown: Collection[int], seed: int, params: QuestionParams | None = None, most: int = 0
) -> tuple[Question, ...]:
    """Questions that something in the place answers, sorted by kind and text.

    shown: ids of the things that a camera was shown: one of them must answer. An attribute or a relation is asked
    only where it tells apart instances of one class. most: of all kinds together, 0 for no further limit.
    """
    params = params or QuestionParams()
    rng = np.random.default_rng([seed, 1])
    kept: list[Question] = []
    for kind, asked in (
        (Kind.CLASS, _by_class(truth)),
        (Kind.OTHER_WORD, _by_other_word(truth)),
        (Kind.ATTRIBUTE, _by_attribute(truth)),
        (Kind.RELATION, _by_relation(truth)),
    ):
        fair = sorted((q for q in asked if set(q.meant) & set(shown)), key=lambda q: q.text)
        kept += _drawn(fair, params.most.get(kind, 0), rng)
    return tuple(_drawn(kept, most, rng) if most else kept)


def absent_questions(truth: Truth, vocabulary: Sequence[str], seed: int, count: int) -> tuple[Question, ...]:
    """`count` questions that nothing in the place answers: every other one names a class of the vocabulary that the
    place has no instance of under any name, every other one a colour that no instance of a class there has.

    Where one of the two runs out the other goes on; fewer than `count` where both do.
    """
    rng = np.random.default_rng([seed, 2])
    classes, colours = _absent_classes(truth, vocabulary), _absent_colours(truth, rng)
    named = _drawn(classes, max(count - count // 2, count - len(colours)), rng)
    return tuple(sorted([*named, *_drawn(colours, count - len(named), rng)], key=lambda q: q.text))


def _by_class(truth: Truth) -> Iterable[Question]:
    for label, same in _classes(truth).items():
        yield Question(label, Kind.CLASS, label, _ids(same))


def _by_other_word(truth: Truth) -> Iterable[Question]:
    """Near synonyms that no instance is called by; every instance of any near synonym answers."""
    classes = _classes(truth)
    for word in sorted({word for label in classes for word in near_synonyms(label)} - classes.keys()):
        same = [thing for other in near_synonyms(word) for thing in classes.get(other, ())]
        yield Question(word, Kind.OTHER_WORD, word, _ids(same))


def _by_attribute(truth: Truth) -> Iterable[Question]:
    for label, same in _classes(truth).items():
        for word in sorted({word for thing in same for word in thing.attributes}):
            yield from _telling(
                f"{word} {label}", Kind.ATTRIBUTE, same, {t.object_id for t in same if word in t.attributes}
            )


def _by_relation(truth: Truth) -> Iterable[Question]:
    """By what carries it; what is next to what holds of so much that it tells little."""
    label_of = {thing.object_id: thing.label for thing in truth.things}
    said: dict[tuple[str, str, str], set[int]] = {}
    for relation in truth.relations:
        if relation.kind is RelationKind.NEXT:
            continue
        key = (label_of[relation.subject], relation.kind.value, label_of[relation.object])
        said.setdefault(key, set()).add(relation.subject)
    classes = _classes(truth)
    for (label, words, anchor), meant in sorted(said.items()):
        yield from _telling(f"the {label} {words} the {anchor}", Kind.RELATION, classes[label], meant)


def _telling(text: str, kind: Kind, same: Sequence[HomeObject], meant: set[int]) -> Iterable[Question]:
    """The question, if some instance of the class does not answer it."""
    others = {thing.object_id for thing in same} - meant
    if meant and others:
        yield Question(text, kind, same[0].label, tuple(sorted(meant)), tuple(sorted(others)))


def _absent_classes(truth: Truth, vocabulary: Sequence[str]) -> list[Question]:
    labels = sorted({thing.label for thing in truth.things} | STRUCTURE)
    return [
        Question(word, Kind.CLASS, word) for word in sorted(set(vocabulary)) if not _means_any(word, labels)
    ]


def _absent_colours(truth: Truth, rng: np.random.Generator) -> list[Question]:
    """Only of classes whose every instance has a colour among its attributes, and one colour of each."""
    basic = sorted(set(COLOURS.values()))
    found = []
    for label, same in sorted(_classes(truth).items()):
        worn = [{COLOURS[word] for word in thing.attributes if word in COLOURS} for thing in same]
        free = [colour for colour in basic if not any(colour in has for has in worn)]
        if all(worn) and free:
            colour = free[int(rng.integers(len(free)))]
            found.append(Question(f"{colour} {label}", Kind.ATTRIBUTE, label, (), _ids(same)))
    return found


def _means_any(word: str, labels: Sequence[str]) -> bool:
    """Whether the word may be said of a label, or a near synonym of the word may."""
    names = NameParams()
    return any(
        match_name(a, b, None, names) or match_name(b, a, None, names)
        for a in (word, *near_synonyms(word))
        for b in labels
    )


def _classes(truth: Truth) -> dict[str, list[HomeObject]]:
    classes: dict[str, list[HomeObject]] = {}
    for thing in truth.things:
        classes.setdefault(thing.label, []).append(thing)
    return classes


def _ids(things: Sequence[HomeObject]) -> tuple[int, ...]:
    return tuple(sorted(thing.object_id for thing in things))


def _drawn(questions: Sequence[Question], most: int, rng: np.random.Generator) -> list[Question]:
    """At most `most` of them, in their order."""
    if len(questions) <= most:
        return list(questions)
    return [questions[k] for k in sorted(rng.choice(len(questions), most, replace=False))]
