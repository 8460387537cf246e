"""What the store takes and gives, as values: entries of logs, leases, steps, documents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a log."""

    id: str
    fields: dict[str, bytes]


@dataclass(frozen=True, slots=True)
class Append:
    """What a step adds to a log. entry_id: above all that are there; empty: the store's own choice."""

    stream: str
    fields: Mapping[str, bytes | str | int]
    entry_id: str = ""


@dataclass(frozen=True, slots=True)
class Appended:
    """Where an entry is in its log, and whether it was there before."""

    id: str
    duplicate: bool


@dataclass(frozen=True, slots=True)
class Ingested:
    """Where a frame is in the log; `log_id` is empty for a sequence that was passed over."""

    log_id: str
    duplicate: bool
    length: int


@dataclass(frozen=True, slots=True)
class Lease:
    """The right to write one stage of one scene, until it expires or another takes it."""

    scene: str
    stage: str
    owner: str
    fence: int
    ttl_s: float


@dataclass(frozen=True, slots=True)
class Committed:
    """Whether this call applied the step (else an earlier one did), and the ids of what it appended."""

    applied: bool
    ids: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Document:
    """A compare-and-set value."""

    data: bytes
    revision: int
