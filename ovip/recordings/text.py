"""Numbers in the text files of recordings; errors name the file, what was expected and what was there."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np

from ovip.errors import InvalidInput
from ovip.scene.camera import check_intrinsics
from ovip.scene.types import F64, Intrinsics


def read_text(path: Path) -> str:
    """The file's text; InvalidInput where it is missing or cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InvalidInput(f"{path}: expected a readable text file, got: {error.strerror}") from error


def read_matrix(path: Path, rows: int, columns: int) -> F64:
    """One `(rows, columns)` matrix written as text; NaN and infinities are kept."""
    numbers = parse_numbers(read_text(path), str(path))
    if numbers.size != rows * columns:
        raise InvalidInput(f"{path}: expected {rows}x{columns} numbers, got {numbers.size}")
    return numbers.reshape(rows, columns)


def read_pose_lines(path: Path) -> list[F64]:
    """A pose a line, 16 numbers row-major -> `(4, 4)` each; blank lines and '#' comments are passed over."""
    poses = []
    for line, text in data_lines(path):
        numbers = parse_numbers(text, f"{path} line {line}")
        if numbers.size != 16:
            raise InvalidInput(f"{path} line {line}: expected 16 numbers (4x4 row-major), got {numbers.size}")
        poses.append(numbers.reshape(4, 4))
    return poses


def data_lines(path: Path) -> list[tuple[int, str]]:
    """Line number (from 1) and text of every line that is neither blank nor a '#' comment."""
    lines = enumerate(read_text(path).splitlines(), start=1)
    return [
        (number, text.strip()) for number, text in lines if text.strip() and not text.lstrip().startswith("#")
    ]


def parse_numbers(text: str, where: str) -> F64:
    """Numbers parted by blanks, tabs or commas -> `(N,)`; Windows' "-1.#IND" counts as NaN."""
    try:
        return np.array(
            [_number(word) for word in re.split(r"[\s,]+", text.strip()) if word], dtype=np.float64
        )
    except ValueError as error:
        raise InvalidInput(f"{where}: expected numbers, got {text.strip()[:60]!r}") from error


def read_json(path: Path) -> dict[str, object]:
    """A JSON object; InvalidInput where the file is missing, no JSON, or another kind of value."""
    try:
        value = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise InvalidInput(
            f"{path}: expected JSON, got an error at line {error.lineno}: {error.msg}"
        ) from error
    if not isinstance(value, dict):
        raise InvalidInput(f"{path}: expected a JSON object, got {type(value).__name__}")
    return value


def json_number(values: dict[str, object], key: str, path: Path) -> float:
    """The finite number under `key`; InvalidInput names the keys that are there."""
    value = values.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InvalidInput(
            f"{path}: expected a number under {key!r}, got {value!r} (keys: {', '.join(values)})"
        )
    return float(value)


def intrinsics_of(
    values: dict[str, object], path: Path, width: str = "width", height: str = "height"
) -> Intrinsics:
    """Pinhole intrinsics from a JSON object with fx, fy, cx, cy and a size, all in pixels."""
    fx, fy, cx, cy, w, h = (json_number(values, key, path) for key in ("fx", "fy", "cx", "cy", width, height))
    if not (w == int(w) and h == int(h)):
        raise InvalidInput(f"{path}: expected a whole {width} and {height}, got {w} x {h}")
    return checked(Intrinsics(fx, fy, cx, cy, int(w), int(h)), path)


def intrinsics_of_matrix(path: Path, width: int, height: int) -> Intrinsics:
    """Pinhole intrinsics from a 3x3 or 4x4 camera matrix in pixels of a `width` x `height` image."""
    numbers = parse_numbers(read_text(path), str(path))
    if numbers.size not in (9, 16):
        raise InvalidInput(f"{path}: expected a 3x3 or 4x4 camera matrix, got {numbers.size} numbers")
    k = numbers.reshape((3, 3) if numbers.size == 9 else (4, 4))[:3, :3]
    if not (np.isfinite(k).all() and np.allclose(k[2], [0, 0, 1]) and k[1, 0] == 0):
        raise InvalidInput(f"{path}: expected a camera matrix 'fx 0 cx / 0 fy cy / 0 0 1', got {k.tolist()}")
    found = Intrinsics(
        float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), int(width), int(height)
    )
    return checked(found, path)


def depth_scale_of(values: dict[str, object], key: str, path: Path) -> float:
    """Depth units per metre under `key`: finite and above zero."""
    scale = json_number(values, key, path)
    if not scale > 0:
        raise InvalidInput(f"{path}: expected {key!r} above 0 (depth units per metre), got {scale}")
    return scale


def checked(intrinsics: Intrinsics, path: Path) -> Intrinsics:
    """`intrinsics` itself; InvalidInput names the file where they cannot be a camera's."""
    try:
        return check_intrinsics(intrinsics)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from error


def natural(name: str) -> list[tuple[int, int, str]]:
    """Sort key that puts frame 2 before frame 10."""
    parts = re.split(r"(\d+)", name)
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in parts]


def _number(word: str) -> float:
    return float("nan") if "#" in word else float(word)
