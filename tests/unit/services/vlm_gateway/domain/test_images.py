"""Sizes read from headers."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.errors import InvalidInput, TooLarge
from services.vlm_gateway.domain.images import ImageSize, image_size
from tests.unit.services.vlm_gateway.local_upstream import picture


@pytest.mark.parametrize("kind", [".jpg", ".png"])
def test_size_is_read_from_the_header(kind: str) -> None:
    assert image_size(picture(37, 21, kind)) == ImageSize(37, 21)


@pytest.mark.parametrize("data", [b"", b"\xff\xd8", b"GIF89a" + bytes(40), b"\x89PNG\r\n\x1a\n", bytes(64)])
def test_what_is_no_image_is_refused(data: bytes) -> None:
    with pytest.raises(InvalidInput, match="not a whole JPEG or PNG"):
        image_size(data)


@pytest.mark.parametrize("kind", [".jpg", ".png"])
def test_cut_off_image_is_refused(kind: str) -> None:
    data = picture(64, 48, kind)
    with pytest.raises(InvalidInput):
        image_size(data[: len(data) // 2])


def test_image_bomb_is_refused_by_its_header() -> None:
    bomb = bytearray(picture(8, 8, ".png"))
    bomb[16:24] = struct.pack(">II", 60_000, 60_000)
    with pytest.raises(TooLarge, match="60000x60000"):
        image_size(bytes(bomb))


@given(st.binary(max_size=200), st.sampled_from([b"\xff\xd8", b"\x89PNG\r\n\x1a\n", b""]))
def test_no_bytes_do_worse_than_be_refused(data: bytes, start: bytes) -> None:
    try:
        size = image_size(start + data)
    except InvalidInput:
        return
    assert size.width > 0 and size.height > 0


def test_fitting_shrinks_the_longer_side_and_never_enlarges() -> None:
    assert ImageSize(640, 480).fitted(320) == ImageSize(320, 240)
    assert ImageSize(480, 640).fitted(320) == ImageSize(240, 320)
    assert ImageSize(100, 50).fitted(320) == ImageSize(100, 50)
    assert ImageSize(5000, 1).fitted(100) == ImageSize(100, 1)
