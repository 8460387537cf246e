"""Relations: precision and recall of what is said of pairs of things, kind by kind."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ovip.scene.types import RelationKind

Fact = tuple[int, RelationKind, int]
"""A thing, how it stands to another, and the other, by true object id."""

HOLDING = frozenset({RelationKind.ON, RelationKind.IN, RelationKind.ATTACHED_TO})


@dataclass(frozen=True, slots=True)
class KindCounts:
    """told: said; right: of those, true; true: that should have been said; found: of those, said."""

    told: int = 0
    right: int = 0
    true: int = 0
    found: int = 0

    def __add__(self, other: KindCounts) -> KindCounts:
        return KindCounts(
            self.told + other.told, self.right + other.right, self.true + other.true, self.found + other.found
        )

    @property
    def precision(self) -> float | None:
        """None where nothing was said."""
        return self.right / self.told if self.told else None

    @property
    def recall(self) -> float | None:
        """None where there was nothing to say."""
        return self.found / self.true if self.true else None


def kind_counts(told: Collection[Fact], true: Collection[Fact], kind: RelationKind) -> KindCounts:
    """Of one kind, to the letter."""
    said, facts = ({fact for fact in some if fact[1] is kind} for some in (told, true))
    return KindCounts(len(said), len(said & facts), len(facts), len(said & facts))


def loose_counts(told: Collection[Fact], true: Collection[Fact], kind: RelationKind) -> KindCounts:
    """Of one kind; what is in a thing may be told to be on it too, for it rests on its board or its bottom."""
    exact = kind_counts(told, true, kind)
    if kind is not RelationKind.ON:
        return exact
    within = {(one, kind, other) for one, was, other in true if was is RelationKind.IN}
    also = {fact for fact in told if fact[1] is kind and fact in within - set(true)}
    return KindCounts(exact.told, exact.right + len(also), exact.true, exact.found)


def holder_counts(told: Collection[Fact], true: Collection[Fact]) -> KindCounts:
    """Which thing holds which, be it on, in or attached to it."""
    said, facts = ({(one, other) for one, kind, other in some if kind in HOLDING} for some in (told, true))
    return KindCounts(len(said), len(said & facts), len(facts), len(said & facts))
