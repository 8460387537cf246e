"""Images on the wire: colour as JPEG or PNG, depth as PNG16 or delta + byte shuffle + zstd."""

from __future__ import annotations

import cv2
import numpy as np
import zstandard

from ovip.errors import InvalidInput
from ovip.scene.types import F32, U8, U16, Bools, Intrinsics

_JPEG, _PNG = b"\xff\xd8", b"\x89PNG\r\n\x1a\n"
_MAX_PIXELS = 8192 * 8192
_JPEG_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}  # the markers that carry width and height


def decode_rgb(data: bytes, k: Intrinsics) -> U8:
    """`(H, W, 3)` uint8 RGB of JPEG or PNG bytes; InvalidInput where they do not decode to the camera's size."""
    if data.startswith(_JPEG):
        if b"\xff\xd9" not in data[-64:]:
            raise InvalidInput(
                f"colour image: expected a whole JPEG, got {len(data)} bytes without an end marker (cut off?)"
            )
    elif not data.startswith(_PNG):
        raise InvalidInput(
            f"colour image: expected JPEG or PNG bytes, got {len(data)} bytes starting {data[:4].hex() or 'nothing'}"
        )
    bgr = _decode("colour image", data, k, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    return np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB), np.uint8)


def decode_depth(data: bytes, encoding: str, scale: float, k: Intrinsics) -> F32:
    """`(H, W)` float32 metres, 0 = none. encoding: "png16" or "shuffle_zstd"; scale: units per metre."""
    if not (np.isfinite(scale) and 1.0 <= scale <= 1e6):
        raise InvalidInput(
            f"depth image: expected a scale of 1 to 1e6 units per metre (1000 = millimetres), got {scale}"
        )
    raw = decode_depth_units(data, encoding, k)
    return (raw.astype(np.float32) / np.float32(scale)).astype(np.float32)


def decode_depth_units(data: bytes, encoding: str, k: Intrinsics) -> U16:
    """`(H, W)` uint16 depth as sent."""
    if encoding == "png16":
        if not data.startswith(_PNG):
            raise InvalidInput(
                f"depth image: expected PNG bytes, got {len(data)} bytes starting {data[:4].hex()}"
            )
        raw = _decode("depth image", data, k, cv2.IMREAD_UNCHANGED)
        if raw.dtype != np.uint16 or raw.ndim != 2:
            raise InvalidInput(
                f"depth image: expected one channel of 16 bits, got {raw.dtype} with shape {raw.shape}"
            )
        return np.asarray(raw, np.uint16)
    if encoding == "shuffle_zstd":
        return _unshuffle(data, k)
    raise InvalidInput(f"depth image: expected encoding png16 or shuffle_zstd, got {encoding!r}")


def decode_mask(what: str, data: bytes, k: Intrinsics) -> Bools:
    """`(h, w)` of a grey PNG, non-zero is inside; InvalidInput about `what` where it is too large or broken."""
    size = _size_of(data) if data.startswith(_PNG) else None
    if size is None or size[0] > k.width or size[1] > k.height:
        raise InvalidInput(
            f"{what}: expected a PNG of at most {k.width}x{k.height}, got {len(data)} bytes"
            + (f" of {size[0]}x{size[1]}" if size else " that do not decode")
        )
    return np.asarray(_pixels(what, data, cv2.IMREAD_GRAYSCALE) > 0)


def encode_depth(raw: U16) -> bytes:
    """`(H, W)` uint16 as row-wise delta, low bytes then high bytes, zstd: a quarter smaller than PNG16 and faster."""
    delta = np.diff(raw, axis=1, prepend=np.zeros((raw.shape[0], 1), np.uint16)).astype("<u2")
    shuffled = np.ascontiguousarray(delta).view(np.uint8).reshape(-1, 2).T
    return zstandard.ZstdCompressor(level=3).compress(np.ascontiguousarray(shuffled).tobytes())


def _unshuffle(data: bytes, k: Intrinsics) -> U16:
    expected = k.width * k.height * 2
    if expected > 2 * _MAX_PIXELS:
        raise InvalidInput(f"depth image: {k.width}x{k.height} is larger than supported")
    try:
        # a hostile header may claim any size, and the decompressor would believe it
        if zstandard.frame_content_size(data) not in (-1, expected):
            raise InvalidInput(
                f"depth image: expected {expected} bytes for {k.width}x{k.height} after decompression"
            )
        plain = zstandard.ZstdDecompressor().decompress(data, max_output_size=expected)
    except zstandard.ZstdError as error:
        raise InvalidInput(
            f"depth image: {len(data)} bytes do not decompress as zstd to {expected} bytes: {error}"
        ) from error
    if len(plain) != expected:
        raise InvalidInput(
            f"depth image: expected {k.width}x{k.height} like the intrinsics ({expected} bytes), got {len(plain)} bytes"
        )
    delta = np.ascontiguousarray(np.frombuffer(plain, np.uint8).reshape(2, -1).T).view("<u2")
    return np.cumsum(delta.reshape(k.height, k.width), axis=1, dtype=np.uint16)


def _decode(what: str, data: bytes, k: Intrinsics, flags: int) -> U8 | U16:
    size = _size_of(data)
    if size is not None and size != (k.width, k.height):
        # before decoding: a small file may claim a huge image
        raise InvalidInput(
            f"{what}: expected {k.width}x{k.height} like the intrinsics, got {size[0]}x{size[1]}"
        )
    if size is None:
        raise InvalidInput(f"{what}: {len(data)} bytes do not decode: they name no width and height")
    return _pixels(what, data, flags)


def _pixels(what: str, data: bytes, flags: int) -> U8 | U16:
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error:
        pixels = None
    if pixels is None:
        raise InvalidInput(f"{what}: {len(data)} bytes do not decode")
    return np.asarray(pixels)


def _size_of(data: bytes) -> tuple[int, int] | None:
    """Width and height that a PNG or JPEG claims in its header."""
    if data.startswith(_PNG):
        found = (int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big"))
        return found if data[12:16] == b"IHDR" else None
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _JPEG_FRAMES:
            return int.from_bytes(data[at + 7 : at + 9], "big"), int.from_bytes(data[at + 5 : at + 7], "big")
        at += 1 if marker == 0xFF else 2 + int.from_bytes(data[at + 2 : at + 4], "big")
    return None
