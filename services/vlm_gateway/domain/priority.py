"""Who goes first when an upstream's limits make questions wait: search, then enumeration, then grouping."""

from __future__ import annotations

from dataclasses import dataclass

from services.vlm_gateway.domain.question import Purpose

_ORDER = tuple(Purpose)


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A place in the queue, smallest first: by urgency of purpose, by arrival among equals."""

    rank: int
    arrival: int

    @classmethod
    def of(cls, purpose: Purpose, arrival: int) -> Place:
        """The place of the `arrival`-th question asked, for `purpose`."""
        return cls(_ORDER.index(purpose), arrival)


def share_of(remaining: float, routes_left: int) -> float:
    """The part of `remaining` seconds for one route when `routes_left` (itself included) are to try."""
    return remaining / max(1, routes_left)
