"""Deltas and differences between versions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip import codec
from ovip.errors import InvalidInput
from ovip.scene.types import MapDelta, StepKind
from ovip.scene.versions import MapDiff, ObjectChange
from ovip.v1 import mapper_pb2
from tests.unit.ovip.map_objects import map_object

IDS = st.lists(st.text(max_size=6), max_size=4).map(tuple)
DELTAS = st.builds(
    MapDelta,
    version=st.integers(0, 2**64 - 1),
    frame_id=st.text(max_size=6),
    kind=st.sampled_from(StepKind),
    created=IDS,
    updated=IDS,
    removed=IDS,
    aliases=st.dictionaries(st.text(max_size=6), st.text(max_size=6), max_size=4),
    departed=IDS,
    returned=IDS,
    moved=IDS,
)


@given(DELTAS)
def test_a_delta_comes_back_from_its_bytes_the_same(delta: MapDelta) -> None:
    assert codec.decode_delta(codec.encode_delta(delta)) == delta


def test_a_difference_says_that_features_differ_and_leaves_them_out() -> None:
    changed = map_object("o000000", feature=np.ones(2048, np.float32))
    diff = MapDiff(1, 2, (ObjectChange("o000000", changed, changed, ("feature",)),))

    message = codec.diff_message(diff)
    (change,) = codec.diff_value(message).changes

    assert message.ByteSize() < 500
    assert change.fields == ("feature",)
    assert change.before is not None
    assert change.before.feature.size == 0
    assert change.before.label == "cup"


def test_an_alignment_of_other_than_16_numbers_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"world_from_other: expected 16 numbers .* got 3"):
        codec.alignment_value(mapper_pb2.AlignMapResponse(world_from_other=[0.0] * 3))
