"""Binary PLY files whose faces have any number of corners and properties of their own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ovip.errors import InvalidInput
from ovip.scene.types import I64, U8

Columns = dict[str, npt.NDArray[Any]]
_NAMES = {
    "<i1": "char int8",
    "<u1": "uchar uint8",
    "<i2": "short int16",
    "<u2": "ushort uint16",
    "<i4": "int int32",
    "<u4": "uint uint32",
    "<f4": "float float32",
    "<f8": "double float64",
}
_TYPES = {name: kind for kind, names in _NAMES.items() for name in names.split()}
_LONGEST_HEADER = 1 << 16


@dataclass(frozen=True, slots=True)
class _Property:
    name: str
    kind: str
    count_kind: str = ""  # of a list: the type of its length


@dataclass(frozen=True, slots=True)
class _Element:
    name: str
    count: int
    properties: tuple[_Property, ...]

    def row(self, length: int) -> np.dtype[Any]:
        """The bytes of one row whose list has `length` values."""
        fields: list[Any] = []
        for item in self.properties:
            if item.count_kind:
                fields += [(f"{item.name} length", item.count_kind), (item.name, item.kind, (length,))]
            else:
                fields.append((item.name, item.kind))
        return np.dtype(fields)


def read_ply(path: Path) -> dict[str, list[Columns]]:
    """Element name -> its rows as columns, those with lists of one length together, in the file's order.

    An element without lists is one group; a list of length k is a column `(N, k)`. Raises InvalidInput where
    the file is no binary little-endian PLY, is cut off, or has two lists in one element.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InvalidInput(f"{path}: expected a readable PLY file, got: {error.strerror}") from error
    elements, at = _header(data, path)
    raw = np.frombuffer(data, np.uint8)
    found: dict[str, list[Columns]] = {}
    for element in elements:
        starts, lengths, at = _rows(element, raw, at, path)
        found[element.name] = [
            _columns(element.row(int(length)), raw, starts[lengths == length])
            for length in np.unique(lengths)
        ]
    return found


def _header(data: bytes, path: Path) -> tuple[list[_Element], int]:
    end = data.find(b"end_header\n", 0, _LONGEST_HEADER)
    lines = data[: max(end, 0)].decode("ascii", "replace").splitlines()
    if end < 0 or lines[0].strip() != "ply" or "format binary_little_endian 1.0" not in lines:
        raise InvalidInput(f"{path}: expected a binary little-endian PLY file, got {data[:40]!r}")
    elements: list[_Element] = []
    for words in (line.split() for line in lines):
        if words[:1] == ["element"]:
            elements.append(_Element(words[1], int(words[2]), ()))
        elif words[:1] == ["property"]:
            last = elements.pop()
            elements.append(_Element(last.name, last.count, (*last.properties, _property(words, path))))
    if any(sum(bool(item.count_kind) for item in element.properties) > 1 for element in elements):
        raise InvalidInput(f"{path}: expected at most one list property an element, got several")
    return elements, end + len(b"end_header\n")


def _property(words: list[str], path: Path) -> _Property:
    kinds = words[2:4] if words[1] == "list" else words[1:2]
    if any(kind not in _TYPES for kind in kinds):
        raise InvalidInput(f"{path}: expected PLY's number types, got {' '.join(words)!r}")
    if words[1] == "list":
        return _Property(words[4], _TYPES[kinds[1]], _TYPES[kinds[0]])
    return _Property(words[2], _TYPES[kinds[0]])


def _rows(element: _Element, raw: U8, at: int, path: Path) -> tuple[I64, I64, int]:
    """Offset and list length of each row, and where the element ends."""
    count, listed = element.count, next((item for item in element.properties if item.count_kind), None)
    if listed is None:
        size = element.row(0).itemsize
        end = _within(raw, at + count * size, path)
        return at + np.arange(count) * size, np.zeros(count, np.int64), end
    before = element.row(0).fields
    assert before is not None
    offset, kind = before[f"{listed.name} length"][1], np.dtype(listed.count_kind)
    # all rows alike, as in most files
    first = int(raw[at + offset : at + offset + kind.itemsize].view(kind)[0]) if count else 0
    size = element.row(first).itemsize
    if at + count * size <= raw.size:
        rows = raw[at : at + count * size].reshape(count, size)[:, offset : offset + kind.itemsize]
        if (np.ascontiguousarray(rows).view(kind) == first).all():
            return at + np.arange(count) * size, np.full(count, first), at + count * size
    return _uneven_rows(element, raw, at, offset, kind, path)


def _uneven_rows(
    element: _Element, raw: U8, at: int, offset: int, kind: np.dtype[Any], path: Path
) -> tuple[I64, I64, int]:
    starts, lengths = np.empty(element.count, np.int64), np.empty(element.count, np.int64)
    fixed, each = element.row(0).itemsize, element.row(1).itemsize - element.row(0).itemsize
    data = raw.tobytes()
    for index in range(element.count):
        _within(raw, at + fixed, path)
        starts[index] = at
        lengths[index] = int.from_bytes(data[at + offset : at + offset + kind.itemsize], "little")
        at += fixed + each * int(lengths[index])
    return starts, lengths, _within(raw, at, path)


def _within(raw: U8, end: int, path: Path) -> int:
    if end > raw.size:
        raise InvalidInput(f"{path}: expected {end} bytes or more by its header, got {raw.size} (cut off?)")
    return end


def _columns(row: np.dtype[Any], raw: U8, starts: I64) -> Columns:
    if (np.diff(starts) == row.itemsize).all():
        rows = raw[starts[0] : starts[-1] + row.itemsize]
    else:
        rows = raw[starts[:, None] + np.arange(row.itemsize)]
    table = np.ascontiguousarray(rows).view(row).reshape(-1)
    return {name: np.ascontiguousarray(table[name]) for name in row.names or ()}
