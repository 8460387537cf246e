"""Page cursors."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput
from services.api.domain.cursors import decode_cursor, encode_cursor


@given(st.text(min_size=1))
def test_a_cursor_leads_back_to_where_its_page_ended(position: str) -> None:
    try:
        position.encode()
    except UnicodeEncodeError:
        return
    assert decode_cursor("objects", encode_cursor("objects", position)) == position


@pytest.mark.parametrize("cursor", [None, ""])
def test_without_a_cursor_a_listing_begins_at_its_start(cursor: str | None) -> None:
    assert decode_cursor("objects", cursor) == ""


@pytest.mark.parametrize("cursor", ["o-001", "!!", "AAAA", "b2JqZWN0czo", encode_cursor("frames", "7-0")])
def test_a_cursor_that_the_listing_never_gave_is_refused_in_words(cursor: str) -> None:
    with pytest.raises(InvalidInput, match="expected one that an earlier page of objects gave"):
        decode_cursor("objects", cursor)
