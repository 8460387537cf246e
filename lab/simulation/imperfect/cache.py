"""Detections of a run in one file, so that every configuration of the mapper reads the same.

The file: `OVIPDET1`, then one zstd frame of records, each its length and CRC-32 (4 bytes each, little-endian) and
that many bytes. The first record is the header as JSON, the others batches in the codec's form, and an empty one
with the number of batches in place of the CRC ends it; then a skippable frame that holds `OVIPDETE`. A file cut
short is known when it is opened, damage before the batch is used.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, Protocol
from zlib import crc32

import zstandard

from lab.simulation.imperfect.features import FeatureModel
from lab.simulation.imperfect.params import ImperfectParams
from ovip.codec import decode_detection_batch, encode_detection_batch
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import DetectionBatch

VERSION = 1
_MAGIC = b"OVIPDET1"
_END = bytes.fromhex("502a4d1808000000") + b"OVIPDETE"
_LEVEL = 3
_LONGEST = 1 << 30


@dataclass(frozen=True, slots=True)
class CacheHeader:
    """What the detections were made from; `header_for` makes it. params: of the imperfect perception, as in JSON.

    feature_space: `FeatureModel.space`. labels: the scene's classes. frames: how many; 0 = not known.
    """

    scene: str
    seed: int
    params: dict[str, Any]
    feature_space: str
    labels: tuple[str, ...]
    frames: int = 0
    version: int = field(default=VERSION)


def header_for(
    scene: str, seed: int, params: ImperfectParams, model: FeatureModel, frames: int = 0
) -> CacheHeader:
    """The header of what `imperfect_batches` makes with these."""
    plain = json.loads(json.dumps(asdict(params), default=sorted))
    return CacheHeader(scene, seed, plain, model.space, tuple(model.labels), frames)


class _Readable(Protocol):
    def read(self, size: int = -1, /) -> bytes: ...


def write_cache(path: Path, header: CacheHeader, batches: Iterable[DetectionBatch]) -> int:
    """Writes the cache and returns how many batches; `path` changes only when all of it is written."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, aside = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            count = _write(file, header, batches)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(aside, 0o644)
        os.replace(aside, path)
    except BaseException:
        os.unlink(aside)
        raise
    return count


def read_cache(path: Path) -> tuple[CacheHeader, Iterator[DetectionBatch]]:
    """The header and the batches one by one.

    InvalidInput where the file is missing, no cache or of another version; Corrupt, when what is wrong is reached,
    where it is damaged or cut.
    """
    with _opened(path) as file, _reader(file) as stream:
        header = _header(path, next(_records(path, stream)))
    return header, _batches(path)


def _write(file: BinaryIO, header: CacheHeader, batches: Iterable[DetectionBatch]) -> int:
    file.write(_MAGIC)
    count = 0
    compressor = zstandard.ZstdCompressor(level=_LEVEL, write_checksum=True)
    with compressor.stream_writer(file, closefd=False) as stream:
        head = json.dumps(asdict(header), sort_keys=True).encode()
        stream.write(_word(len(head)) + _word(crc32(head)) + head)
        for batch in batches:
            data = encode_detection_batch(batch)
            stream.write(_word(len(data)) + _word(crc32(data)) + data)
            count += 1
        stream.write(_word(0) + _word(count))
    file.write(_END)
    return count


def _batches(path: Path) -> Iterator[DetectionBatch]:
    with _opened(path) as file, _reader(file) as stream:
        records = _records(path, stream)
        next(records)
        for data in records:
            yield decode_detection_batch(data)


def _opened(path: Path) -> BinaryIO:
    """The file at its first record, its end checked."""
    try:
        file = path.open("rb")
    except OSError as error:
        raise InvalidInput(f"{path}: expected a detection cache, got {error.strerror}") from error
    start, end = file.read(len(_MAGIC)), b""
    if file.seek(0, os.SEEK_END) >= len(_MAGIC) + len(_END):
        file.seek(-len(_END), os.SEEK_END)
        end = file.read()
    if start == _MAGIC and end == _END:
        file.seek(len(_MAGIC))
        return file
    file.close()
    if start != _MAGIC:
        raise InvalidInput(
            f"{path}: expected a detection cache ({_MAGIC.decode()}), got another kind of file"
        )
    raise Corrupt(f"{path}: the file is cut short, it does not end in {_END[-8:].decode()}")


def _reader(file: BinaryIO) -> zstandard.ZstdDecompressionReader:
    return zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True, closefd=False)


def _records(path: Path, stream: _Readable) -> Iterator[bytes]:
    """Every record, the header first; Corrupt where one is damaged, or the last is not the end."""
    count = 0
    while length := _number(path, stream):
        crc = _number(path, stream)
        if length > _LONGEST:
            raise Corrupt(f"{path}: expected a record of at most {_LONGEST} bytes, got {length}")
        data = _exactly(path, stream, length)
        if crc32(data) != crc:
            raise Corrupt(f"{path}: the file is damaged, record {count} is not what was written")
        yield data
        count += 1
    written = _number(path, stream)
    if written != count - 1 or _some(path, stream, 1):
        raise Corrupt(f"{path}: expected {written} batches and the end, got {count - 1}")


def _number(path: Path, stream: _Readable) -> int:
    return int.from_bytes(_exactly(path, stream, 4), "little")


def _exactly(path: Path, stream: _Readable, size: int) -> bytes:
    parts, missing = [], size
    while missing > 0:
        part = _some(path, stream, missing)
        if not part:
            raise Corrupt(f"{path}: the file is cut short, {missing} bytes of a record are missing")
        parts.append(part)
        missing -= len(part)
    return b"".join(parts)


def _some(path: Path, stream: _Readable, most: int) -> bytes:
    try:
        return stream.read(most)
    except zstandard.ZstdError as error:
        raise Corrupt(f"{path}: the file is damaged ({error})") from error


def _header(path: Path, data: bytes) -> CacheHeader:
    try:
        values = json.loads(data)
        header = CacheHeader(**{**values, "labels": tuple(values["labels"])})
    except (ValueError, TypeError, KeyError) as error:
        raise Corrupt(f"{path}: expected a header, got {data[:80]!r}") from error
    if header.version != VERSION:
        raise InvalidInput(f"{path}: expected a cache of version {VERSION}, got {header.version}")
    return header


def _word(number: int) -> bytes:
    return number.to_bytes(4, "little")
