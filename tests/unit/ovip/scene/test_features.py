"""Features: unit length, whatever came in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.scene.features import cosine, normalize
from ovip.scene.types import F32

FINITE = st.floats(width=32, allow_nan=False, allow_infinity=False)


def test_normalising_by_hand() -> None:
    assert normalize(np.array([3.0, 4.0], np.float32)) == pytest.approx([0.6, 0.8])


def test_a_zero_vector_stays_zero() -> None:
    assert normalize(np.array([[0.0, 0.0], [0.0, 2.0]], np.float32)).tolist() == [[0.0, 0.0], [0.0, 1.0]]


@given(hnp.arrays(np.float32, st.tuples(st.integers(0, 4), st.integers(1, 8)), elements=FINITE))
def test_every_vector_but_zero_becomes_a_unit_vector(features: F32) -> None:
    """A robot may send any finite numbers: neither 1e30 nor 1e-30 may lose its direction."""
    made = normalize(features)

    assert made.dtype == np.float32
    length = np.linalg.norm(made.astype(np.float64), axis=1)
    assert length == pytest.approx(features.any(axis=1).astype(float), abs=1e-5)


def test_cosines_by_hand() -> None:
    a, b = np.eye(3, dtype=np.float32), np.array([[0.6, 0.8, 0.0]], np.float32)

    assert cosine(a, b)[:, 0] == pytest.approx([0.6, 0.8, 0.0])
