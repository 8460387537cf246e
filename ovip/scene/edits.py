"""What an operator may change of a map, as values."""

from __future__ import annotations

from dataclasses import dataclass

from ovip.scene.types import F64


@dataclass(frozen=True, slots=True)
class Rename:
    """The object is called `label` from now on; an empty label lets the detections' majority decide again."""

    object_id: str
    label: str


@dataclass(frozen=True, slots=True)
class Merge:
    """All are one thing, known as `keep_id`."""

    keep_id: str
    merged_ids: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """What of the object lies in `part` `(6,)` (low, high, world metres) is a thing of its own.

    part_label: empty for the object's own.
    """

    object_id: str
    part: F64
    part_label: str = ""


@dataclass(frozen=True, slots=True)
class Delete:
    """There is no such thing, whatever is detected there."""

    object_id: str


@dataclass(frozen=True, slots=True)
class Pin:
    """Upkeep neither merges a pinned object away nor gives it up."""

    object_id: str
    pinned: bool = True


Edit = Rename | Merge | Split | Delete | Pin


@dataclass(frozen=True, slots=True)
class EditRequest:
    """An edit, who made it, and the map version that they saw. edit_id: the same again changes nothing."""

    edit_id: str
    made_on_version: int
    operator: str
    edit: Edit
