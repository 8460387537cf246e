"""Batches of detections: nearest depth to the millimetre, second features as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip import codec
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.types import F32, U16, Intrinsics
from ovip.v1 import types_pb2
from tests.builders import axis, batch, camera, detection, same


def blocks_of(k: Intrinsics) -> tuple[int, int]:
    """Rows and columns of 4 x 4 blocks, those at the edges cut off."""
    return (k.height + 3) // 4, (k.width + 3) // 4


@st.composite
def nearest_depths(draw: st.DrawFn) -> tuple[Intrinsics, U16]:
    k = camera(draw(st.integers(1, 30)), draw(st.integers(1, 30)))
    return k, draw(hnp.arrays(np.uint16, blocks_of(k)))


@given(nearest_depths())
def test_nearest_depth_in_whole_millimetres_comes_back_bit_for_bit(case: tuple[Intrinsics, U16]) -> None:
    k, millimetres = case
    nearest = (millimetres / np.float32(1000.0)).astype(np.float32)
    sent = replace(batch(1, k=k), nearest=nearest)

    data = codec.encode_detection_batch(sent)

    assert same(codec.decode_detection_batch(data), sent)
    assert codec.encode_detection_batch(codec.decode_detection_batch(data)) == data


@given(hnp.arrays(np.float32, (12, 16), elements=st.floats(0, 65.5, width=32)))
def test_any_nearest_depth_comes_back_to_half_a_millimetre(nearest: F32) -> None:
    again = codec.decode_detection_batch(codec.encode_detection_batch(replace(batch(1), nearest=nearest)))

    assert again.nearest == pytest.approx(nearest, abs=0.0005 + 1e-5)


def test_depth_that_is_none_and_depth_too_far_are_never_taken_for_something_near() -> None:
    nearest = np.full((12, 16), 2.0, np.float32)
    nearest[0, :5] = [np.nan, np.inf, -np.inf, -1.0, 0.0]
    nearest[1, 0] = 100.0

    again = codec.decode_detection_batch(codec.encode_detection_batch(replace(batch(1), nearest=nearest)))

    assert again.nearest[0, :6].tolist() == [0, 0, 0, 0, 0, 2]
    assert again.nearest[1, 0] == pytest.approx(65.535)


def test_a_batch_from_before_there_was_nearest_depth_has_none() -> None:
    old = types_pb2.DetectionBatch.FromString(codec.encode_detection_batch(batch(1)))

    assert not old.nearest_depth
    assert codec.decode_detection_batch(old.SerializeToString()).nearest.shape == (0, 0)


def test_nearest_depth_of_another_camera_is_refused_where_it_is_written() -> None:
    with pytest.raises(InvalidInput, match=r"r\.s\.00000001: expected 16x12 blocks .* 64x48 pixels, got 3x2"):
        codec.encode_detection_batch(replace(batch(1), nearest=np.zeros((2, 3), np.float32)))


@pytest.mark.parametrize("data", [b"junk", b"\x28\xb5\x2f\xfd"])
def test_nearest_depth_that_does_not_decode_is_corrupt_in_words(data: bytes) -> None:
    message = types_pb2.DetectionBatch.FromString(codec.encode_detection_batch(batch(1)))
    message.nearest_depth = data

    with pytest.raises(Corrupt, match=r"nearest depth of frame r\.s\.00000001"):
        codec.decode_detection_batch(message.SerializeToString())


def test_nearest_depth_of_another_size_is_corrupt() -> None:
    wide = codec.encode_detection_batch(replace(batch(1), nearest=np.ones((12, 16), np.float32)))
    message = types_pb2.DetectionBatch.FromString(wide)
    message.intrinsics.width = 32

    with pytest.raises(Corrupt, match="expected 192 bytes for 8x12"):
        codec.decode_detection_batch(message.SerializeToString())


@given(hnp.arrays(np.float32, st.integers(0, 9), elements=st.floats(-1, 1, width=32)))
def test_a_second_feature_travels_beside_the_first_and_may_be_absent(second: F32) -> None:
    sent = replace(detection(feature=axis(3)), second_feature=second)

    assert same(codec.detection_value(codec.detection_message(sent)), sent)
