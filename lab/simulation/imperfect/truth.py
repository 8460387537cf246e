"""What imperfect perception must know of a thing to see it wrongly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol


class TrueThing(Protocol):
    """A home's object has all of it."""

    @property
    def object_id(self) -> int: ...
    @property
    def label(self) -> str: ...
    @property
    def attributes(self) -> tuple[str, ...]: ...
    @property
    def structural(self) -> bool: ...


@dataclass(frozen=True, slots=True)
class Thing:
    """The same for who has no home."""

    object_id: int
    label: str
    attributes: tuple[str, ...] = ()
    structural: bool = False


Truth = Mapping[int, TrueThing]
"""Things by object id."""


def truth_of(things: Iterable[TrueThing]) -> Truth:
    """Things by their object id."""
    return {thing.object_id: thing for thing in things}
