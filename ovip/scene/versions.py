"""What is known of a map across its versions and across scenes: differences, proofs, alignments."""

from __future__ import annotations

from dataclasses import dataclass

from ovip.scene.types import F64, MapObject


@dataclass(frozen=True, slots=True)
class ObjectChange:
    """One object at two versions; None where it was not there. fields: names of what differs.

    merged_into: where it is gone because it was merged, the survivor.
    """

    object_id: str
    before: MapObject | None
    after: MapObject | None
    fields: tuple[str, ...] = ()
    merged_into: str = ""


@dataclass(frozen=True, slots=True)
class MapDiff:
    """What differs between two versions, by object id."""

    from_version: int
    to_version: int
    changes: tuple[ObjectChange, ...]


@dataclass(frozen=True, slots=True)
class Verification:
    """A map in use against the one rebuilt from the first entry of its log.

    snapshots: how many on the way were compared; differing_versions: those whose hash differed.
    """

    version: int
    state_hash: str
    rebuilt_hash: str
    snapshots: int
    differing_versions: tuple[int, ...]
    steps: int

    @property
    def holds(self) -> bool:
        return self.state_hash == self.rebuilt_hash and not self.differing_versions


@dataclass(frozen=True, slots=True)
class Alignment:
    """The rigid `(4, 4)` that takes another recording's world to this one's.

    overlap: share of the smaller surface that lies on the other; rmse: of what lies on it, metres.
    """

    world_from_other: F64
    overlap: float
    rmse: float
