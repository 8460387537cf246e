"""The binary point message, read back by its documented offsets."""

from __future__ import annotations

import json
import struct

import numpy as np

from ovip.answer_json import WORLD, OutputFrame
from services.api.domain.point_cloud import pack_points
from tests.unit.services.api.flat import Y_UP

CLOUDS = {
    "o-1": (np.array([[1.0, 2.0, 3.0]], np.float32), np.array([[10, 20, 30]], np.uint8)),
    "o-2": (
        np.array([[4.0, 5.0, 6.0], [7.0, 8.0, 9.0]], np.float32),
        np.array([[1, 2, 3], [4, 5, 6]], np.uint8),
    ),
}


def test_the_message_has_its_parts_at_the_documented_offsets() -> None:
    packed = pack_points(CLOUDS, 12, WORLD)
    magic, form, version, count, ids_size = struct.unpack_from("<4sIQII", packed)
    assert (magic, form, version, count) == (b"OVPC", 1, 12, 3)
    points = np.frombuffer(packed, "<f4", 9, 24).reshape(3, 3)
    assert points.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert np.frombuffer(packed, "<u4", 3, 24 + 36).tolist() == [0, 1, 1]
    assert np.frombuffer(packed, np.uint8, 9, 24 + 48).tolist() == [10, 20, 30, 1, 2, 3, 4, 5, 6]
    assert json.loads(packed[24 + 19 * 3 :]) == ["o-1", "o-2"]
    assert len(packed) == 24 + 19 * 3 + ids_size


def test_an_empty_map_is_a_header_and_an_empty_list() -> None:
    packed = pack_points({}, 0, WORLD)
    assert len(packed) == 26
    assert packed[24:] == b"[]"


def test_points_turn_into_the_recordings_frame() -> None:
    packed = pack_points({"o-1": CLOUDS["o-1"]}, 1, OutputFrame(Y_UP))
    assert np.frombuffer(packed, "<f4", 3, 24).tolist() == [1.0, 2.5, -2.0]
