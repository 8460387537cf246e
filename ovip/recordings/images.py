"""What an encoded image says of itself in its first bytes; and depth with an invalid value taken out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ovip.recordings.frames import RgbEncoding
from ovip.scene.types import U8, U16

_PNG = b"\x89PNG\r\n\x1a\n"
_PNG_GREY = 0
_JPEG = b"\xff\xd8\xff"
_JPEG_SIZE_MARKERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_LONGEST_HEADER = 1 << 18
_JPEG_QUALITY = 95


@dataclass(frozen=True, slots=True)
class ImageHeader:
    """Encoding, size in pixels, bits a channel, and whether it has one channel only."""

    encoding: RgbEncoding
    width: int
    height: int
    bits: int
    grey: bool


def read_header(path: Path) -> ImageHeader | None:
    """The header of a PNG or JPEG file; None where it is missing, empty, cut off or of another kind."""
    try:
        with path.open("rb") as file:
            start = file.read(64)
            if start.startswith(_JPEG):
                start += file.read(_LONGEST_HEADER)
    except OSError:
        return None
    return parse_header(start)


def parse_header(data: bytes) -> ImageHeader | None:
    """The header of an encoded PNG or JPEG image; None where it is not one."""
    if data.startswith(_PNG) and len(data) >= 26 and data[12:16] == b"IHDR":
        width, height = int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
        return ImageHeader("png", width, height, bits=data[24], grey=data[25] == _PNG_GREY)
    return _parse_jpeg(data) if data.startswith(_JPEG) else None


def without_value(depth_png: bytes, invalid: int) -> bytes:
    """`depth_png` with every pixel of raw value `invalid` set to 0; the same bytes where none occurs.

    Bytes that do not decode are returned as they are: whoever decodes them says what is wrong.
    """
    depth = decode_raw_depth(depth_png)
    if depth is None or not (depth == invalid).any():
        return depth_png
    return encode_raw_depth(np.where(depth == invalid, 0, depth).astype(np.uint16))


def decode_raw_depth(depth_png: bytes) -> U16 | None:
    """A 16-bit PNG of one channel -> `(H, W)` uint16; None where it is not one."""
    depth = cv2.imdecode(np.frombuffer(depth_png, np.uint8), cv2.IMREAD_UNCHANGED) if depth_png else None
    if depth is None or depth.dtype != np.uint16 or depth.ndim != 2:
        return None
    return np.asarray(depth, dtype=np.uint16)


def encode_raw_depth(depth: U16) -> bytes:
    """`(H, W)` uint16 as a PNG of one channel."""
    return cv2.imencode(".png", depth, [cv2.IMWRITE_PNG_COMPRESSION, 3])[1].tobytes()


def encode_color(bgr: U8, encoding: RgbEncoding) -> bytes:
    """`(H, W, 3)` blue, green, red as PNG or as JPEG of quality 95."""
    if encoding == "png":
        return cv2.imencode(".png", bgr)[1].tobytes()
    return cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])[1].tobytes()


def _parse_jpeg(data: bytes) -> ImageHeader | None:
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _JPEG_SIZE_MARKERS:
            height, width = (
                int.from_bytes(data[at + 5 : at + 7], "big"),
                int.from_bytes(data[at + 7 : at + 9], "big"),
            )
            return ImageHeader(
                "jpeg", width, height, bits=data[at + 4], grey=data[at + 9 : at + 10] == b"\x01"
            )
        at += 1 if marker == 0xFF else 2 + int.from_bytes(data[at + 2 : at + 4], "big")
    return None
