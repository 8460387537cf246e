"""Images as an upstream takes them: JPEG data URLs no larger than its limit."""

from __future__ import annotations

import base64

import cv2
import numpy as np

from ovip.errors import InvalidInput
from services.vlm_gateway.domain.images import ImageSize, image_size, is_jpeg

JPEG_QUALITY = 90


def data_url(image: bytes, max_side: int) -> str:
    """A `data:image/jpeg` URL of an encoded image, its longer side shrunk to `max_side` pixels.

    A JPEG within the limit is passed on as it came. Raises InvalidInput where the image cannot be decoded.
    """
    return "data:image/jpeg;base64," + base64.b64encode(fitted_jpeg(image, max_side)).decode()


def fitted_jpeg(image: bytes, max_side: int) -> bytes:
    """The image as JPEG bytes with its longer side at most `max_side` pixels."""
    size = image_size(image)
    pixels = cv2.imdecode(np.frombuffer(image, np.uint8), cv2.IMREAD_COLOR)
    if pixels is None:
        raise InvalidInput(f"an image of {len(image)} bytes cannot be decoded; expected a whole JPEG or PNG")
    if is_jpeg(image) and max(size.width, size.height) <= max_side:
        return image
    height, width = pixels.shape[:2]
    target = ImageSize(width, height).fitted(max_side)
    if (target.width, target.height) != (width, height):
        pixels = cv2.resize(pixels, (target.width, target.height), interpolation=cv2.INTER_AREA)
    _, encoded = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return encoded.tobytes()
