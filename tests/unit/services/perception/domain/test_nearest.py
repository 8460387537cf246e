"""What a frame saw through, block by block."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.perception.domain.nearest import nearest_depth


def _depth(height: int, width: int, metres: float = 3.0) -> np.ndarray:  # type: ignore[type-arg]
    return np.full((height, width), metres, np.float32)


def test_a_block_is_as_near_as_its_nearest_pixel() -> None:
    depth = _depth(8, 8)
    depth[1, 6] = 1.25

    assert nearest_depth(depth).tolist() == [[3.0, 1.25], [3.0, 3.0]]


def test_a_block_of_which_less_than_half_has_depth_is_unknown() -> None:
    depth = _depth(4, 8)
    depth[:2, :4] = 0  # 8 of 16 left
    depth[:, 4:] = 0
    depth[0, 4:], depth[1, 4:7] = 2.0, 2.0  # 7 of 16

    assert nearest_depth(depth).tolist() == [[3.0, 0.0]]


def test_what_lies_beyond_the_image_counts_as_without_depth() -> None:
    """6 x 5 pixels: the block below has 2 of 4 rows (8 of 16), the one to the right 1 of 4 columns."""
    assert nearest_depth(_depth(6, 5)).tolist() == [[3.0, 0.0], [3.0, 0.0]]


def test_depth_beyond_the_farthest_is_no_depth() -> None:
    depth = _depth(4, 4, 12.5)
    depth[:2] = 11.0

    assert nearest_depth(depth, farthest=12.0).tolist() == [[11.0]]
    assert nearest_depth(depth, farthest=10.0).tolist() == [[0.0]]


def test_no_pixels_have_no_blocks() -> None:
    assert nearest_depth(np.zeros((0, 0), np.float32)).shape == (0, 0)


@given(st.integers(1, 20), st.integers(1, 20), st.integers(1, 5), st.integers(0, 2**32 - 1))
@settings(max_examples=50)
def test_it_is_what_one_finds_block_by_block(height: int, width: int, block: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth = rng.choice(np.array([0, 1, 2, 5], np.float32), (height, width))

    nearest = nearest_depth(depth, block, farthest=4.0)

    assert nearest.dtype == np.float32
    assert nearest.shape == (-(-height // block), -(-width // block))
    for (row, column), found in np.ndenumerate(nearest):
        patch = depth[row * block : (row + 1) * block, column * block : (column + 1) * block]
        known = patch[(patch > 0) & (patch <= 4)]
        assert found == pytest.approx(known.min() if 2 * known.size >= block**2 else 0.0)
