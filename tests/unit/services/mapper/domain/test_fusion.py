"""View-area weights (Eq. 3) by hand."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.scene.types import Box2
from services.mapper.domain.fusion import FusionParams, Weighting, fusion_weight, view_weight

PAPER = FusionParams()


def test_sigma_v_is_the_paper_s() -> None:
    assert PAPER.sigma_v == 0.6


def test_a_centred_box_weighs_its_share_of_the_image() -> None:
    """100 x 50 of 640 x 480, in the middle: 5000 / 307200, no discount."""
    assert view_weight(Box2(270, 215, 370, 265), 640, 480, PAPER.sigma_v) == pytest.approx(5000 / 307_200)


def test_a_box_off_the_centre_by_hand() -> None:
    """Centre (100, 100) is (-220, -140) off: |.|^2 = 68000; sigma^2 (W^2 + H^2) = 0.36 * 640000 = 230400."""
    expected = 5000 / 307_200 * math.exp(-2 * 68_000 / 230_400)

    assert view_weight(Box2(50, 75, 150, 125), 640, 480, PAPER.sigma_v) == pytest.approx(expected)
    assert expected == pytest.approx(0.00901975, abs=1e-8)


def test_the_whole_image_weighs_one() -> None:
    assert view_weight(Box2(0, 0, 640, 480), 640, 480, PAPER.sigma_v) == 1.0


def test_a_box_without_area_weighs_nothing() -> None:
    assert view_weight(Box2(10, 10, 10, 20), 640, 480, PAPER.sigma_v) == 0.0


@given(st.floats(0, 540), st.floats(0, 430), st.floats(0, 100), st.floats(0, 50))
def test_weights_lie_between_0_and_the_share_of_the_image_and_mirror(
    x: float, y: float, w: float, h: float
) -> None:
    weight = view_weight(Box2(x, y, x + w, y + h), 640, 480, PAPER.sigma_v)
    mirrored = view_weight(Box2(640 - x - w, y, 640 - x, y + h), 640, 480, PAPER.sigma_v)

    assert 0 <= weight <= w * h / 307_200 * (1 + 1e-9)
    assert mirrored == pytest.approx(weight, rel=1e-6, abs=1e-12)


def test_nearer_to_the_centre_weighs_more() -> None:
    weights = [view_weight(Box2(x, 215, x + 100, 265), 640, 480, PAPER.sigma_v) for x in (0, 90, 180, 270)]

    assert weights == sorted(weights)


def test_each_weighting_of_one_view_by_hand() -> None:
    """The view-area weight of the box above; its area alone 5000 / 307200; a count of 1."""
    box = Box2(50, 75, 150, 125)
    weights = [fusion_weight(box, 640, 480, FusionParams(weighting=kind)) for kind in Weighting]

    assert weights == pytest.approx([0.00901975, 5000 / 307_200, 1.0], abs=1e-8)
