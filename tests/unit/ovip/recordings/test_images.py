"""Image headers without decoding."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from ovip.recordings.images import ImageHeader, parse_header, read_header, without_value


def _encoded(extension: str, image: np.ndarray) -> bytes:
    return cv2.imencode(extension, image)[1].tobytes()


@pytest.mark.parametrize(
    ("data", "header"),
    [
        (_encoded(".png", np.zeros((48, 64), np.uint16)), ImageHeader("png", 64, 48, 16, True)),
        (_encoded(".png", np.zeros((48, 64, 3), np.uint8)), ImageHeader("png", 64, 48, 8, False)),
        (_encoded(".jpg", np.zeros((48, 64, 3), np.uint8)), ImageHeader("jpeg", 64, 48, 8, False)),
        (_encoded(".jpg", np.zeros((48, 64), np.uint8)), ImageHeader("jpeg", 64, 48, 8, True)),
    ],
)
def test_size_bits_and_kind_are_read_from_the_first_bytes(data: bytes, header: ImageHeader) -> None:
    assert parse_header(data) == header


def test_a_jpeg_with_a_long_first_segment_is_read(tmp_path: Path) -> None:
    jpeg = _encoded(".jpg", np.zeros((48, 64, 3), np.uint8))
    path = tmp_path / "exif.jpg"
    path.write_bytes(jpeg[:2] + b"\xff\xe1" + (60000).to_bytes(2, "big") + bytes(59998) + jpeg[2:])
    assert read_header(path) == ImageHeader("jpeg", 64, 48, 8, False)


@pytest.mark.parametrize(
    "data", [b"", b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"BM1234", b"\xff\xd8\xff\xe0\x00\x10"]
)
def test_what_is_no_image_has_no_header(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "x").write_bytes(data)
    assert read_header(tmp_path / "x") is None
    assert read_header(tmp_path / "missing") is None


def test_depth_that_does_not_decode_is_passed_on_as_it_is() -> None:
    whole = _encoded(".png", np.full((48, 64), 65535, np.uint16))
    assert without_value(b"", 65535) == b""
    assert without_value(whole[:40], 65535) == whole[:40]
    assert without_value(_encoded(".png", np.zeros((4, 4, 3), np.uint8)), 0).startswith(b"\x89PNG")
