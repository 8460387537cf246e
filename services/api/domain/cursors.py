"""Page cursors: opaque to callers, and refused where they belong to another listing."""

from __future__ import annotations

import base64
import binascii

from ovip.errors import InvalidInput


def encode_cursor(listing: str, position: str) -> str:
    """A cursor that says where a page of `listing` ended."""
    return base64.urlsafe_b64encode(f"{listing}:{position}".encode()).decode().rstrip("=")


def decode_cursor(listing: str, cursor: str | None) -> str:
    """Where the page before ended, "" without a cursor; InvalidInput for one `listing` never gave out."""
    if not cursor:
        return ""
    try:
        text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True).decode()
    except (binascii.Error, UnicodeError):
        raise _unknown(listing) from None
    name, _, position = text.partition(":")
    if name != listing or not position:
        raise _unknown(listing)
    return position


def _unknown(listing: str) -> InvalidInput:
    return InvalidInput(f"cursor: expected one that an earlier page of {listing} gave, unchanged")
