"""Floor evidence as bytes: the whole, or what changed since some frame."""

from __future__ import annotations

import json
import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

from ovip.errors import Corrupt
from ovip.scene.types import I64, Bools
from services.regions.domain.bricks import BOXES, Bricks, Unsigned
from services.regions.domain.counts import Counts

if TYPE_CHECKING:
    from services.regions.domain.evidence import FloorEvidence

_MAGIC = b"OVIPFE02"
_BRICKS = ("hits", "passes")
_COUNTS = ("stood", "heights_below", "heights_above")
_MANY = 255  # a count from here on is written apart
_AT_ONCE = 1 << 12


def encode(evidence: FloorEvidence, since: int) -> bytes:
    """Frames, views and bricks after the first `since` frames, and the small counts whole."""
    ids = sorted(list(evidence.cameras)[since:])
    views = [evidence.views[frame_id] for frame_id in ids]
    out = _Writer()
    out.numbers([since, evidence.revision])
    out.text(json.dumps(ids))
    out.floats([place for frame_id in ids for place in evidence.cameras[frame_id]])
    out.numbers(np.array([len(view) for view in views], np.int64))
    out.numbers(np.diff(np.concatenate([np.zeros(0, np.int64), *views]), prepend=0))
    for name in _COUNTS:
        keys, counts = getattr(evidence, name).items()
        out.numbers(np.diff(keys, prepend=0))
        out.numbers(counts)
    for name in _BRICKS:
        _write_bricks(out, getattr(evidence, name), since)
    return _MAGIC + out.finish()


def decode_into(evidence: FloorEvidence, data: bytes) -> None:
    """Adds what a segment says to the evidence before it. Raises Corrupt for bytes that are none or do not follow."""
    if data[: len(_MAGIC)] != _MAGIC:
        raise Corrupt("floor evidence: the bytes do not start as floor evidence does")
    try:
        read = _Reader(zlib.decompress(data[len(_MAGIC) :]))
        since, revision = read.numbers().tolist()
        if since > evidence.revision:
            raise ValueError(
                f"expected a segment from frame {evidence.revision} or before, got one from {since}"
            )
        _decode(evidence, read, revision)
    except (zlib.error, struct.error, ValueError, IndexError, TypeError) as error:
        raise Corrupt(f"floor evidence: {error}") from error


def _decode(evidence: FloorEvidence, read: _Reader, revision: int) -> None:
    ids = json.loads(read.text())
    places = map(tuple, read.floats().reshape(-1, 3).tolist())
    evidence.cameras.update(zip(ids, places, strict=True))
    ends, seen = np.cumsum(read.numbers()), np.cumsum(read.numbers())
    evidence.views.update(zip(ids, np.split(seen, ends)[:-1], strict=True))
    if evidence.revision != revision:
        raise ValueError(f"expected {revision} frames, got {evidence.revision}")
    for name in _COUNTS:
        setattr(evidence, name, Counts(np.cumsum(read.numbers()), read.numbers()))
    for name in _BRICKS:
        _read_bricks(read, getattr(evidence, name), revision)


def _write_bricks(out: _Writer, bricks: Bricks, since: int) -> None:
    """Keys; then, some bricks at a time: which boxes have a count, the counts, and the large ones apart."""
    keys = bricks.changed(since)
    out.numbers(np.diff(keys, prepend=0))
    for start in range(0, len(keys), _AT_ONCE):
        blocks = np.concatenate(list(bricks.read(keys[start : start + _AT_ONCE])))
        counts = blocks[blocks > 0].astype(np.int64)
        out.raw(np.packbits(blocks > 0).tobytes())
        out.raw(np.minimum(counts, _MANY).astype(np.uint8).tobytes())
        out.numbers(counts[counts >= _MANY])


def _read_bricks(read: _Reader, bricks: Bricks, time: int) -> None:
    keys = np.cumsum(read.numbers())
    for start in range(0, len(keys), _AT_ONCE):
        part = keys[start : start + _AT_ONCE]
        some = np.unpackbits(np.frombuffer(read.raw(len(part) * BOXES // 8), np.uint8)).astype(bool)
        counts = np.frombuffer(read.raw(int(some.sum())), np.uint8).astype(np.int64)
        counts[counts == _MANY] = read.numbers()
        bricks.write(part, _blocks(some, counts), time)


def _blocks(some: Bools, counts: I64) -> Unsigned:
    blocks: Unsigned = np.zeros(len(some), np.uint64 if counts.max(initial=0) > _MANY else np.uint8)
    blocks[some] = counts
    return blocks.reshape(-1, BOXES)


class _Writer:
    """Compresses what it is given as it comes."""

    def __init__(self) -> None:
        self._packer = zlib.compressobj(1)
        self._parts: list[bytes] = []

    def raw(self, data: bytes) -> None:
        self._parts.append(self._packer.compress(data))

    def text(self, text: str) -> None:
        self.numbers([len(text.encode())])
        self.raw(text.encode())

    def numbers(self, values: I64 | list[int]) -> None:
        self.raw(struct.pack("<q", len(values)) + np.asarray(values, "<i8").tobytes())

    def floats(self, values: list[float]) -> None:
        self.raw(struct.pack("<q", len(values)) + np.asarray(values, "<f8").tobytes())

    def finish(self) -> bytes:
        return b"".join([*self._parts, self._packer.flush()])


class _Reader:
    """Reads what a `_Writer` was given, in that order. Raises ValueError or struct.error where bytes are missing."""

    def __init__(self, body: bytes) -> None:
        self._body, self._at = memoryview(body), 0

    def raw(self, size: int) -> memoryview:
        if size < 0 or self._at + size > len(self._body):
            raise ValueError(f"expected {size} more bytes, got {len(self._body) - self._at}")
        self._at += size
        return self._body[self._at - size : self._at]

    def text(self) -> str:
        (size,) = self.numbers().tolist()
        return bytes(self.raw(size)).decode()

    def numbers(self) -> I64:
        return np.frombuffer(self._values(), "<i8").astype(np.int64)

    def floats(self) -> np.ndarray:
        return np.frombuffer(self._values(), "<f8").astype(np.float64)

    def _values(self) -> memoryview:
        (size,) = struct.unpack("<q", self.raw(8))
        return self.raw(8 * size)
