"""Values of the scene as plain JSON values."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.jsonable import to_json
from ovip.scene.answers import Candidate, Outcome, TierReport, TierResult
from ovip.scene.types import Box2, MapDelta

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


@pytest.mark.parametrize(
    ("value", "plain"),
    [
        (np.float32(0.5), 0.5),
        (np.int64(3), 3),
        (np.bool_(True), True),
        (float("nan"), None),
        (np.float32("inf"), None),
        (np.array([[1.0, np.nan], [2.0, 3.0]]), [[1.0, None], [2.0, 3.0]]),
        (np.zeros((0, 3)), []),
        (Outcome.FOUND, "found"),
        ((1, "a", None), [1, "a", None]),
        ({"a": (1,), 2: b"x"[0]}, {"a": [1], "2": 120}),
        (Path("/tmp/x"), "/tmp/x"),
        (True, True),
    ],
)
def test_a_value_becomes_plain(value: Any, plain: Any) -> None:
    assert to_json(value) == plain
    assert type(to_json(value)) is type(plain)


def test_dataclasses_become_dicts_by_field() -> None:
    assert to_json(TierReport(1, TierResult.MISSING, "no such word", 0, 0.5)) == {
        "tier": 1,
        "result": "missing",
        "why": "no such word",
        "vlm_calls": 0,
        "ms": 0.5,
    }
    assert to_json(MapDelta(3, "f", created=("a",)))["created"] == ["a"]


def test_a_nested_value_survives_json() -> None:
    candidate = Candidate("cup", np.array([1.0, 2.0, 3.0]), 0.5, "near", box2=Box2(0, 1, 2, 3))

    again = json.loads(json.dumps(to_json(candidate)))

    assert again["position"] == [1.0, 2.0, 3.0]
    assert again["box2"] == {"x0": 0, "y0": 1, "x1": 2, "y1": 3}
    assert again["box"] is None


@given(PLAIN)
def test_plain_values_stay_as_they_are(value: Any) -> None:
    assert to_json(value) == value
    assert to_json(to_json(value)) == to_json(value)
