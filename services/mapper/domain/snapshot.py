"""A map's state as bytes and back: segments of what changed since a version (DESIGN 3)."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import Box2, Move, Presence, Relation, RelationKind
from services.mapper.domain.cloud import VoxelCloud
from services.mapper.domain.objects import ObjectTable
from services.mapper.domain.params import MapParams, params_json, params_of
from services.mapper.domain.presence import Evidence
from services.mapper.domain.records import Extent, ObjectRecord

FORMAT = 2
_MAGIC = b"OVIPMAP\n"


@dataclass(frozen=True, slots=True)
class Head:
    """What a segment says beside its objects.

    since: the version above which it tells all changes, 0 for everything. gone: ids that were removed or merged away
    since; aliases: those among them that were merged (from 0: all). dirty: ids that upkeep has yet to look at.
    """

    since: int
    version: int
    frames: int
    detections: int
    batches: int
    upkept_batches: int
    born: int
    dimension: int | None
    aliases: dict[str, str]
    gone: list[str]
    dirty: list[str]
    params: MapParams


def write_head(head: Head) -> bytes:
    """A head as JSON, the same for the same head."""
    plain = {f.name: getattr(head, f.name) for f in dataclasses.fields(head)}
    return _json({**plain, "params": params_json(head.params)})


def write_segment(table: ObjectTable, head: Head, records: Sequence[ObjectRecord]) -> bytes:
    """A segment: magic, format, length and bytes of the head, then each record's."""
    text = write_head(head)
    parts = [_MAGIC, _number(FORMAT), _number(len(text)), text, _number(len(records))]
    for record in records:
        plain, arrays = _json(_plain(record)), _array_bytes(table, record)
        parts += [_number(len(plain)), plain, arrays]
    return b"".join(parts)


def record_digest(table: ObjectTable, record: ObjectRecord) -> bytes:
    """SHA-256 of one object's state."""
    return hashlib.sha256(_json(_plain(record)) + _array_bytes(table, record)).digest()


def read_segments(segments: Sequence[bytes]) -> tuple[Head, ObjectTable]:
    """The state after the last of the segments, which come in order; the first tells everything.

    InvalidInput for another format, Corrupt where bytes are missing or segments do not follow one another.
    """
    if not segments:
        raise Corrupt("map snapshot: expected at least one segment")
    aliases: dict[str, str] = {}
    found: dict[str, tuple[ObjectRecord, npt.NDArray[np.float64]]] = {}
    head = None
    for data in segments:
        reader = _Reader(data)
        later = reader.head()
        if later.since and (head is None or later.since != head.version):
            raise Corrupt(
                f"map snapshot: a segment since version {later.since} follows one of version "
                f"{head.version if head else 'none'}"
            )
        head = later
        if not head.since:
            found.clear()
            aliases.clear()
        for name in head.gone:
            found.pop(name, None)
        aliases.update(head.aliases)
        for record, feature_sum in reader.records(head.dimension or 0):
            found[record.object_id] = (record, feature_sum)
    assert head is not None
    table = ObjectTable()
    table.dimension = head.dimension
    for record, feature_sum in sorted(found.values(), key=lambda pair: pair[0].birth):
        table.restore(record, feature_sum)
    table.born, table.aliases, table.dirty = head.born, aliases, set(head.dirty)
    return head, table


_ARRAYS = {"cloud", "second_sum", "evidence", "settled", "related", "fresh"}
_CACHES = {"slot", "mode", "read", "digest", "body"}
_PLAIN = [f.name for f in dataclasses.fields(ObjectRecord) if f.name not in _ARRAYS | _CACHES]


def _plain(record: ObjectRecord) -> dict[str, Any]:
    plain = {name: getattr(record, name) for name in _PLAIN}
    box2, evidence = record.best_box2, record.evidence
    return {
        **plain,
        "best_box2": [box2.x0, box2.y0, box2.x1, box2.y1],
        "apart": sorted(record.apart),
        "moves": [[move.timestamp_ns, move.origin.tolist()] for move in record.moves],
        "relations": [[r.kind, r.other_id, r.evidence] for r in record.relations],
        "settled": _extent(record.settled),
        "related": _extent(record.related),
        "fresh": None if record.fresh is None else record.fresh.tolist(),
        "size": record.cloud.size,
        "level": record.cloud.level,
        "voxels": len(record.cloud),
        "second": len(record.second_sum),
        "samples": len(evidence.points) if evidence else -1,
    }


def _array_bytes(table: ObjectTable, record: ObjectRecord) -> bytes:
    arrays: list[npt.NDArray[Any]] = [
        table.feature_sum(record), record.second_sum, record.cloud.keys, record.cloud.tally
    ]  # fmt: skip
    if record.evidence:
        arrays += [record.evidence.points, record.evidence.counts]
    return b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)


class _Reader:
    """Takes a segment apart, from front to back."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0
        if self._take(len(_MAGIC)) != _MAGIC:
            raise Corrupt("map snapshot: it does not start as one")
        if (written := self._number()) != FORMAT:
            raise InvalidInput(f"map snapshot of format {written}: this version reads format {FORMAT}")

    def head(self) -> Head:
        plain = self._plain("its head")
        try:
            return Head(**{**plain, "params": params_of(plain["params"])})
        except (TypeError, KeyError) as error:
            raise Corrupt(f"map snapshot: its head is not one ({error})") from error

    def records(self, dimension: int) -> Iterator[tuple[ObjectRecord, npt.NDArray[np.float64]]]:
        for _ in range(self._number()):
            try:
                yield self._record(self._plain("an object"), dimension)
            except (KeyError, TypeError, ValueError) as error:
                raise Corrupt(f"map snapshot: an object is not one ({error})") from error
        if self._at != len(self._data):
            raise Corrupt(f"map snapshot: expected {self._at} bytes, got {len(self._data)}")

    def _record(self, plain: dict[str, Any], dimension: int) -> tuple[ObjectRecord, npt.NDArray[np.float64]]:
        voxels, samples = plain["voxels"], plain["samples"]
        feature_sum = self._array(np.float64, dimension)
        second = self._array(np.float64, plain["second"])
        cloud = VoxelCloud(
            self._array(np.int64, voxels),
            self._array(np.int32, 7 * voxels).reshape(voxels, 7),
            plain["size"],
            plain["level"],
        )
        evidence = None
        if samples >= 0:
            points = self._array(np.float32, 3 * samples).reshape(samples, 3)
            evidence = Evidence(points, self._array(np.int8, samples))
        values = {name: plain[name] for name in _PLAIN}
        values |= {
            "seen_by": tuple(plain["seen_by"]),
            "best_box2": Box2(*plain["best_box2"]),
            "apart": frozenset(plain["apart"]),
            "presence": Presence(plain["presence"]),
            "moves": tuple(Move(time, np.array(origin)) for time, origin in plain["moves"]),
            "relations": tuple(
                Relation(RelationKind(kind), other, evidence_of)
                for kind, other, evidence_of in plain["relations"]
            ),
            "settled": _extent_of(plain["settled"]),
            "related": _extent_of(plain["related"]),
            "fresh": np.array(plain["fresh"]) if plain["fresh"] else None,
        }
        record = ObjectRecord(cloud=cloud, second_sum=second, evidence=evidence, **values)
        return record, feature_sum

    def _plain(self, what: str) -> dict[str, Any]:
        text = self._take(self._number())
        try:
            plain = json.loads(text)
        except ValueError as error:
            raise Corrupt(f"map snapshot: {what} does not parse") from error
        if not isinstance(plain, dict):
            raise Corrupt(f"map snapshot: {what} does not parse")
        return plain

    def _array(self, kind: type[np.generic], count: int) -> npt.NDArray[Any]:
        return np.frombuffer(self._take(np.dtype(kind).itemsize * count), kind).copy()

    def _number(self) -> int:
        return int.from_bytes(self._take(8), "little")

    def _take(self, count: int) -> bytes:
        if count < 0 or self._at + count > len(self._data):
            raise Corrupt(f"map snapshot: expected at least {self._at + count} bytes, got {len(self._data)}")
        self._at += count
        return self._data[self._at - count : self._at]


def _extent(extent: Extent | None) -> list[Any] | None:
    return [extent[0], extent[1].tolist()] if extent else None


def _extent_of(plain: list[Any] | None) -> Extent | None:
    return (plain[0], np.array(plain[1])) if plain else None


def _json(plain: Any) -> bytes:
    return json.dumps(plain, separators=(",", ":")).encode()


def _number(value: int) -> bytes:
    return value.to_bytes(8, "little")
