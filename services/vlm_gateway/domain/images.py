"""Reads an encoded image's size from its header, so that no image is decoded before its size is known."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from ovip.errors import InvalidInput, TooLarge

MAX_PIXELS = 64_000_000
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_JPEG_START = b"\xff\xd8"
_JPEG_END = b"\xff\xd9"
# Start-of-frame markers C0..CF, less DHT (C4), JPG (C8) and DAC (CC), which share the range.
_JPEG_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_JPEG_STANDALONE = frozenset(range(0xD0, 0xD9)) | {0x01}


@dataclass(frozen=True, slots=True)
class ImageSize:
    """Width and height in pixels."""

    width: int
    height: int

    def fitted(self, max_side: int) -> ImageSize:
        """The size after the longer side is shrunk to at most `max_side` pixels; never enlarged."""
        scale = min(1.0, max_side / max(self.width, self.height))
        return ImageSize(max(1, round(self.width * scale)), max(1, round(self.height * scale)))


def image_size(data: bytes, name: str = "image") -> ImageSize:
    """The size of a JPEG or PNG by its header.

    Raises InvalidInput where it is neither, is cut short or has no pixels, TooLarge past `MAX_PIXELS`.
    """
    size = _png_size(data) if data.startswith(_PNG_SIGNATURE) else _jpeg_size(data)
    if size is None or size.width < 1 or size.height < 1:
        raise InvalidInput(f"{name} ({len(data)} bytes) is not a whole JPEG or PNG")
    if size.width * size.height > MAX_PIXELS:
        raise TooLarge(f"{name} is {size.width}x{size.height}; at most {MAX_PIXELS} pixels are accepted")
    return size


def is_jpeg(data: bytes) -> bool:
    """Whether the bytes begin as a JPEG does."""
    return data.startswith(_JPEG_START)


def _png_size(data: bytes) -> ImageSize | None:
    if len(data) < 24 or data[12:16] != b"IHDR" or b"IEND" not in data[-16:]:
        return None
    width, height = struct.unpack(">II", data[16:24])
    return ImageSize(width, height)


def _jpeg_size(data: bytes) -> ImageSize | None:
    if not is_jpeg(data) or data.rfind(_JPEG_END) < 0:
        return None
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _JPEG_FRAMES:
            height, width = struct.unpack(">HH", data[at + 5 : at + 9])
            return ImageSize(width, height)
        at += _step(marker, data, at)
    return None


def _step(marker: int, data: bytes, at: int) -> int:
    if marker == 0xFF:  # a fill byte before the marker
        return 1
    if marker in _JPEG_STANDALONE:
        return 2
    length = int.from_bytes(data[at + 2 : at + 4], "big")
    return 2 + max(2, length)
