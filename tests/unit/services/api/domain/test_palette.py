"""Colours of regions."""

from __future__ import annotations

import numpy as np

from ovip.scene.types import Region
from services.api.domain.palette import UNKNOWN_COLOR, function_color, region_colors, rgb
from services.regions.domain.function_table import FUNCTION_WORDS


def region(region_id: str, function: str) -> Region:
    return Region(region_id, 0, function, function, 1.0, np.zeros(3), (), (), (), ())


def test_a_function_has_the_same_colour_in_every_scene() -> None:
    alone = region_colors([region("a", "kitchen")])
    among = region_colors([region("x", "bedroom"), region("y", "kitchen")])
    assert alone["a"] == among["y"]


def test_every_function_that_the_table_knows_has_a_colour_of_its_own() -> None:
    colors = {function: function_color(function) for function in FUNCTION_WORDS}
    assert len(set(colors.values())) == len(FUNCTION_WORDS)
    assert UNKNOWN_COLOR not in colors.values()


def test_a_function_nobody_foresaw_has_always_the_same_colour_and_two_words_for_one_thing_one() -> None:
    assert function_color("winter garden") == function_color("winter garden") != UNKNOWN_COLOR
    assert function_color("dining room") == function_color("dining area")


def test_a_second_region_has_a_shade_of_the_first_ones_colour() -> None:
    first, second = (
        rgb(color) for color in region_colors([region("r2", "kitchen"), region("r10", "kitchen")]).values()
    )
    assert first == rgb(function_color("kitchen"))
    assert 10 < max(abs(a - b) for a, b in zip(first, second, strict=True)) < 70


def test_regions_of_one_function_are_told_apart() -> None:
    colors = region_colors([region(name, "bedroom") for name in "abcd"])
    assert len(set(colors.values())) == 4


def test_unknown_regions_are_grey_and_take_no_colour_away() -> None:
    colors = region_colors([region("a", "unknown"), region("b", "unknown"), region("c", "kitchen")])
    assert colors["a"] == colors["b"] == UNKNOWN_COLOR
    assert colors["c"] == region_colors([region("c", "kitchen")])["c"]


def test_more_regions_than_colours_still_all_have_one() -> None:
    regions = [region(f"r{i:02d}", f"function {i}") for i in range(25)]
    colors = region_colors(regions)
    assert len(colors) == 25
    assert all(len(rgb(color)) == 3 for color in colors.values())


def test_no_regions_have_no_colours() -> None:
    assert region_colors([]) == {}


def test_a_colour_is_three_numbers() -> None:
    assert rgb("#10ff00") == (16, 255, 0)
