"""Snapshots of a map: segments in the blob store, each with what changed since the one before it (DESIGN 3)."""

from __future__ import annotations

import json
from dataclasses import dataclass

from ovip.errors import Corrupt
from ovip.store import Entry
from services.mapper.domain.object_map import ObjectMap

_MOST_SEGMENTS = 64


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A map's state in the blob store: segments, in order, and the bytes of each. applied: last detections entry."""

    version: int
    segments: tuple[str, ...]
    sizes: tuple[int, ...]
    state_hash: str
    applied: str

    def fields(self) -> dict[str, bytes | str | int]:
        """The snapshot as a log entry's fields."""
        return {
            "version": self.version,
            "segments": json.dumps(self.segments),
            "sizes": json.dumps(self.sizes),
            "state_hash": self.state_hash,
            "applied": self.applied,
        }


def snapshot_of(entry: Entry) -> Snapshot:
    """The snapshot in an entry of the snapshots log; Corrupt where it cannot be one."""
    try:
        return Snapshot(
            version=int(entry.fields["version"]),
            segments=tuple(json.loads(entry.fields["segments"])),
            sizes=tuple(json.loads(entry.fields["sizes"])),
            state_hash=entry.fields["state_hash"].decode(),
            applied=entry.fields["applied"].decode(),
        )
    except (KeyError, ValueError, TypeError) as error:
        raise Corrupt(f"snapshots log: entry {entry.id} is no snapshot ({error})") from error


def next_segment(objects: ObjectMap, base: Snapshot | None) -> tuple[bytes, Snapshot | None]:
    """What a snapshot of the map must add, and the snapshot that it goes on from; None: it holds all of the map.

    A new whole one is begun where the additions outgrew the whole one under them, or are many: so the segments of a
    snapshot hold at most about twice the map, and writing whole ones at most doubles what is written.
    """
    if base is None or sum(base.sizes[1:]) > base.sizes[0] or len(base.sizes) >= _MOST_SEGMENTS:
        return objects.segment(0), None
    return objects.segment(base.version), base
