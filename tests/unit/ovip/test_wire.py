"""Images on the wire: what was sent comes back, and hostile bytes are refused in words."""

from __future__ import annotations

import contextlib
import struct
import tracemalloc

import cv2
import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ovip.errors import InvalidInput
from ovip.scene.types import U16, Intrinsics
from ovip.wire import decode_depth, decode_depth_units, decode_mask, decode_rgb, encode_depth
from tests.builders import camera, colour_noise, depth_units, jpeg, png, png_claiming

K = camera()
NARROW = Intrinsics(20, 20, 8, 8, 16, 17)
RAW = np.random.default_rng(3).integers(0, 6000, (K.height, K.width), dtype=np.uint16)


def _zstd_claiming(size: int) -> bytes:
    """A zstd frame whose header claims `size` bytes, then one tiny raw block."""
    return struct.pack("<IBBQ", 0xFD2FB528, 0xC0, 0x58, size) + b"\x09\x00\x00A"


# Depth


@given(hnp.arrays(np.uint16, (17, 16)))
def test_depth_comes_back_as_it_was(raw: U16) -> None:
    assert np.array_equal(decode_depth_units(encode_depth(raw), "shuffle_zstd", NARROW), raw)
    assert np.array_equal(decode_depth_units(png(raw), "png16", NARROW), raw)


def test_depth_wraps_around_its_16_bits() -> None:
    raw = np.tile(np.array([0, 65535], np.uint16), (K.height, K.width // 2))

    assert np.array_equal(decode_depth_units(encode_depth(raw), "shuffle_zstd", K), raw)


def test_the_same_depth_gives_the_same_bytes() -> None:
    assert encode_depth(RAW) == encode_depth(RAW.copy())


def test_units_become_metres_by_hand() -> None:
    raw = depth_units(K)
    raw[0, 0], raw[1, 1] = 0, 1234

    metres = decode_depth(png(raw), "png16", 1000.0, K)

    assert metres.dtype == np.float32
    assert metres[0, 0] == 0
    assert metres[1, 1] == np.float32(1.234)
    assert decode_depth(png(raw), "png16", 5000.0, K)[1, 1] == np.float32(0.2468)


@pytest.mark.parametrize("scale", [0.0, -1000.0, 0.5, 1e7, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(scale: float) -> None:
    with pytest.raises(InvalidInput, match="expected a scale of 1 to 1e6 units per metre"):
        decode_depth(png(RAW), "png16", scale, K)


def test_depth_of_another_size_is_refused_naming_both_sizes() -> None:
    with pytest.raises(InvalidInput, match="depth image: expected 16x17 like the intrinsics, got 64x48"):
        decode_depth_units(png(RAW), "png16", NARROW)
    with pytest.raises(InvalidInput, match=r"depth image: expected 544 bytes for 16x17"):
        decode_depth_units(encode_depth(RAW), "shuffle_zstd", NARROW)


def test_depth_of_8_bits_or_three_channels_is_refused() -> None:
    with pytest.raises(InvalidInput, match="expected one channel of 16 bits, got uint8"):
        decode_depth_units(png(np.zeros((48, 64), np.uint8)), "png16", K)
    with pytest.raises(InvalidInput, match="expected one channel of 16 bits, got uint8 with shape"):
        decode_depth_units(png(colour_noise(K)), "png16", K)


@pytest.mark.parametrize("encoding", ["unspecified", "unknown", "jpeg", ""])
def test_an_unknown_depth_encoding_is_refused(encoding: str) -> None:
    with pytest.raises(InvalidInput, match="expected encoding png16 or shuffle_zstd"):
        decode_depth_units(png(RAW), encoding, K)


@pytest.mark.parametrize("size", [0, 1, K.width * K.height * 2 + 1, 2**40, 2**63, 2**64 - 3])
def test_a_zstd_header_that_claims_any_other_size_is_refused_before_memory_is_taken(size: int) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(InvalidInput, match="depth image"):
            decode_depth_units(_zstd_claiming(size), "shuffle_zstd", K)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()

    assert peak < 1_000_000


def test_zstd_without_a_size_that_unpacks_to_more_is_refused() -> None:
    endless = zstandard.ZstdCompressor(write_content_size=False).compress(b"\0" * 10_000_000)

    with pytest.raises(InvalidInput, match="depth image"):
        decode_depth_units(endless, "shuffle_zstd", K)


def test_zstd_that_unpacks_to_less_is_refused() -> None:
    short = zstandard.ZstdCompressor(write_content_size=False).compress(b"\0" * 10)

    with pytest.raises(InvalidInput, match="got 10 bytes"):
        decode_depth_units(short, "shuffle_zstd", K)


# Colour


def test_colour_comes_back_from_png_exactly_and_from_jpeg_nearly() -> None:
    rgb = np.zeros((K.height, K.width, 3), np.uint8)
    rgb[:, :32] = 255, 0, 0
    rgb[:, 32:] = 0, 0, 255

    assert np.array_equal(decode_rgb(png(rgb), K), rgb)
    assert np.abs(decode_rgb(jpeg(rgb), K)[:, ::63].astype(int) - rgb[:, ::63]).max() < 12


def test_colour_of_another_size_is_refused_naming_both_sizes() -> None:
    with pytest.raises(InvalidInput, match="colour image: expected 16x17 like the intrinsics, got 64x48"):
        decode_rgb(jpeg(colour_noise(K)), NARROW)
    with pytest.raises(InvalidInput, match="colour image: expected 16x17 like the intrinsics, got 64x48"):
        decode_rgb(png(colour_noise(K)), NARROW)


def test_bytes_that_are_no_image_are_refused_with_their_first_bytes() -> None:
    with pytest.raises(InvalidInput, match="expected JPEG or PNG bytes, got 4 bytes starting 47494638"):
        decode_rgb(b"GIF8", K)
    with pytest.raises(InvalidInput, match="got 0 bytes starting nothing"):
        decode_rgb(b"", K)


@pytest.mark.parametrize("share", [0.0, 0.02, 0.3, 0.5, 0.9, 0.999])
def test_a_jpeg_cut_off_is_refused(share: float) -> None:
    whole = jpeg(colour_noise(K))

    with pytest.raises(InvalidInput, match="colour image"):
        decode_rgb(whole[: int(len(whole) * share)], K)


@pytest.mark.parametrize("share", [0.0, 0.02, 0.3, 0.5, 0.9, 0.99])
def test_a_png_cut_off_is_refused(share: float) -> None:
    colour, depth = png(colour_noise(K)), png(RAW)

    with pytest.raises(InvalidInput, match="colour image"):
        decode_rgb(colour[: int(len(colour) * share)], K)
    with pytest.raises(InvalidInput, match="depth image"):
        decode_depth_units(depth[: int(len(depth) * share)], "png16", K)


@pytest.mark.parametrize("side", [65, 20_000, 100_000, 2**31 - 1])
def test_an_image_that_claims_to_be_huge_is_refused_before_it_is_decoded(side: int) -> None:
    with pytest.raises(InvalidInput, match=f"got {side}x{side}"):
        decode_rgb(png_claiming(side, side, 8, 2), K)
    with pytest.raises(InvalidInput, match=f"got {side}x{side}"):
        decode_depth_units(png_claiming(side, side, 16, 0), "png16", K)
    with pytest.raises(InvalidInput, match=f"{side}x{side}"):
        decode_mask("mask", png_claiming(side, side, 8, 0), K)


def test_a_jpeg_that_claims_to_be_huge_is_refused() -> None:
    whole = bytearray(jpeg(colour_noise(K)))
    at = whole.index(b"\xff\xc0")
    whole[at + 5 : at + 9] = struct.pack(">HH", 65_000, 65_000)

    with pytest.raises(InvalidInput, match="got 65000x65000"):
        decode_rgb(bytes(whole), K)


@pytest.mark.parametrize("flags", [[], [cv2.IMWRITE_JPEG_PROGRESSIVE, 1], [cv2.IMWRITE_JPEG_OPTIMIZE, 1]])
def test_every_kind_of_jpeg_is_read(flags: list[int]) -> None:
    data = cv2.imencode(".jpg", colour_noise(K), flags)[1].tobytes()

    assert decode_rgb(data, K).shape == (48, 64, 3)


def test_a_grey_jpeg_is_read_as_colour() -> None:
    data = cv2.imencode(".jpg", np.full((48, 64), 90, np.uint8))[1].tobytes()

    assert decode_rgb(data, K)[10, 10].tolist() == [90, 90, 90]


def test_an_orientation_in_the_metadata_does_not_turn_the_image() -> None:
    """Depth is registered to the pixels as sent; turned colour would not match it."""
    square = Intrinsics(60, 60, 32, 32, 64, 64)
    rgb = np.zeros((64, 64, 3), np.uint8)
    rgb[:32] = 255
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"
    plain = jpeg(rgb)
    turned = plain[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + plain[2:]

    assert np.array_equal(decode_rgb(turned, square), decode_rgb(plain, square))


# Masks


def test_a_mask_is_what_is_not_zero() -> None:
    grey = np.array([[0, 1], [255, 0]], np.uint8)

    assert decode_mask("mask", png(grey), K).tolist() == [[False, True], [True, False]]


@pytest.mark.parametrize("data", [b"", b"\x89PNG\r\n\x1a\n", b"hello", jpeg(colour_noise(K))])
def test_a_mask_that_is_no_png_is_refused(data: bytes) -> None:
    with pytest.raises(InvalidInput, match="mask of 'cup': expected a PNG of at most 64x48"):
        decode_mask("mask of 'cup'", data, K)


# Anything at all


@given(
    st.sampled_from(
        [
            b"",
            b"\xff\xd8",
            b"\x89PNG\r\n\x1a\n",
            b"\x28\xb5\x2f\xfd",
            png(RAW)[:60],
            jpeg(colour_noise(K))[:200],
        ]
    ),
    st.binary(max_size=200),
    st.sampled_from([b"", b"\xff\xd9", png(RAW)[-12:]]),
)
@settings(max_examples=300)
def test_no_bytes_raise_anything_but_invalid_input(start: bytes, middle: bytes, end: bytes) -> None:
    data = start + middle + end
    for read in (
        lambda: decode_rgb(data, K),
        lambda: decode_depth(data, "png16", 1000.0, K),
        lambda: decode_depth(data, "shuffle_zstd", 1000.0, K),
        lambda: decode_mask("mask", data, K),
    ):
        with contextlib.suppress(InvalidInput):
            read()


@given(st.data())
@settings(max_examples=200)
def test_no_flipped_bytes_raise_anything_but_invalid_input(data: st.DataObject) -> None:
    encoded = {
        "depth png": png(RAW),
        "png": png(colour_noise(K)),
        "jpeg": jpeg(colour_noise(K)),
        "zstd": encode_depth(RAW),
    }
    broken = bytearray(encoded[data.draw(st.sampled_from(sorted(encoded)))])
    for _ in range(data.draw(st.integers(1, 5))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    for read in (
        lambda: decode_rgb(bytes(broken), K),
        lambda: decode_depth(bytes(broken), "png16", 1000.0, K),
        lambda: decode_depth(bytes(broken), "shuffle_zstd", 1000.0, K),
    ):
        with contextlib.suppress(InvalidInput):
            read()
