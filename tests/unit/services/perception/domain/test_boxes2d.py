"""2D boxes: tiles, parts cut off by them, one box per thing."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip.scene.types import Box2
from services.perception.domain.boxes2d import ScoredBox, Tile, cut_by_tile, suppress, tiles

SIDES = st.integers(0, 20)


@st.composite
def scored(draw: st.DrawFn) -> ScoredBox:
    x, y = draw(SIDES), draw(SIDES)
    box = Box2(x, y, x + draw(st.integers(0, 12)), y + draw(st.integers(0, 12)))
    return ScoredBox(draw(st.sampled_from(["cup", "table"])), draw(st.sampled_from([0.4, 0.5, 0.9])), box)


def _box(label: str, score: float, *corners: float) -> ScoredBox:
    return ScoredBox(label, score, Box2(*corners))


def test_tiles_are_the_image_and_four_overlapping_corners() -> None:
    assert tiles(640, 480) == (
        Tile(0, 0, 640, 480),
        Tile(0, 0, 384, 288),
        Tile(256, 0, 384, 288),
        Tile(0, 192, 384, 288),
        Tile(256, 192, 384, 288),
    )


@given(st.integers(16, 2000), st.integers(16, 2000))
def test_corner_tiles_stay_inside_and_cover_the_image(width: int, height: int) -> None:
    whole, *corners = tiles(width, height)

    assert (whole.width, whole.height) == (width, height)
    for tile in corners:
        assert tile.x >= 0 and tile.x + tile.width <= width
        assert tile.y >= 0 and tile.y + tile.height <= height
    for point in (
        (0, 0),
        (width - 1, 0),
        (0, height - 1),
        (width - 1, height - 1),
        (width // 2, height // 2),
    ):
        assert any(t.x <= point[0] < t.x + t.width and t.y <= point[1] < t.y + t.height for t in corners)


@pytest.mark.parametrize(
    ("box", "cut"),
    [
        (Box2(300, 50, 350, 100), False),  # inside
        (Box2(256, 50, 300, 100), True),  # at its left border, which is not the image's
        (Box2(300, 50, 640, 100), False),  # at the image's own right border
        (Box2(300, 0, 350, 100), False),  # at the image's own top
        (Box2(300, 50, 350, 287), True),  # at its bottom border
        (Box2(258.9, 50, 300, 100), True),  # within the margin
        (Box2(259.0, 50, 300, 100), False),  # just beyond it
    ],
)
def test_a_box_that_ends_at_a_tiles_inner_border_shows_a_part(box: Box2, cut: bool) -> None:
    assert cut_by_tile(box, Tile(256, 0, 384, 288), 640, 480) is cut


def test_nothing_is_cut_by_the_whole_image() -> None:
    assert not cut_by_tile(Box2(0, 0, 640, 480), Tile(0, 0, 640, 480), 640, 480)


def test_a_repeat_of_a_better_box_is_dropped() -> None:
    """IoU of [0,10] and [1,11] over the same height is 9/11 = 0.82."""
    good, worse = _box("cup", 0.9, 0, 0, 10, 10), _box("cup", 0.5, 1, 0, 11, 10)

    assert suppress([worse, good]) == [good]


def test_boxes_that_overlap_by_half_or_less_both_stay() -> None:
    """[0,10] and [5,15]: IoU 5/15, half of each covered."""
    left, right = _box("cup", 0.9, 0, 0, 10, 10), _box("cup", 0.8, 5, 0, 15, 10)

    assert suppress([left, right]) == [left, right]


def test_a_part_inside_a_larger_box_of_its_label_is_dropped() -> None:
    whole, part = _box("table", 0.6, 0, 0, 100, 100), _box("table", 0.5, 10, 10, 30, 30)

    assert suppress([whole, part]) == [whole]


def test_a_cup_inside_a_tables_box_stays() -> None:
    table, cup = _box("table", 0.6, 0, 0, 100, 100), _box("cup", 0.5, 10, 10, 30, 30)

    assert suppress([table, cup]) == [table, cup]


def test_one_thing_under_two_labels_keeps_the_better() -> None:
    """IoU 95/105 = 0.905 > 0.8."""
    cup, bowl = _box("cup", 0.6, 0, 0, 100, 10), _box("bowl", 0.5, 5, 0, 105, 10)

    assert suppress([bowl, cup]) == [cup]


def test_ties_go_to_the_larger_then_the_first_box() -> None:
    small, large = _box("cup", 0.5, 0, 0, 9, 10), _box("cup", 0.5, 0, 0, 10, 10)
    twin = _box("bowl", 0.5, 0, 0, 10, 10)

    assert suppress([small, large]) == [large]
    assert suppress([large, twin]) == [large]
    assert suppress([twin, large]) == [twin]


def test_no_boxes_and_boxes_without_area_do_no_harm() -> None:
    flat = _box("cup", 0.5, 3, 3, 3, 8)

    assert suppress([]) == []
    assert suppress([flat]) == [flat]


@given(st.lists(scored(), max_size=12))
def test_suppressing_keeps_the_best_drops_none_it_did_not_get_and_is_stable(boxes: list[ScoredBox]) -> None:
    kept = suppress(boxes)

    assert all(box in boxes for box in kept)
    assert [b.score for b in kept] == sorted((b.score for b in kept), reverse=True)
    assert suppress(kept) == kept
    if boxes:
        assert kept[0].score == max(b.score for b in boxes)
