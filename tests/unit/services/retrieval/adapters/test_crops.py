from __future__ import annotations

import cv2
import numpy as np
import pytest

from ovip.errors import Corrupt
from ovip.scene.types import Box2
from services.retrieval.adapters.crops import OpenCvCrops


def picture() -> bytes:
    pixels = np.zeros((480, 640, 3), np.uint8)
    pixels[200:240, 300:340] = (0, 0, 255)
    return bytes(cv2.imencode(".png", pixels)[1].tobytes())


async def test_a_crop_holds_the_box_and_some_of_what_is_around_it() -> None:
    crop = cv2.imdecode(
        np.frombuffer(await OpenCvCrops().crop(picture(), Box2(300, 200, 340, 240)), np.uint8), 1
    )
    assert crop.shape[:2] == (72, 72)
    assert crop[36, 36, 2] > 200
    assert crop[2, 2, 2] < 60


async def test_a_box_at_the_edge_is_cut_off_there() -> None:
    crop = cv2.imdecode(
        np.frombuffer(await OpenCvCrops().crop(picture(), Box2(-20, -20, 2000, 2000)), np.uint8), 1
    )
    assert crop.shape[:2] == (480, 640)


async def test_a_box_outside_the_picture_gives_the_whole_picture() -> None:
    crop = cv2.imdecode(
        np.frombuffer(await OpenCvCrops().crop(picture(), Box2(900, 900, 950, 950)), np.uint8), 1
    )
    assert crop.shape[:2] == (480, 640)


async def test_bytes_that_are_no_picture_are_corrupt() -> None:
    with pytest.raises(Corrupt):
        await OpenCvCrops().crop(b"not a picture", Box2(0, 0, 10, 10))
