"""An operator's edits there and back: every kind, whatever the words in it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip import codec
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.edits import Delete, EditRequest, Merge, Pin, Rename, Split
from ovip.v1 import mapper_pb2
from tests.builders import same

WORDS = st.text(max_size=12)
REQUESTS = st.builds(
    EditRequest,
    WORDS,
    st.integers(0, 2**64 - 1),
    WORDS,
    st.one_of(
        st.builds(Rename, WORDS, WORDS),
        st.builds(Merge, WORDS, st.lists(WORDS, max_size=3).map(tuple)),
        st.builds(Split, WORDS, hnp.arrays(np.float64, 6, elements=st.floats(-1e9, 1e9)), WORDS),
        st.builds(Delete, WORDS),
        st.builds(Pin, WORDS, st.booleans()),
    ),
)


@given(REQUESTS)
def test_an_edit_request_comes_back_from_its_bytes_the_same(request: EditRequest) -> None:
    data = codec.encode_edit_request(request)

    assert same(codec.decode_edit_request(data), request)
    assert codec.encode_edit_request(codec.decode_edit_request(data)) == data


@given(REQUESTS, WORDS)
def test_an_edit_request_comes_back_from_its_message_whatever_the_scene(
    request: EditRequest, scene: str
) -> None:
    message = codec.edit_request_message(request, scene)

    assert message.scene == scene
    assert same(codec.edit_request_value(message), request)


def test_a_message_without_an_edit_is_refused_and_bytes_without_one_are_corrupt() -> None:
    empty = mapper_pb2.EditMapRequest(edit_id="e1")
    with pytest.raises(InvalidInput, match="expected one of rename, merge, split, delete, pin"):
        codec.edit_request_value(empty)
    with pytest.raises(Corrupt, match="expected one of rename, merge, split, delete, pin"):
        codec.decode_edit_request(empty.SerializeToString())
    with pytest.raises(Corrupt, match="EditMapRequest: 2 bytes do not parse"):
        codec.decode_edit_request(b"\xff\xff")


def test_a_split_without_its_part_is_refused() -> None:
    split = mapper_pb2.EditMapRequest(split=mapper_pb2.SplitEdit(object_id="o1"))

    with pytest.raises(InvalidInput, match="split: expected the box of the part"):
        codec.edit_request_value(split)
