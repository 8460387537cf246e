"""Which units a depth image in metres was counted in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ovip.recordings.scales import KNOWN_SCALES, scale_of
from ovip.recordings.sources import depth_units


@pytest.mark.parametrize("scale", KNOWN_SCALES)
def test_the_scale_that_a_real_looking_image_was_sent_in_is_found(scale: float) -> None:
    raw = np.random.default_rng(0).integers(1, 60000, (40, 50)).astype(np.uint16)
    metres = raw.astype(np.float32) / np.float32(scale)
    assert scale_of(metres) == scale


@given(arrays(np.uint16, (4, 5)), st.sampled_from(KNOWN_SCALES))
def test_units_come_back_exactly_whatever_scale_is_found(raw: np.ndarray, scale: float) -> None:
    metres = raw.astype(np.float32) / np.float32(scale)
    found = scale_of(metres)
    back = depth_units(metres, found) / found
    np.testing.assert_allclose(back, metres, atol=0.02 / found)


def test_depth_of_no_known_scale_takes_the_finest_that_holds_it() -> None:
    assert scale_of(np.array([[1.23456789, 9.0]], np.float32)) == 6553.5
    assert scale_of(np.array([[1.23456789, 60.0]], np.float32)) == 1000
    assert scale_of(np.array([[1.23456789, 200.0]], np.float32)) == 256


def test_an_image_without_depth_counts_as_millimetres() -> None:
    assert scale_of(np.zeros((3, 4), np.float32)) == 1000


def test_what_is_no_depth_becomes_none() -> None:
    metres = np.array([np.nan, np.inf, -1.0, 0.0, 66.0, 0.0004, 1.5], np.float32)
    assert depth_units(metres, 1000.0).tolist() == [0, 0, 0, 0, 0, 0, 1500]
