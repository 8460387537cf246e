"""Encoded images of a recording: as they lie on disk, or made from what lies there when they are read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.images import ImageHeader, encode_color, encode_raw_depth, read_header
from ovip.recordings.text import natural
from ovip.scene.types import F32, U16

_SUFFIXES = frozenset({".jpg", ".jpeg", ".png"})


@dataclass(frozen=True, slots=True)
class ImageFile:
    """A JPEG or PNG file, byte for byte."""

    path: Path

    @property
    def where(self) -> str:
        return str(self.path)

    def header(self) -> ImageHeader | None:
        return read_header(self.path)

    def read(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise InvalidInput(f"{self.path}: expected a readable file, got: {error.strerror}") from error


@dataclass(frozen=True, slots=True)
class ResizedColor:
    """A colour file brought to another size, in the file's own encoding."""

    path: Path
    width: int
    height: int

    @property
    def where(self) -> str:
        return str(self.path)

    def header(self) -> ImageHeader | None:
        found = read_header(self.path)
        return found and ImageHeader(found.encoding, self.width, self.height, 8, grey=False)

    def read(self) -> bytes:
        data = ImageFile(self.path).read()
        header = self.header()
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if header and data else None
        if image is None or header is None:
            raise InvalidInput(f"{self.path}: expected a colour image that decodes, got {len(data)} bytes")
        resized = cv2.resize(image, (self.width, self.height), interpolation=cv2.INTER_AREA)
        return encode_color(np.asarray(resized, np.uint8), header.encoding)


@dataclass(frozen=True, slots=True)
class MadeDepth:
    """Depth that is no 16-bit PNG on disk: `load` gives `(height, width)` raw units, `size` is (width, height)."""

    where: str
    size: tuple[int, int]
    load: Callable[[], U16]

    def header(self) -> ImageHeader:
        return ImageHeader("png", *self.size, bits=16, grey=True)

    def read(self) -> bytes:
        return encode_raw_depth(self.load())


def images_in(folder: Path) -> list[Path]:
    """The JPEG and PNG files of `folder` by name, 2 before 10; InvalidInput where there are none."""
    found = [path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES] if folder.is_dir() else []
    if not found:
        raise InvalidInput(f"{folder}: expected images (.jpg or .png), got none")
    return sorted(found, key=lambda path: natural(path.name))


def first_header(paths: list[Path]) -> ImageHeader:
    """The header of the first of `paths` that has one."""
    header = next((found for found in map(read_header, paths) if found), None)
    if header is None:
        raise InvalidInput(
            f"{paths[0].parent}: expected images in JPEG or PNG, got {len(paths)} files of no known kind"
        )
    return header


def depth_units(metres: F32, scale: float) -> U16:
    """Depth `(H, W)` in metres -> uint16 units; what is not finite, not above 0 or too far becomes 0 = none."""
    units = np.nan_to_num(metres.astype(np.float64) * scale, nan=0.0, posinf=0.0, neginf=0.0).round()
    return np.where((units > 0) & (units <= np.iinfo(np.uint16).max), units, 0).astype(np.uint16)
