"""Images as upstreams take them."""

from __future__ import annotations

import base64

import pytest

from ovip.errors import InvalidInput
from services.vlm_gateway.adapters.images import data_url, fitted_jpeg
from services.vlm_gateway.domain.images import ImageSize, image_size
from tests.unit.services.vlm_gateway.local_upstream import picture


def test_jpeg_within_the_limit_is_passed_on_as_it_came() -> None:
    image = picture(64, 48)
    assert fitted_jpeg(image, 64) == image


@pytest.mark.parametrize("kind", [".jpg", ".png"])
def test_large_image_is_shrunk_to_the_limit_as_jpeg(kind: str) -> None:
    small = fitted_jpeg(picture(640, 480, kind), 128)
    assert small.startswith(b"\xff\xd8") and image_size(small) == ImageSize(128, 96)


def test_small_png_becomes_jpeg_of_the_same_size() -> None:
    assert image_size(fitted_jpeg(picture(64, 48, ".png"), 128)) == ImageSize(64, 48)


def test_data_url_holds_the_jpeg() -> None:
    image = picture(64, 48)
    head, _, tail = data_url(image, 128).partition(",")
    assert head == "data:image/jpeg;base64" and base64.b64decode(tail) == image


def test_image_whose_pixels_are_broken_is_refused() -> None:
    image = picture(64, 48, ".png")
    with pytest.raises(InvalidInput, match="cannot be decoded"):
        fitted_jpeg(image[:33] + bytes(len(image) - 33 - 12) + image[-12:], 128)
