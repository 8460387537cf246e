"""Images in ROS messages -> encoded images: JPEG and PNG as they came, raw colour as JPEG, depth as 16-bit PNG.

Depth of 16UC1 (and mono16) is millimetres and stays; of 32FC1 it is metres, rounded to millimetres, NaN and
infinite = none. compressedDepth: 12 bytes of parameters, then a PNG; for 32FC1 the PNG holds inverse depth.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.images import (
    ImageHeader,
    decode_raw_depth,
    encode_color,
    encode_raw_depth,
    parse_header,
)
from ovip.recordings.rosbag_file import Bag, BagMessage
from ovip.recordings.sources import depth_units
from ovip.scene.types import F32, U8, U16

DEPTH_SCALE = 1000.0
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
_PARAMETERS = 12
_TO_BGR: dict[str, tuple[int, int | None]] = {  # channels, how OpenCV calls the conversion
    "bgr8": (3, None),
    "8uc3": (3, None),
    "rgb8": (3, cv2.COLOR_RGB2BGR),
    "rgba8": (4, cv2.COLOR_RGBA2BGR),
    "bgra8": (4, cv2.COLOR_BGRA2BGR),
    "8uc4": (4, cv2.COLOR_BGRA2BGR),
    "mono8": (1, cv2.COLOR_GRAY2BGR),
    "8uc1": (1, cv2.COLOR_GRAY2BGR),
    "bayer_rggb8": (1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr8": (1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg8": (1, cv2.COLOR_BayerGRBG2BGR),
    "yuv422": (2, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": (2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2BGR_YUY2),
    "yuyv": (2, cv2.COLOR_YUV2BGR_YUY2),
}
_DEPTH_TYPES = {"16uc1": "u2", "mono16": "u2", "32fc1": "f4"}


@dataclass(frozen=True, slots=True, eq=False)
class BagImage:
    """An image of a bag: its message is read again, and encoded, when the image is asked for."""

    bag: Bag
    topic: str
    time_ns: int
    stamp_ns: int
    known: ImageHeader | None
    encode: Callable[[Any], bytes]

    @property
    def where(self) -> str:
        return f"{self.bag.path} {self.topic} at {self.stamp_ns / 1e9:.3f} s"

    def header(self) -> ImageHeader | None:
        return self.known

    def read(self) -> bytes:
        return self.encode(self.bag.message(self.topic, self.time_ns, self.stamp_ns).value)


def color_image(bag: Bag, message: BagMessage) -> BagImage:
    """The colour image in an Image or CompressedImage message."""
    value = message.value
    if bag.topics[message.topic] == COMPRESSED:
        header, encode = parse_header(_bytes(value)), _bytes
    else:
        _known_color(value.encoding, message.topic)
        header, encode = ImageHeader("jpeg", value.width, value.height, 8, grey=False), encode_raw_color
    return BagImage(bag, message.topic, message.time_ns, message.stamp_ns, header, encode)


def depth_image(bag: Bag, message: BagMessage) -> BagImage:
    """The depth image in an Image, CompressedImage or compressedDepth message."""
    value = message.value
    if bag.topics[message.topic] == COMPRESSED:
        _known_compressed_depth(value.format, message.topic)
        inner = parse_header(_png_of(value))
        header = inner and ImageHeader("png", inner.width, inner.height, inner.bits, inner.grey)
        encode = encode_compressed_depth
    else:
        _known_depth(value.encoding, message.topic)
        header, encode = ImageHeader("png", value.width, value.height, 16, grey=True), encode_plain_depth
    return BagImage(bag, message.topic, message.time_ns, message.stamp_ns, header, encode)


def encode_raw_color(image: Any) -> bytes:
    """A sensor_msgs/Image as JPEG."""
    channels, conversion = _known_color(image.encoding, "image")
    pixels = _rows(image, "u1", channels)
    bgr = pixels if conversion is None else cv2.cvtColor(np.ascontiguousarray(pixels), conversion)
    return encode_color(np.asarray(bgr, np.uint8), "jpeg")


def encode_plain_depth(image: Any) -> bytes:
    """A sensor_msgs/Image of 16UC1 or 32FC1 as 16-bit PNG in millimetres."""
    kind = _known_depth(image.encoding, "depth image")
    pixels = _rows(image, kind, 1)
    return encode_raw_depth(_units(pixels) if kind == "f4" else np.ascontiguousarray(pixels, np.uint16))


def encode_compressed_depth(image: Any) -> bytes:
    """A sensor_msgs/CompressedImage of depth as 16-bit PNG in millimetres."""
    png = _png_of(image)
    if not image.format.lower().startswith("32fc1"):
        return png
    _, a, b = struct.unpack("<iff", _bytes(image)[:_PARAMETERS])
    inverse = decode_raw_depth(png)
    if inverse is None:
        raise InvalidInput(
            f"compressedDepth: expected a 16-bit PNG inside, got {len(png)} bytes of another kind"
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        metres = np.where(inverse > 0, a / (inverse.astype(np.float64) - b), 0)
    return encode_raw_depth(_units(metres.astype(np.float32)))


def _rows(image: Any, kind: str, channels: int) -> U8 | U16 | F32:
    """Pixels `(H, W)` or `(H, W, C)` without the padding at the end of each row."""
    dtype = np.dtype(kind).newbyteorder(">" if image.is_bigendian else "<")
    used = image.width * channels * dtype.itemsize
    data = np.frombuffer(_bytes(image), np.uint8)
    if image.step < used or data.size < image.step * image.height:
        raise InvalidInput(
            f"image: expected {image.height} rows of {used} bytes for {image.encoding}, "
            f"got {data.size} bytes with step {image.step}"
        )
    rows = data[: image.step * image.height].reshape(image.height, image.step)[:, :used]
    pixels = np.ascontiguousarray(rows).view(dtype).astype(dtype.newbyteorder("="))
    shape = (image.height, image.width) if channels == 1 else (image.height, image.width, channels)
    return np.asarray(pixels.reshape(shape))


def _units(metres: F32 | U8 | U16) -> U16:
    return depth_units(np.asarray(metres, np.float32), DEPTH_SCALE)


def _png_of(image: Any) -> bytes:
    """The PNG in a compressed depth message, behind compressedDepth's parameters."""
    data = _bytes(image)
    return data[_PARAMETERS:] if "compresseddepth" in image.format.lower() else data


def _bytes(image: Any) -> bytes:
    return image.data.tobytes() if hasattr(image.data, "tobytes") else bytes(image.data)


def _known_color(encoding: str, topic: str) -> tuple[int, int | None]:
    found = _TO_BGR.get(encoding.lower())
    if found is None:
        raise InvalidInput(f"{topic}: expected a colour encoding ({', '.join(_TO_BGR)}), got {encoding!r}")
    return found


def _known_depth(encoding: str, topic: str) -> str:
    found = _DEPTH_TYPES.get(encoding.lower())
    if found is None:
        raise InvalidInput(
            f"{topic}: expected depth as 16UC1 (millimetres) or 32FC1 (metres), got {encoding!r}"
        )
    return found


def _known_compressed_depth(format_: str, topic: str) -> None:
    words = format_.lower()
    if "rvl" in words or not (words.startswith(("16uc1", "32fc1", "mono16", "png")) or "png" in words):
        raise InvalidInput(f"{topic}: expected depth compressed as PNG, got {format_!r}")
    if words.startswith("32fc1") and "compresseddepth" not in words:
        raise InvalidInput(f"{topic}: expected 32FC1 depth as compressedDepth, got {format_!r}")
