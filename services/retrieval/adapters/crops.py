"""Crops of stored colour images, cut with OpenCV."""

from __future__ import annotations

import asyncio

import cv2
import numpy as np

from ovip.errors import Corrupt
from ovip.scene.types import Box2

_MARGIN = 0.25  # of the box's longer side, on every side: a crop shows some of what is around it
_LEAST_SIDE = 32
_MOST_SIDE = 768


class OpenCvCrops:
    """Decodes, cuts, shrinks to at most 768 pixels a side and encodes as JPEG, off the event loop."""

    async def crop(self, image: bytes, box: Box2) -> bytes:
        """The box with a quarter of its longer side around it, as JPEG; Corrupt where the image does not
        decode.
        """
        return await asyncio.to_thread(_crop, image, box)


def _crop(image: bytes, box: Box2) -> bytes:
    pixels = cv2.imdecode(np.frombuffer(image, np.uint8), cv2.IMREAD_COLOR)
    if pixels is None:
        raise Corrupt("a stored colour image does not decode")
    height, width = pixels.shape[:2]
    margin = max(_MARGIN * max(box.x1 - box.x0, box.y1 - box.y0), _LEAST_SIDE / 2)
    x0, x1 = int(max(box.x0 - margin, 0)), int(min(box.x1 + margin, width))
    y0, y1 = int(max(box.y0 - margin, 0)), int(min(box.y1 + margin, height))
    cut = pixels[y0:y1, x0:x1] if x1 - x0 > 1 and y1 - y0 > 1 else pixels
    shrink = _MOST_SIDE / max(cut.shape[:2])
    if shrink < 1:
        cut = cv2.resize(cut, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    ok, encoded = cv2.imencode(".jpg", cut, [cv2.IMWRITE_JPEG_QUALITY, 90])
    if not ok:
        raise Corrupt("a crop of a stored colour image does not encode")
    return bytes(encoded.tobytes())
